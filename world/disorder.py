"""What people do in rooms between two looks: they put bodies elsewhere, bring things and take them away.

Each gives the reason why it cannot be, or an empty text. Who held what is put elsewhere holds it no longer.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, dist, sin
from re import fullmatch

from bus.messages import Value
from world import lookout, plane
from world.physics import Point
from world.things import GONE, WORD, Thing
from world.truth import MOST_BODIES, Truth

Args = Mapping[str, Value | float]


def move(truth: Truth, thing: Thing, args: Args) -> str:
    """To the middle of a cell; the second end of a heavy thing stays on the same side of the first."""
    at = _place(truth, thing.place, args)
    if at is None:
        return f"{thing.id} can be put on a cell of its room: x, y"
    heading = truth.floor.heading(thing.id) if thing.heavy else 0.0
    if reason := _taken(truth, thing, [at, *([(at[0] + cos(heading), at[1] + sin(heading))] if thing.heavy else [])]):
        return reason
    let_go(truth, thing)
    truth.floor.put(thing.id, at, heading)
    return ""


def bring(truth: Truth, target: str, args: Args) -> str:
    """A thing that was not there before, to the middle of a cell."""
    team, _, name = target.partition(".")
    kind = next((k for k, v in truth.scene.kinds.items() if v.role == "object" and v.track == "floor"), None)
    if team not in truth.layout.spaces or kind is None or not fullmatch(WORD, name):
        return f"nothing can be brought as {target}: say ROOM.NAME, of {', '.join(truth.layout.spaces)}"
    if not fullmatch(WORD, str(args["what"])):
        return f"{args['what']} is no kind of things: a small letter, then letters, digits or _"
    if target in truth.things or truth.find(team, name) is not None:
        return f"there is a {name} already"
    if len(truth.things) >= MOST_BODIES:
        return f"there is no room for more than {MOST_BODIES} bodies"
    at = _place(truth, team, args)
    if at is None:
        return f"{target} can be put on a cell of its room: x, y"
    known = truth.scene.kinds[kind]
    attributes: dict[str, Value] = dict.fromkeys(known.attributes, 0)
    if known.sort:
        attributes[known.sort] = str(args["what"])
    thing = Thing(target, kind, team, name, attributes)
    if reason := _taken(truth, thing, [at]):
        return reason
    truth.enter(thing, at)
    return ""


def take(truth: Truth, thing: Thing) -> str:
    """Away, for good."""
    let_go(truth, thing)
    truth.floor.lift(thing.id)
    truth.belongs(thing, GONE, thing.id)
    return ""


def let_go(truth: Truth, body: Thing) -> None:
    """Nobody holds it, and it holds nothing."""
    for robot in [body] if body.end else truth.holders(body):
        truth.ungrip(robot)


def _place(truth: Truth, team: str, args: Args) -> Point | None:
    x, y = args.get("x"), args.get("y")
    if isinstance(x, int) and isinstance(y, int) and truth.layout.in_grid(team, x, y):
        return truth.layout.cell(team, x, y)
    return None


def _taken(truth: Truth, thing: Thing, ends: list[Point]) -> str:
    """Why a body cannot stand or lie there: things are in the way of things, robots and people of one another."""
    radius_m, lies = truth.kind(thing).radius_m, truth.kind(thing).role == "object"
    space, (ox, oy) = truth.layout.spaces[thing.place], truth.layout.origin(thing.place)
    for end in ends:
        local = end[0] - ox, end[1] - oy
        if not truth.layout.in_grid(thing.place, *truth.layout.nearest(thing.place, end)):
            return "there is a wall"
        for solid in space.solids:
            if plane.off(local, solid.corners) < radius_m:
                return f"{solid.name} stands there"
        for other in truth.of(thing.place):
            if other is not thing and (truth.kind(other).role == "object") is lies:
                for disc in lookout.discs(truth, other):
                    if dist(end, disc.at) < radius_m + disc.radius_m:
                        return f"{other.name} is there"
    return ""
