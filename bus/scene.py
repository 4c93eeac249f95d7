"""What the world process is told at its start: a scene in generic terms, compiled from a scenario.

Written by the operator's side as ``world.json``, read by the world alone; agents never see it. A domain
says in its ``domain.toml`` how its actions map to the world's generic skills.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from bus.messages import Count, Name, Seconds, Step, Value

Positive = Annotated[float, msgspec.Meta(gt=0)]


class Kind(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A kind of body. `track` says where it lives: on the cells of a ``grid``, riding a ``line``, or anywhere on the
    ``floor`` of a room.

    `prefix` starts its instances' names; `role` is ``robot`` (drives, may break), ``object`` or ``person`` (walks, and
    is never pushed). `layer`: bodies of the same layer collide; on the floor of a room all do. `attributes` are its
    sensed properties besides its place. `couples`: name of the attribute that shows which body it is coupled to, if it
    can couple.

    On the floor of a room: `pose` names the fluent that tells exactly, in millimetres, where a body is that is not in
    the middle of a cell, `end` the one that tells where the other end of a heavy thing is. A robot holds an end of a
    thing, which is shown as a term ``GRIP(NAME,1)``, or 2 for the other end; `grip` is its name. `sort` is the
    attribute that tells what a thing is. `friction_n` is what
    a robot must overcome to drag a thing, `heavy_n` a heavy one; `traction_n` is what it has.
    """

    prefix: str
    role: Literal["robot", "object", "person"]
    track: Literal["grid", "line", "floor"]
    place: Name
    radius_m: Positive = 0.3
    mass_kg: Positive = 10.0
    layer: Count = 0
    attributes: tuple[Name, ...] = ()
    couples: str = ""
    pose: str = ""
    end: str = ""
    grip: str = ""
    sort: str = ""
    traction_n: Positive = 300.0
    friction_n: Positive = 10.0
    heavy_n: Positive = 360.0
    glyph: str = "?"


class Action(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How an action of the domain is carried out: a generic skill, the role of each argument in order,
    and the skill's parameters.

    `drains`: an attribute of the robot that the action takes a unit of, if the robot has it; with none left nothing
    comes of it. `gain` and `most` are of the skill ``charge``, which fills `attribute` of the coupled robot.
    `counts`: a fluent of the workspace that grows by one each time it has its effect.

    On the floor of a room: ``follow`` drives along the way that the call's detail `way` gives, ``((x,y),...)`` in
    millimetres, in `units` periods; ``grasp`` takes hold of what the detail named `point` says (``GRIP(NAME,END)``),
    or else of what is there; ``release``; ``leave`` goes out by the door to `room`, ``enter`` comes in by the one to
    the room that the robot, detail `robot`, came from; ``recall`` has a robot of the own team, detail `robot`, come
    home from another room by itself, a piece of the way in each step. Who has the attribute `weak` grasps no heavy
    thing, who has one that `needs` names only things with the attribute named there; a grasp sets the thing's attribute
    `clears` to 0.
    """

    skill: Literal[
        "drive", "couple", "uncouple", "drive_coupled", "set", "operate",
        "convey", "depart", "arrive", "charge", "repair", "inspect",
        "follow", "grasp", "release", "leave", "enter", "recall",
    ]  # fmt: skip
    args: tuple[Literal["robot", "partner", "object", "direction", "value", "x", "y", "room"], ...] = ()
    direction: Literal["", "up", "down", "left", "right"] = ""
    attribute: str = ""
    tool: str = ""
    marks: str = ""
    marks_on: int = -1
    marks_periods: float = 1.0
    drains: str = ""
    gain: Count = 0
    most: Count = 0
    point: str = ""
    counts: str = ""
    weak: str = ""
    needs: dict[str, str] = {}
    clears: str = ""


class Solid(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Furniture: a simple polygon, convex or not, in metres from the room's south-west corner. Nobody sees past what is
    tall."""

    name: Name
    corners: tuple[tuple[float, float], ...]
    tall: bool = False


class Stop(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A person sets out to a point of the room, in metres, at `at_s` after the run's beginning."""

    at_s: Seconds
    x_m: float
    y_m: float


class Workspace(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One team's floor: cells x = 1..width, y = 1..height, one metre each; a line along the north side whose
    position p lies above column p, visible for p = 1..line_length; column `dock_column` leads to the bench and has no
    access to the line.

    Or a room, if it has the name of one: walls all round, cells x = 0..width-1, y = 0..height-1, cell (x,y) from x, y
    to x+1, y+1 metres from the south-west corner. `doors` leads from a room's name to the cells (west, east, south,
    north) by which robots go there, and where things are left that belong there; `store` is where things are kept that
    belong here. `fluents` are what its sensors show besides the bodies; the one named `clock` tells the periods since
    the run began, rounded up."""

    team: Name
    width: Annotated[int, msgspec.Meta(ge=1)]
    height: Annotated[int, msgspec.Meta(ge=1)]
    line_length: Count = 0
    dock_column: Count = 1
    room: str = ""
    solids: tuple[Solid, ...] = ()
    doors: dict[str, tuple[Count, Count, Count, Count]] = {}
    store: tuple[Count, Count, Count, Count] | None = None
    fluents: dict[str, Value] = {}
    clock: str = ""


class Entity(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A body at its start. `id` is ``team.name`` for ever; `place` a cell ``(x,y)``, a line position, or ``bench``.

    `end` is the cell of the other end of a heavy thing, beside `place`; if it is not `known`, that shows only when
    somebody tries. `stops` are a person's walk, which begins again every `again_s` seconds, if that is not 0."""

    id: Name
    team: Name
    name: Name
    kind: Name
    place: Value
    attributes: dict[str, Value] = {}
    broken: bool = False
    end: str = ""
    known: bool = True
    stops: tuple[Stop, ...] = ()
    again_s: Seconds = 0.0


class Fault(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A disturbance of a scenario and exactly one trigger: at the start of a global step, at a simulated
    time, or when a named action (``T4.attach(c1,w1)``) starts. Kinds are in `bus.faults`."""

    kind: Name
    target: Name
    at_step: Step | None = None
    at_s: Seconds | None = None
    on_action: str | None = None
    args: dict[str, Value | float] = {}


class Transport(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """From one team to another a robot that was given can be taken after so many steps at the earliest."""

    giver: Name
    taker: Name
    steps: Annotated[int, msgspec.Meta(ge=1)]


class Scene(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The whole world at its start. Transport takes `transport_delay_steps`, but for `transports`. `title` and
    `display` are for people alone: `display` gives the words for values, attribute -> value -> word
    (``{"effector": {"1": "painter"}}``), and under ``places`` for ``dock``, ``line`` and ``bench``. `conducted`:
    somebody conducts the teams' steps, which are carried out together; else every team has periods of its own."""

    domain: Name
    seed: int
    period_s: Positive
    dt_s: Positive
    frame_hz: Positive
    transport_delay_steps: Count
    kinds: dict[str, Kind]
    actions: dict[str, Action]
    workspaces: tuple[Workspace, ...]
    entities: tuple[Entity, ...]
    faults: tuple[Fault, ...] = ()
    transports: tuple[Transport, ...] = ()
    conducted: bool = True
    title: str = ""
    display: dict[str, dict[str, str]] = {}
