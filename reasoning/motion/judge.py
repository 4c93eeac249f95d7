"""The judge of motions in a room: discs that go among discs, and pairs of them that carry a thing."""

from __future__ import annotations

import math
from collections.abc import Callable

from reasoning.lessons import Key, Lesson, Motion
from reasoning.motion.convex import Point
from reasoning.motion.layout import Disc, Layout
from reasoning.motion.oracle import Oracle
from reasoning.motion.payload import PayloadPlanner
from reasoning.motion.rigid import between, carried
from reasoning.motion.trajectory import Trajectory, hits
from reasoning.solver import Term


class RoomJudge:
    """Judges motions in the room of a layout, whose discs do not count: obstacles are told with each question.

    `point` tells where a place is, `radius_m` how large a body is, `disc` what a key stands for. An obstacle in the
    middle of a place where a motion begins or ends is in nobody's way. Pairs need a `payload` planner, and are held to
    carry something of half-width `carried_m`. With `furniture_known`, what holds of single bodies without any obstacle
    is not told: the program that asks knows it already.
    """

    def __init__(
        self,
        oracle: Oracle,
        layout: Layout,
        *,
        point: Callable[[Term], Point],
        radius_m: Callable[[Term], float],
        disc: Callable[[Key], Disc],
        payload: PayloadPlanner | None = None,
        carried_m: float = 0.1,
        furniture_known: bool = False,
    ) -> None:
        self._oracle, self._layout = oracle, layout.bare
        self._point, self._radius_m, self._disc = point, radius_m, disc
        self._payload, self._carried_m = payload, carried_m
        self._furniture_known = furniture_known

    def kind(self, body: Term) -> float:
        """Bodies of one radius are alike."""
        return self._radius_m(body)

    def lessons(self, motion: Motion, obstacles: frozenset[Key], limits: tuple[int, ...]) -> list[Lesson]:
        """See `reasoning.lessons.Judge`; limits are metres. What holds of a way holds of the way back."""
        ends = {self._point(place) for place in (*motion.starts, *motion.goals)}
        discs = {key: self._disc(key) for key in sorted(obstacles, key=str)}
        near = {key: disc for key, disc in discs.items() if disc[:2] not in ends}
        if len(motion.kinds) == 2:
            # What ompl did not find one way it may find the other way: only what is asked is told.
            return self._pair(motion, near)
        found = [n for n in self._single(motion, near, limits) if n.obstacles or not self._furniture_known]
        back = Motion(motion.kinds, motion.goals, motion.starts)
        return found + [lesson._replace(motion=back) for lesson in found]

    def _single(self, motion: Motion, near: dict[Key, Disc], limits: tuple[int, ...]) -> list[Lesson]:
        radius_m, start, goal = self._told(motion)
        layout = self._layout.with_discs(near.values())
        blockers = self._oracle.blockers(layout, radius_m, start, goal)
        if blockers is not None:
            keys = list(near)
            return [Lesson(motion, frozenset(keys[i] for i in blockers))]
        if not limits:
            return []
        # Only what is on the way makes it longer: the obstacles that the way hits are put in, until it hits none.
        needed: dict[Key, Disc] = {}
        way = self._way(motion, needed)
        margin_m = self._oracle.margin_m
        while found := {k: d for k, d in near.items() if k not in needed and hits(way, d, radius_m, margin_m)}:
            needed.update(found)
            way = self._way(motion, needed)
        return [
            Lesson(motion, frozenset(self._least(motion, needed, limit)), limit)
            for limit in limits
            if _longer(way, limit)
        ]

    def _least(self, motion: Motion, needed: dict[Key, Disc], limit: int) -> dict[Key, Disc]:
        """Of the obstacles with which the way is longer than the limit, those that are needed for that."""
        for key in list(needed):
            fewer = {other: disc for other, disc in needed.items() if other != key}
            if _longer(self._way(motion, fewer), limit):
                needed = fewer
        return needed

    def _way(self, motion: Motion, discs: dict[Key, Disc]) -> Trajectory:
        way = self._oracle.shortest(self._layout.with_discs(discs.values()), *self._told(motion))
        assert way is not None, "with more obstacles there was one"
        return way

    def _told(self, motion: Motion) -> tuple[float, Point, Point]:
        (kind,), (start,), (goal,) = motion
        assert isinstance(kind, float)
        return kind, self._point(start), self._point(goal)

    def _pair(self, motion: Motion, near: dict[Key, Disc]) -> list[Lesson]:
        """Without a proof, all obstacles are held to be needed."""
        verdict = self._carry(motion, near)
        if verdict == "yes":
            return []
        if self._carry(motion, {}) != "yes":
            return [Lesson(motion, frozenset())]
        needed = near
        for key in list(near) if verdict == "no" else ():
            fewer = {other: disc for other, disc in needed.items() if other != key}
            if self._carry(motion, fewer) == "no":
                needed = fewer
        return [Lesson(motion, frozenset(needed))]

    def _carry(self, motion: Motion, discs: dict[Key, Disc]) -> str:
        assert self._payload is not None, "pairs need a payload planner"
        starts, goals = ([self._point(place) for place in places] for places in motion[1:])
        if abs(math.dist(*starts) - math.dist(*goals)) > 1e-6:
            return "no"
        body = carried(
            math.dist(*starts), max(kind for kind in motion.kinds if isinstance(kind, float)), self._carried_m
        )
        layout = self._layout.with_discs(discs.values())
        return self._payload.path(layout, body, between(*starts), between(*goals)).verdict


def _longer(way: Trajectory, limit: int) -> bool:
    """In whole millimetres."""
    return round(1000 * way.length_m) > 1000 * limit
