"""From the actions of a step to what the world is asked: each with its way, and the units of time that it is given."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import pairwise

from agents.autonomous.passing import lets_by
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
OFF_M = (0.01, 0.02, 0.03, 0.05, 0.08, 0.12)
"""So far a robot goes first that stands nearer to something than ways come to it."""
ROUND = 16
"""In so many directions it looks for a place."""
NEARBY = 8
"""So many pairs of cells are tried to put down what two robots carry."""
LEAST_M = 0.01
"""Obstacles that would have to be smaller than this to let a robot go are left out."""


class NoWay(Exception):  # noqa: N818 - it reads as what happened
    """A robot has no way to where it is to go while all of `goals` go theirs. `behind` are robots that stand about:
    without them there would be one."""

    def __init__(self, robot: str, goals: Mapping[str, Cell], behind: tuple[str, ...] = ()) -> None:
        x, y = goals[robot]
        past = f" past {' and '.join(behind)}" if behind else ""
        super().__init__(f"{robot} has no way to ({x},{y}){past}")
        self.robot, self.goals, self.behind = robot, dict(goals), behind


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
        """A robot's way while all of `goals` go theirs, round what lies and who stands about. Raises NoWay."""
        words, held = self._words, self._words.held(state, robot)
        start, goal = words.point(state, robot), middle(goals[robot])
        moved = {end[0] for other in goals if (end := words.held(state, other)) is not None}
        partner = words.holders(state, held[0]).get(3 - held[1]) if held is not None else None
        if held is not None and partner is not None and partner in goals:
            ends = [(words.point(state, each), middle(goals[each])) for each in (robot, partner)]
            first, second = ends if held[1] == 1 else reversed(ends)
            starts = [ends[0][0], ends[1][0]]
            lying = [*self._lying(state, moved, starts, []), *discs]
            offset = (math.dist(first[0], second[0]) / 2) * (-1 if held[1] == 1 else 1)

            def together(robots: Iterable[Disc]) -> tuple[Point, ...] | None:
                poses = self._carried(first, second, self._spared([*lying, *robots], starts))
                return tuple(placed((offset, 0.0), pose) for pose in poses) if poses is not None else None

            return self._past(state, robot, goals, together)
        lying = [*self._lying(state, moved, [start], [] if held is not None else [goals[robot]]), *discs]
        return self._past(state, robot, goals, lambda robots: self._alone([*lying, *robots], start, goal))

    def _past(
        self,
        state: State,
        robot: str,
        goals: Mapping[str, Cell],
        find: Callable[[Iterable[Disc]], tuple[Point, ...] | None],
    ) -> tuple[Point, ...]:
        """The way that `find` finds past the robots that stand about. Raises NoWay."""
        others = [other for other in self._words.robots(state) if other not in goals]
        standing = {other: (*self._words.point(state, other), self._room.robot_m) for other in others}
        if (found := find(standing.values())) is not None:
            return found
        behind = others if others and find(()) is not None else []
        for other in list(behind) if len(behind) > 1 else ():
            fewer = [each for each in behind if each != other]
            if find(disc for each, disc in standing.items() if each not in fewer) is not None:
                behind = fewer
        raise NoWay(robot, goals, tuple(behind))

    def _alone(self, discs: Sequence[Disc], start: Point, goal: Point) -> tuple[Point, ...] | None:
        """A shortest way past these obstacles; None if there is none. Robots stop with something nearer to them than
        ways come to it: then it leads away from there first."""
        room, oracle = self._room, self._oracle
        turns = [math.tau * k / ROUND for k in range(ROUND)]
        near = [(start[0] + far * math.cos(turn), start[1] + far * math.sin(turn)) for far in OFF_M for turn in turns]
        for obstacles in (discs, self._spared(discs, [start])):
            layout = room.layout.with_discs(obstacles)
            first = next((at for at in (start, *near) if oracle.free(layout, room.robot_m, at)), None)
            if first is not None:
                found = oracle.shortest(layout, room.robot_m, first, goal)
                ahead = () if first == start else (start,)
                return (*ahead, *found.points) if found is not None else None
        return None

    def _spared(self, discs: Iterable[Disc], starts: Sequence[Point]) -> list[Disc]:
        """Obstacles, those smaller that robots at their starts are too near to: they may go, but come no nearer."""
        keep_m = self._room.robot_m + self._oracle.margin_m + 0.001
        spared = [(x, y, min(r, min(math.dist((x, y), at) for at in starts) - keep_m)) for x, y, r in discs]
        return [disc for disc in spared if disc[2] >= LEAST_M]

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

    def nearest_cell(
        self,
        state: State,
        robot: str,
        taken: Collection[Cell | None],
        discs: Sequence[Disc],
        suits: Callable[[Cell], bool] = lambda _: True,
    ) -> Cell | None:
        """The nearest cell whose middle a robot can get to, of those that are not taken and suit; None if there is
        none. `discs` are obstacles besides what lies and who stands about."""
        x, y = self._words.point(state, robot)
        for c in sorted(self._room.cells, key=lambda c: (math.dist((x, y), middle(c)), c)):
            if c not in taken and self._goes(state, robot, {robot: c}, discs) and suits(c):
                return c
        return None

    def nearest_cells(
        self, state: State, robot: str, partner: str, taken: Collection[Cell | None], discs: Sequence[Disc]
    ) -> dict[str, Cell]:
        """As `nearest_cell` for two robots that carry one thing; only those nearby are tried."""
        here, there = (self._words.point(state, each) for each in (robot, partner))
        own = {self._words.cell(state, each) for each in (robot, partner)}
        free = [c for c in self._room.cells if c in own or c not in taken]
        pairs = [(c, d) for c in free for d in free if abs(c[0] - d[0]) + abs(c[1] - d[1]) == 1]
        pairs.sort(key=lambda pair: (math.dist(here, middle(pair[0])) + math.dist(there, middle(pair[1])), pair))
        nearby = ({robot: c, partner: d} for c, d in pairs[:NEARBY])
        return next((goals for goals in nearby if self._goes(state, robot, goals, discs)), {})

    def _goes(self, state: State, robot: str, goals: Mapping[str, Cell], discs: Iterable[Disc]) -> bool:
        """Has it a way?"""
        try:
            self.way(state, robot, goals, discs)
        except NoWay:
            return False
        return True

    def aside(self, state: State, blocker: str, refused: NoWay, discs: Sequence[Disc]) -> Cell | None:
        """The nearest cell to which a robot can step aside, round `discs` too, so that another one does not have to get
        past it; None if there is none, or it cannot go by itself."""
        words, held = self._words, self._words.held(state, blocker)
        if held is not None and len(words.ends(state, held[0])) == 2:
            return None
        keys = [f"{words.place}({body})" for body in (blocker, *([held[0]] if held is not None else []))]
        before = {key: value for key, value in state.items() if key != f"{words.pose}({blocker})"}

        def suits(c: Cell) -> bool:
            try:
                then = {**before, **dict.fromkeys(keys, f"({c[0]},{c[1]})")}
                self.way(then, refused.robot, refused.goals)
            except NoWay as error:
                return bool(error.behind) and blocker not in error.behind
            return True

        others = (words.cell(state, other) for other in words.robots(state))
        return self.nearest_cell(state, blocker, {*others, *refused.goals.values()}, discs, suits)

    def passing(self, state: State, robot: str, person: Point, discs: Sequence[Disc]) -> Cell | None:
        """As `aside`, for a `person` who comes towards the robot."""
        words, held = self._words, self._words.held(state, robot)
        if held is not None and len(words.ends(state, held[0])) == 2:
            return None
        others = {other: words.point(state, other) for other in words.robots(state) if other != robot}
        suits = lets_by(self._room, self._oracle, words.point(state, robot), person, [*others.values()])
        return self.nearest_cell(state, robot, {words.cell(state, other) for other in others}, discs, suits)

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
