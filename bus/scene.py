"""What the world process is told at its start: a scene in generic terms, compiled from a scenario.

Written by the operator's side as ``world.json``, read by the world alone; agents never see it. A domain
says in its ``domain.toml`` how its actions map to the world's generic skills.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from bus.messages import Count, Name, Seconds, Step, Value

Positive = Annotated[float, msgspec.Meta(gt=0)]
Strict = {"forbid_unknown_fields": True}


class Kind(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A kind of body. `track` says where it lives: on the cells of a ``grid``, or riding a ``line``.

    `prefix` starts its instances' names; `role` is ``robot`` (drives, may break) or ``object``.
    `layer`: bodies of the same layer collide. `attributes` are its sensed properties besides its place.
    `couples`: name of the attribute that shows which body it is coupled to, if it can couple.
    """

    prefix: str
    role: Literal["robot", "object"]
    track: Literal["grid", "line"]
    place: Name
    radius_m: Positive = 0.3
    mass_kg: Positive = 10.0
    layer: Count = 0
    attributes: tuple[Name, ...] = ()
    couples: str = ""
    glyph: str = "?"


class Action(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How an action of the domain is carried out: a generic skill, the role of each argument in order,
    and the skill's parameters.

    `drains`: an attribute of the robot that the action takes a unit of, if the robot has it; with none left nothing
    comes of it. `gain` and `most` are of the skill ``charge``, which fills `attribute` of the coupled robot.
    """

    skill: Literal[
        "drive", "couple", "uncouple", "drive_coupled", "set", "operate",
        "convey", "depart", "arrive", "charge", "repair", "inspect",
    ]  # fmt: skip
    args: tuple[Literal["robot", "partner", "object", "direction", "value", "x", "y"], ...] = ()
    direction: Literal["", "up", "down", "left", "right"] = ""
    attribute: str = ""
    tool: str = ""
    marks: str = ""
    marks_on: int = -1
    marks_periods: float = 1.0
    drains: str = ""
    gain: Count = 0
    most: Count = 0


class Workspace(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One team's floor: cells x = 1..width, y = 1..height, one metre each; a line along the north side whose
    position p lies above column p, visible for p = 1..line_length; column `dock_column` leads to the bench and has no
    access to the line."""

    team: Name
    width: Annotated[int, msgspec.Meta(ge=1)]
    height: Annotated[int, msgspec.Meta(ge=1)]
    line_length: Count = 0
    dock_column: Count = 1


class Entity(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A body at its start. `id` is ``team.name`` for ever; `place` a cell ``(x,y)``, a line position, or ``bench``."""

    id: Name
    team: Name
    name: Name
    kind: Name
    place: Value
    attributes: dict[str, Value] = {}
    broken: bool = False


class Fault(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A disturbance of a scenario and exactly one trigger: at the start of a global step, at a simulated
    time, or when a named action (``T4.attach(c1,w1)``) starts. Kinds are in `bus.faults`."""

    kind: Name
    target: Name
    at_step: Step | None = None
    at_s: Seconds | None = None
    on_action: str | None = None
    args: dict[str, Value | float] = {}


class Scene(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The whole world at its start. `title` and `display` are for people alone: `display` gives the words for
    values, attribute -> value -> word (``{"effector": {"1": "painter"}}``), and under ``places`` for ``dock``,
    ``line`` and ``bench``."""

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
    title: str = ""
    display: dict[str, dict[str, str]] = {}
