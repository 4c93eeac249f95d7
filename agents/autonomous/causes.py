"""Monitoring: from what was predicted, what is seen and what was felt to a cause with a name.

| cause            | how it shows                                                                             |
|------------------|------------------------------------------------------------------------------------------|
| heavy_object     | a robot pulled, and nothing moved                                                        |
| object_not_found | a robot grasped into the air; or what it held, or was to be there, is gone or elsewhere  |
| person_in_way    | a robot stopped, and a person is near it                                                 |
| unknown_object   | a robot stopped, and something lies near it that was not known                           |
| held_up          | a robot stopped, and none of this is near it: another robot, say                         |
| robot_broken     | a robot did nothing of what it was to do, and felt nothing                               |
| object_appeared  | something is seen that was not known; nothing else is odd                                |

A table, in this order: the first cause that applies to a robot is its cause. The recoveries are in
`agents.autonomous.recovering`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Literal, NamedTuple

from agents.autonomous.words import Words
from reasoning.solver import parse
from reasoning.values import State

Name = Literal[
    "heavy_object",
    "object_not_found",
    "person_in_way",
    "unknown_object",
    "held_up",
    "robot_broken",
    "object_appeared",
]
NEAR_M = 1.6
"""What a robot that stopped has before it is so near at most."""


class Cause(NamedTuple):
    """`about` is the thing, person or robot that the cause is about, `robot` who met it (empty: nobody)."""

    name: Name
    about: str
    robot: str = ""


def causes(
    words: Words, before: State, predicted: State, believed: State, felt: Mapping[str, str], actions: Iterable[str]
) -> list[Cause]:
    """Why the state is not as predicted, robot by robot, then thing by thing; nothing if it is.

    `before` is what was believed when the step began, `believed` what is now; `actions` are those of the step.
    """
    found = [cause for action in sorted(actions) if (cause := _of(words, before, predicted, believed, felt, action))]
    told = {cause.about for cause in found}
    for thing in words.things(predicted):
        if thing in told or words.holders(predicted, thing):
            continue
        if words.ends(predicted, thing) != words.ends(believed, thing) and not _new_end(
            words, predicted, believed, thing
        ):
            found.append(Cause("object_not_found", thing))
            told.add(thing)
    appeared = [thing for thing in words.things(believed) if thing not in words.things(before) and thing not in told]
    return found + [Cause("object_appeared", thing) for thing in appeared]


def _of(
    words: Words, before: State, predicted: State, believed: State, felt: Mapping[str, str], action: str
) -> Cause | None:
    """What kept a robot from its action; nothing if it is not there any more, which is told by itself."""
    robot = str(parse(action)[1][0])
    if robot not in words.robots(believed):
        return None
    was, now, then = (words.held(state, robot) for state in (before, believed, predicted))
    match felt.get(robot):
        case "too_heavy":
            return Cause("heavy_object", (was or now or then or ("", 0))[0], robot)
        case "nothing_there":
            return Cause("object_not_found", (then or ("", 0))[0], robot)
        case "blocked":
            return _before_it(words, before, believed, robot)
    if now == then and words.cell(believed, robot) == words.cell(predicted, robot):
        return None
    if was is not None and now is None and then is not None:
        return Cause("object_not_found", was[0], robot)
    return Cause("robot_broken", robot, robot)


def _before_it(words: Words, before: State, believed: State, robot: str) -> Cause:
    """What a robot that stopped has before it."""

    def nearest(bodies: Iterable[str]) -> str:
        spots = {body: math.dist(words.point(believed, robot), words.point(believed, body)) for body in bodies}
        return min((body for body in spots if spots[body] <= NEAR_M), key=lambda body: (spots[body], body), default="")

    if person := nearest(words.persons(believed)):
        return Cause("person_in_way", person, robot)
    if thing := nearest(set(words.things(believed)) - set(words.things(before))):
        return Cause("unknown_object", thing, robot)
    return Cause("held_up", nearest(set(words.robots(believed)) - {robot}) or robot, robot)


def _new_end(words: Words, predicted: State, believed: State, thing: str) -> bool:
    """Is all that is new of a thing that it has a second end?"""
    return words.ends(believed, thing)[:1] == words.ends(predicted, thing)
