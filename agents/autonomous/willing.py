"""Whether a team can help another one, or be helped by it: pure, from what it believes and plans."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from agents.autonomous.memory import Memory
from agents.autonomous.thinking import DOOR_UNITS, Thinking
from agents.autonomous.words import Words
from bus.messages import HelpAnswer, HelpCall, Value
from reasoning.geometry import Cell

WORTH_UNITS = 2
"""Help that saves less is not worth the way."""


class Willing(NamedTuple):
    """The answer to a call, and the robot that would go."""

    answer: HelpAnswer
    robot: str = ""


def willing(
    words: Words, static: Mapping[str, Value], thinking: Thinking, now: Memory, caller: str, call: HelpCall, delay: int
) -> Willing:
    """What the team would answer if it had no other promise to keep. It has looked around and has a plan, or is
    engaged."""
    room = words.here(now.state)
    if caller not in (now.peers or ()):
        return _no(call, room, "its caller is out of contact", later=True)
    doors = words.doors(static, now.state).get(call.room, [])
    if not doors:
        return _no(call, room, f"no door leads to {call.room}")
    if room not in words.doors_of(static, call.room):
        return _no(call, room, f"no door leads from {call.room} to {room}")
    if call.kind == "want":
        return _spares(words, static, now, call, delay, room)
    return _gains(words, thinking, now, call, room, doors)


def _spares(words: Words, static: Mapping[str, Value], now: Memory, call: HelpCall, delay: int, room: str) -> Willing:
    """A robot is spared if the own work can wait for so long, there and back included."""
    fit = [r for r in words.robots(now.state) if not call.strong or words.strong(now.state, r)]
    if not fit:
        return _no(call, room, "it has no robot that can")
    free = [r for r in fit if words.held(now.state, r) is None]
    robot, there = (free or fit)[0], DOOR_UNITS + delay
    deadline = words.deadline(static, now.state)
    if deadline and not now.resting and not now.late:
        done = words.now(now.state) + _left(words, now) + 2 * there + call.units
        if done > deadline:
            return _no(call, room, f"it would be done after {done} units, its deadline is at {deadline}", later=True)
    return Willing(HelpAnswer(call.number, True, room, there), robot)


def _gains(words: Words, thinking: Thinking, now: Memory, call: HelpCall, room: str, doors: list[Cell]) -> Willing:
    """Help is accepted by who waits for it, and by who saves enough by it."""
    if now.need is not None and not now.left:
        return Willing(HelpAnswer(call.number, True, room, now.need.units))
    if not now.left:
        return _no(call, room, "it has nothing more to do")
    arrival = words.now(now.state) + call.units
    course = thinking.with_helper(now.state, now.aside, doors[0], arrival)
    saved = 0 if course is None else words.now(now.state) + _left(words, now) - words.now(course.states[-1])
    if saved < WORTH_UNITS:
        return _no(call, room, f"it would save it {max(saved, 0)} units", later=True)
    return Willing(HelpAnswer(call.number, True, room, saved))


def _left(words: Words, now: Memory) -> int:
    """Units that the rest of the plan takes."""
    if now.course is None or not now.left:
        return 0
    return words.now(now.course.states[-1]) - words.now(now.course.states[now.at])


def _no(call: HelpCall, room: str, reason: str, later: bool = False) -> Willing:
    return Willing(HelpAnswer(call.number, False, room, 0, later, reason))
