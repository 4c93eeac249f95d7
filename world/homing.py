"""How a robot that is on its own finds a way over the floor of a room: the shortest one over points half a metre apart,
past walls, furniture, and all that stands and lies about."""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterable
from math import ceil, dist, inf

from world import lookout, plane
from world.physics import Point
from world.tasks import Cell
from world.things import Thing
from world.truth import Truth

STEP_M = 0.5
SPACING_M = 0.1
"""In such steps it looks whether a piece of the way is clear."""
CLEAR_M = 0.01
"""So much farther than need be it keeps off everything."""
Node = tuple[int, int]


def way_to(truth: Truth, robot: Thing, goals: Collection[Cell]) -> list[Point]:
    """From where it stands to the middle of the nearest of these cells; empty if it finds no way."""
    ox, oy = truth.layout.origin(robot.place)
    start = truth.local(robot)
    clear = _Clear(truth, robot, goals)
    ends = {(2 * x + 1, 2 * y + 1) for x, y in goals if clear.at((x + 0.5, y + 0.5))}
    best: dict[Node, float] = {}
    before: dict[Node, Node] = {}
    queue: list[tuple[float, Node, Node]] = []
    if not ends:
        return []
    first = round(start[0] / STEP_M), round(start[1] / STEP_M)
    for node in (first, *_around(first)):
        if clear.between(start, _point(node)):
            heapq.heappush(queue, (dist(start, _point(node)), node, node))
    while queue:
        far_m, node, came = heapq.heappop(queue)
        if node in before:
            continue
        before[node] = came
        if node in ends:
            break
        for other in _around(node):
            there_m = far_m + dist(_point(node), _point(other))
            if there_m < best.get(other, inf) and clear.between(_point(node), _point(other)):
                best[other] = there_m
                heapq.heappush(queue, (there_m, other, node))
    else:
        return []
    way = [_point(node)]
    while before[node] != node:
        node = before[node]
        way.append(_point(node))
    return [(ox + x, oy + y) for x, y in (start, *reversed(way))]


def _point(node: Node) -> Point:
    return node[0] * STEP_M, node[1] * STEP_M


def _around(node: Node) -> Iterable[Node]:
    return ((node[0] + i, node[1] + j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0))


class _Clear:
    """Where in a room the middle of a robot may be, in the room's own coordinates. What lies under it at the start is
    not in its way, nor what lies in a cell where it is to stop, if it holds nothing."""

    def __init__(self, truth: Truth, robot: Thing, goals: Collection[Cell]) -> None:
        self._space, (ox, oy) = truth.layout.spaces[robot.place], truth.layout.origin(robot.place)
        self._radius_m, here = truth.kind(robot).radius_m, truth.floor.where(robot.id)
        self._discs: list[tuple[Point, float]] = []
        for thing in truth.of(robot.place):
            if thing is robot or thing.id == robot.partner:
                continue
            for disc in lookout.discs(truth, thing):
                near_m = self._radius_m + disc.radius_m
                lies = truth.kind(thing).role == "object"
                under = lies and dist(disc.at, here) < near_m
                at_goal = lies and not robot.end and truth.layout.nearest(robot.place, disc.at) in goals
                if not under and not at_goal:
                    self._discs.append(((disc.at[0] - ox, disc.at[1] - oy), near_m + CLEAR_M))

    def at(self, p: Point) -> bool:
        """May it stand here?"""
        room_m = min(p[0], p[1], self._space.width - p[0], self._space.height - p[1])
        return (
            room_m >= self._radius_m
            and all(dist(p, at) >= near_m for at, near_m in self._discs)
            and all(plane.off(p, solid.corners) >= self._radius_m for solid in self._space.solids)
        )

    def between(self, a: Point, b: Point) -> bool:
        """May it go straight from a, where it may stand, to b?"""
        pieces = max(1, ceil(dist(a, b) / SPACING_M))
        return all(self.at(lookout.between(a, b, k / pieces)) for k in range(1, pieces + 1))
