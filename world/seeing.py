"""What the sensors of a team in a room show: its own robots, and what one of them has in view.

In view is what the line of sight reaches without meeting tall furniture. That a robot is broken is not sensed, nor that
a thing is heavy before somebody has tried to move it. A guest that its own team calls home tells nothing any more.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import dist

from bus.messages import State
from world import plane
from world.physics import Point
from world.things import Thing
from world.truth import Truth

NOBODY = "none"
CENTRED_M = 0.02
"""Who is nearer to the middle of a cell is seen there; else its pose is told as well."""


def sense(truth: Truth, team: str) -> State:
    """Place, attributes and grip of every body that is in view; first what the room itself shows."""
    space = truth.layout.spaces[team]
    state: State = dict(truth.fluents[team])
    if space.clock:
        state[space.clock] = -(-truth.tick // truth.period)
    ox, oy = truth.layout.origin(team)
    tall = [[(ox + x, oy + y) for x, y in solid.corners] for solid in space.solids if solid.tall]
    own = [thing for thing in truth.of(team) if truth.kind(thing).role == "robot" and not thing.called]
    eyes = [truth.floor.where(thing.id) for thing in own]
    for thing in truth.of(team):
        if thing.called:
            continue
        if truth.kind(thing).role == "robot" or in_view(truth, thing, eyes, tall):
            state.update(shown(truth, thing))
    return state


def in_view(truth: Truth, thing: Thing, eyes: Sequence[Point], tall: Sequence[Sequence[Point]]) -> bool:
    """Does one of the eyes see the middle of the body, or of one of its ends?"""
    ends = [truth.floor.end(thing.id, number) for number in ((1, 2) if thing.heavy else (1,))]
    return any(not plane.hidden(eye, end, tall) for eye in eyes for end in ends)


def shown(truth: Truth, thing: Thing) -> State:
    """What is seen of a body."""
    kind, name = truth.kind(thing), thing.name
    cell = truth.cell(thing)
    state: State = {f"{kind.place}({name})": f"({cell[0]},{cell[1]})"}
    at = truth.floor.where(thing.id)
    if kind.pose and dist(at, truth.layout.cell(thing.place, *cell)) > CENTRED_M:
        x_m, y_m = truth.local(thing)
        state[f"{kind.pose}({name})"] = f"({round(x_m * 1000)},{round(y_m * 1000)})"
    for attribute in kind.attributes:
        if attribute in thing.attributes:
            state[f"{attribute}({name})"] = thing.attributes[attribute]
    if thing.heavy and thing.known and kind.end:
        x, y = truth.layout.nearest(thing.place, truth.floor.end(thing.id, 2))
        state[f"{kind.end}({name})"] = f"({x},{y})"
    if kind.couples:
        partner = truth.things.get(thing.partner)
        state[f"{kind.couples}({name})"] = held(truth, partner, thing.end) if partner is not None else NOBODY
    return state


def held(truth: Truth, thing: Thing, end: int) -> str:
    """The end of a thing as a term, as ``grip(plate,1)``."""
    return f"{truth.kind(thing).grip}({thing.name},{end})"
