"""What a team's sensors show: read from the bodies, never from what was commanded.

That a robot is broken is not sensed.
"""

from __future__ import annotations

from bus.messages import State, Value
from world import seeing
from world.things import Thing
from world.truth import Truth

TOLERANCE_M = 0.4
"""A body within so much of a cell's centre, in x and in y, is seen in that cell; between cells it is nowhere."""
NOWHERE = "(none)"
NOBODY = "none"


def sense(truth: Truth, team: str) -> State:
    """Place, attributes and coupling of everything in the team's workspace; in a room, of what is in view."""
    if truth.layout.spaces[team].room:
        return seeing.sense(truth, team)
    truth.fade()
    state: State = {}
    for thing in truth.of(team):
        kind, name = truth.kind(thing), thing.name
        state[f"{kind.place}({name})"] = where(truth, thing)
        for attribute in kind.attributes:
            if attribute in thing.attributes:
                state[f"{attribute}({name})"] = thing.attributes[attribute]
        if kind.couples:
            partner = truth.things.get(thing.partner)
            state[f"{kind.couples}({name})"] = partner.name if partner is not None else NOBODY
    return state


def where(truth: Truth, thing: Thing) -> Value:
    """The line position or the cell that a body is at."""
    match truth.kind(thing).track:
        case "line":
            return truth.line(thing)
        case "floor":
            x, y = truth.cell(thing)
            return f"({x},{y})"
    return seen_cell(truth, thing)


def seen_cell(truth: Truth, thing: Thing) -> str:
    """``(x,y)``, or ``(none)`` between cells."""
    x_m, y_m = truth.local(thing)
    x, y = round(x_m), round(y_m)
    return f"({x},{y})" if abs(x_m - x) <= TOLERANCE_M and abs(y_m - y) <= TOLERANCE_M else NOWHERE
