"""From the actions of a step to what the world is asked: each with its way, and the units of time that it is given."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise

from agents.autonomous.words import Words
from bus.messages import SkillCall, Value
from reasoning.geometry import Cell, Room, middle
from reasoning.motion.convex import Point
from reasoning.motion.layout import Disc
from reasoning.motion.oracle import Oracle
from reasoning.motion.payload import PayloadPlanner
from reasoning.motion.rigid import Pose, at_share, between, carried, placed, turning
from reasoning.solver import parse
from reasoning.values import State

TURN_RAD = math.radians(15)
"""Turns are told in pieces of so much."""


class NoWay(Exception):  # noqa: N818 - it reads as what happened
    """A robot has no way to where it is to go."""

    def __init__(self, robot: str, goal: Cell) -> None:
        super().__init__(f"{robot} has no way to ({goal[0]},{goal[1]})")
        self.robot, self.goal = robot, goal


class Ways:
    """Ways in one room. `fast_m` and `careful_m` are the metres that a robot goes in a unit of time, with and without
    something fragile, of which only the plan knows."""

    def __init__(self, words: Words, room: Room, fast_m: float, careful_m: float) -> None:
        self._words, self._room = words, room
        self._fast_m, self._careful_m = fast_m, careful_m
        self._oracle = Oracle()
        self._payload = PayloadPlanner(self._oracle)

    def calls(
        self, state: State, actions: Sequence[str], details: Mapping[str, Mapping[str, Value]], units: int
    ) -> tuple[SkillCall, ...]:
        """The actions of one step from `state`, planned to take so many units. Raises NoWay."""
        goals = {
            str(args[0]): (int(args[1]), int(args[2])) for name, args in map(parse, actions) if name == self._words.go
        }
        made = []
        for action in actions:
            name, args = parse(action)
            detail = dict(details.get(action, {}))
            if name == self._words.go:
                way = self.way(state, str(args[0]), goals)
                detail |= {"way": _written(way), "units": self._units(way, units)}
            made.append(SkillCall(name, args, detail))
        return tuple(made)

    def way(self, state: State, robot: str, goals: Mapping[str, Cell], discs: Iterable[Disc] = ()) -> tuple[Point, ...]:
        """A robot's way while all of `goals` go theirs. Raises NoWay."""
        words, held = self._words, self._words.held(state, robot)
        start, goal = words.point(state, robot), middle(goals[robot])
        moved = {end[0] for other in goals if (end := words.held(state, other)) is not None}
        partner = words.holders(state, held[0]).get(3 - held[1]) if held is not None else None
        if held is not None and partner is not None and partner in goals:
            ends = [(words.point(state, each), middle(goals[each])) for each in (robot, partner)]
            first, second = ends if held[1] == 1 else reversed(ends)
            lying = self._lying(state, moved, [ends[0][0], ends[1][0]], [])
            poses = self._carried(first, second, lying)
            if poses is None:
                raise NoWay(robot, goals[robot])
            offset = (math.dist(first[0], second[0]) / 2) * (-1 if held[1] == 1 else 1)
            return tuple(placed((offset, 0.0), pose) for pose in poses)
        lying = self._lying(state, moved, [start], [] if held is not None else [goals[robot]])
        layout = self._room.layout.with_discs([*lying, *discs])
        found = self._oracle.shortest(layout, self._room.robot_m, start, goal)
        if found is None:
            raise NoWay(robot, goals[robot])
        return found.points

    def _lying(
        self, state: State, moved: Collection[str], starts: Sequence[Point], goals: Sequence[Cell]
    ) -> list[Disc]:
        """What is in the way: all that lies about, but for what is under a robot at its start, or at its goal."""
        found = []
        for thing in self._words.things(state):
            ends = self._words.ends(state, thing)
            discs = [self._room.thing(end) for end in ends]
            if len(ends) == 2:  # what is between the ends is in the way, too
                (ax, ay, radius_m), (bx, by, _) = discs
                discs += [(ax + (bx - ax) * k / 4, ay + (by - ay) * k / 4, radius_m) for k in (1, 2, 3)]
            near = self._room.robot_m + self._room.thing_m
            under = any(math.dist(disc[:2], start) < near for disc in discs for start in starts)
            if thing not in moved and not under and not set(ends) & set(goals):
                found += discs
        return found

    def driving(self, state: State, robot: str, goals: Mapping[str, Cell], discs: Iterable[Disc]) -> SkillCall:
        """A call that takes a robot from where it stands to its goal, with care. `discs` are obstacles besides what
        lies about. Raises NoWay."""
        x, y = goals[robot]
        way = self.way(state, robot, goals, discs)
        return SkillCall(self._words.go, (robot, x, y), {"way": _written(way), "units": self._units(way, 0)})

    def nearest_cell(self, state: State, robot: str, taken: Collection[Cell | None]) -> Cell:
        """The cell nearest to a robot whose middle it can get to, of those that are not taken; of all cells if there is
        none."""
        x, y = self._words.point(state, robot)
        near = sorted(self._room.cells, key=lambda c: (math.dist((x, y), middle(c)), c))
        for c in near:
            if c not in taken:
                try:
                    self.way(state, robot, {robot: c})
                except NoWay:
                    continue
                return c
        return near[0]

    def _carried(
        self, first: tuple[Point, Point], second: tuple[Point, Point], lying: Sequence[Disc]
    ) -> list[Pose] | None:
        """The poses of what two robots carry, the first at its end 1; None if there is no way."""
        body = carried(math.dist(first[0], second[0]), self._room.robot_m, self._room.thing_m)
        layout = self._room.layout.with_discs(lying)
        answer = self._payload.path(layout, body, between(first[0], second[0]), between(first[1], second[1]))
        return _in_chords(answer.path) if answer.verdict == "yes" else None

    def _units(self, way: Sequence[Point], planned: int) -> int:
        """The units for a way that was planned to take `planned`. One that has become longer is gone with care."""
        length_m = sum(math.dist(a, b) for a, b in pairwise(way))
        if length_m <= planned * self._fast_m + 1e-6:
            return max(planned, 1)
        return max(1, math.ceil(length_m / self._careful_m - 1e-6))


def _in_chords(poses: Sequence[Pose]) -> list[Pose]:
    """The same path with its turns in small pieces."""
    made = [poses[0]]
    for a, b in pairwise(poses):
        pieces = max(1, math.ceil(abs(turning(a, b)) / TURN_RAD))
        made += [at_share(a, b, k / pieces) for k in range(1, pieces + 1)]
    return made


def _written(way: Sequence[Point]) -> str:
    """As a term, in millimetres."""
    return f"({','.join(f'({round(1000 * x)},{round(1000 * y)})' for x, y in way)})"
