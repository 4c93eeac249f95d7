"""What a team holds to be true of its room: what it sees, and what it has seen where it cannot look now."""

from __future__ import annotations

from functools import lru_cache

from agents.autonomous.words import Words
from reasoning.geometry import Cell, Room, middle
from reasoning.motion.layout import WALLS
from reasoning.motion.trajectory import Body
from reasoning.solver import parse
from reasoning.values import State, Value

BESIDE_M = 1.1
"""A robot that is so near to a place sees what is there, whatever stands about."""


def believed(words: Words, room: Room | None, before: State, seen: State) -> dict[str, Value]:
    """Beliefs after a look. What was known and is not seen stays where it was, unless some robot would see it there.

    Robots and people are where they are seen, or nowhere; what a robot holds is where the robot is.
    """
    now = dict(seen)
    known = set(words.things(seen))
    for thing in words.things(before):
        if thing in known or not words.ends(before, thing):
            continue
        if words.holders(before, thing) or any(
            in_view(words, room, seen, place) for place in words.ends(before, thing)
        ):
            continue
        now |= of_body(before, thing)
    for thing in known & set(words.heavy(before)):  # weight, once felt, is not forgotten
        if f"{words.end}({thing})" not in seen and words.cell(seen, thing) == words.cell(before, thing):
            now[f"{words.end}({thing})"] = before[f"{words.end}({thing})"]
    return now


def of_body(state: State, body: str) -> dict[str, Value]:
    """All that a state says of a body by itself."""
    return {fluent: value for fluent, value in state.items() if fluent.endswith(f"({body})")}


def in_view(words: Words, room: Room | None, seen: State, place: Cell) -> bool:
    """Would one of the team's robots see a thing in this cell? Any furniture counts as tall: who cannot be sure that
    nothing hides the place has not looked."""
    there = middle(place)
    for robot in words.robots(seen):
        x, y = words.point(seen, robot)
        if (x - there[0]) ** 2 + (y - there[1]) ** 2 <= BESIDE_M**2:
            return True
        if not any(body.cuts(x, y, *there) for body in _furniture(room)):
            return True
    return False


@lru_cache(maxsize=8)
def _furniture(room: Room | None) -> tuple[Body, ...]:
    return () if room is None else tuple(Body(part) for part in room.layout.solids[WALLS:])


def without(state: State, bodies: set[str]) -> dict[str, Value]:
    """A state that says nothing of these bodies."""
    return {fluent: value for fluent, value in state.items() if not bodies & {str(arg) for arg in parse(fluent)[1]}}


def problem_state(words: Words, state: State) -> dict[str, Value]:
    """What planning starts from: without people, and without where exactly a robot is between cells."""
    left = without(state, set(words.persons(state)))
    return {fluent: value for fluent, value in left.items() if not fluent.startswith(f"{words.pose}(")}
