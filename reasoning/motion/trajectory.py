"""Shortest trajectories of a disc, by the visibility graph of the grown obstacles.

Corners of a grown obstacle are arcs; they are cut by chords so short that the disc still keeps off the obstacle.
Only edges that are tangents at both ends can be on a shortest way; they are looked for when the search gets there
(Lozano-Perez and Wesley 1979; Liu and Arimoto 1992 for the tangents), and kept.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass
from functools import lru_cache

from reasoning.motion.connectivity import MARGIN_M, Connectivity
from reasoning.motion.convex import Point, Polygon, turn
from reasoning.motion.layout import Layout

TOUCH_M = 1e-7
"""Ways may touch obstacles; so much deeper they do not."""


@dataclass(frozen=True)
class Trajectory:
    """The corners of a way, both ends included, and its length in metres."""

    points: tuple[Point, ...]
    length_m: float


def shortest(layout: Layout, radius_m: float, p: Point, q: Point, margin_m: float = MARGIN_M) -> Trajectory | None:
    """A shortest way from p to q of a disc that keeps off all obstacles; None if and only if `Connectivity` says that
    there is no path. Shorter than the exact shortest way with the margin by what the chords save."""
    return roadmap(layout, radius_m, margin_m).shortest(p, q)


@lru_cache(maxsize=512)
def roadmap(layout: Layout, radius_m: float, margin_m: float = MARGIN_M) -> Roadmap:
    """The roadmap of a layout, made once."""
    return Roadmap(Connectivity(layout, radius_m, margin_m))


class Body:
    """A grown obstacle as a convex polygon, with what tests against it need."""

    def __init__(self, corners: Polygon) -> None:
        self.corners = corners
        xs, ys = [x for x, _ in corners], [y for _, y in corners]
        self.box = (min(xs), min(ys), max(xs), max(ys))
        self._edges = []
        for (ax, ay), (bx, by) in zip(corners[-1:] + corners[:-1], corners, strict=True):
            length = math.hypot(bx - ax, by - ay)
            nx, ny = (ay - by) / length, (bx - ax) / length
            self._edges.append((nx, ny, nx * ax + ny * ay + TOUCH_M))

    def contains(self, p: Point) -> bool:
        """Whether p is inside and does not only touch."""
        return all(nx * p[0] + ny * p[1] > c for nx, ny, c in self._edges)

    def cuts(self, px: float, py: float, qx: float, qy: float) -> bool:
        """Whether the segment pq goes through the inside."""
        low, high = 0.0, 1.0
        for nx, ny, c in self._edges:
            d, e = nx * px + ny * py - c, nx * qx + ny * qy - c
            if d <= 0:
                if e <= 0:
                    return False
                low = max(low, d / (d - e))
            elif e <= 0:
                high = min(high, d / (d - e))
            if low >= high:
                return False
        return True


class Corner:
    """A corner of a body where a way may turn: the corners before and after it on the body."""

    __slots__ = ("after", "at", "before")

    def __init__(self, before: Point, at: Point, after: Point) -> None:
        self.before, self.at, self.after = before, at, after

    def tangent(self, p: Point) -> bool:
        """Whether the line from p to the corner leaves the body on one side."""
        one, other = turn(p, self.at, self.before), turn(p, self.at, self.after)
        return (one >= -TOUCH_M and other >= -TOUCH_M) or (one <= TOUCH_M and other <= TOUCH_M)


class Roadmap:
    """Tangents between the grown obstacles of a layout, found as they are needed and kept."""

    def __init__(self, connectivity: Connectivity) -> None:
        self.connectivity = connectivity
        layout, near = connectivity.layout, connectivity.radius_m
        far = near + connectivity.margin_m
        near += connectivity.margin_m / 10
        walls = len(Layout(layout.width_m, layout.height_m).solids)
        shapes = [_grown(core, near, far) for core in layout.solids[walls:]]
        shapes += [_grown(((x, y),), near + r, far + r) for x, y, r in layout.discs]
        self._bodies = [Body(shape) for shape in shapes]
        low, right, top = far - TOUCH_M, layout.width_m - far + TOUCH_M, layout.height_m - far + TOUCH_M
        self._corners = [
            Corner(*around)
            for shape in shapes
            for around in zip(shape[-1:] + shape[:-1], shape, shape[1:] + shape[:1], strict=True)
            if low <= around[1][0] <= right
            and low <= around[1][1] <= top
            and not any(body.contains(around[1]) for body in self._bodies)
        ]
        self._edges: dict[int, list[tuple[int, float]]] = {}

    def shortest(self, p: Point, q: Point) -> Trajectory | None:
        """See `shortest`. Of equally long ways, always the same one."""
        if not self.connectivity.path_exists(p, q):
            return None
        if self.sees(p, q):
            return Trajectory((p, q), math.dist(p, q))
        # A* with the distance as the crow flies; -1 is the start, -2 the end.
        came: dict[int, int] = {}
        length = {-1: 0.0}
        queue = [(math.dist(p, q), -1)]
        done = set()
        while queue:
            _, node = heapq.heappop(queue)
            if node == -2:
                return self._trajectory(p, q, came)
            if node in done:
                continue
            done.add(node)
            for other, step in self._next(node, p, q):
                reached = length[node] + step
                if reached < length.get(other, math.inf):
                    length[other], came[other] = reached, node
                    left = 0.0 if other == -2 else math.dist(self._corners[other].at, q)
                    heapq.heappush(queue, (reached + left, other))
        raise ArithmeticError(f"connected, but no way found from {p} to {q} in {self.connectivity.layout}")

    def sees(self, p: Point, q: Point) -> bool:
        """Whether the straight way from p to q leaves out all obstacles."""
        (px, py), (qx, qy) = p, q
        left, right = (px, qx) if px < qx else (qx, px)
        low, high = (py, qy) if py < qy else (qy, py)
        for body in self._bodies:
            x1, y1, x2, y2 = body.box
            if x1 < right and left < x2 and y1 < high and low < y2 and body.cuts(px, py, qx, qy):
                return False
        return True

    def _next(self, node: int, p: Point, q: Point) -> list[tuple[int, float]]:
        if node == -1:
            return self._tangents(p, None)
        corner = self._corners[node]
        if node not in self._edges:
            self._edges[node] = self._tangents(corner.at, corner)
        edges = self._edges[node]
        if corner.tangent(q) and self.sees(corner.at, q):
            return [*edges, (-2, math.dist(corner.at, q))]
        return edges

    def _tangents(self, at: Point, start: Corner | None) -> list[tuple[int, float]]:
        return [
            (number, math.dist(at, corner.at))
            for number, corner in enumerate(self._corners)
            if corner is not start
            and corner.tangent(at)
            and (start is None or start.tangent(corner.at))
            and self.sees(at, corner.at)
        ]

    def _trajectory(self, p: Point, q: Point, came: dict[int, int]) -> Trajectory:
        points, node = [q], came[-2]
        while node != -1:
            points.append(self._corners[node].at)
            node = came[node]
        points.append(p)
        points.reverse()
        return Trajectory(tuple(points), sum(map(math.dist, points, points[1:])))


def _grown(core: Polygon, near: float, far: float) -> Polygon:
    """A convex polygon between the core grown by `near` and grown by `far`, both metres."""
    widest = 2 * math.acos(near / far)
    if len(core) == 1:
        count = max(3, math.ceil(2 * math.pi / widest))
        return _arc(core[0], far, 0.0, 2 * math.pi, count)[:-1]
    corners: list[Point] = []
    for a, b, c in zip(core[-1:] + core[:-1], core, core[1:] + core[:1], strict=True):
        first = math.atan2(a[0] - b[0], b[1] - a[1])  # where the outward normal of ab points to
        sweep = (math.atan2(b[0] - c[0], c[1] - b[1]) - first) % (2 * math.pi)
        if sweep < math.pi:  # or rounding took a straight corner for one that turns right
            corners += _arc(b, far, first, sweep, math.ceil(sweep / widest))
    return tuple(corners)


def _arc(at: Point, radius: float, first: float, sweep: float, count: int) -> Polygon:
    angles = [first + sweep * k / max(count, 1) for k in range(count + 1)]
    return tuple((at[0] + radius * math.cos(angle), at[1] + radius * math.sin(angle)) for angle in angles)
