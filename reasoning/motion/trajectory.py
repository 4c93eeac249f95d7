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
from itertools import pairwise
from typing import NamedTuple

from reasoning.motion.connectivity import MARGIN_M, REMEMBERED, Connectivity
from reasoning.motion.convex import Point, Polygon
from reasoning.motion.layout import WALLS, Disc, Layout

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


class Edge(NamedTuple):
    """A side of a convex polygon: nx x + ny y > c on the inside, with a normal of length 1."""

    nx: float
    ny: float
    c: float


class Body:
    """A grown obstacle as a convex polygon, with what tests against it need."""

    def __init__(self, corners: Polygon) -> None:
        self.corners = corners
        xs, ys = [x for x, _ in corners], [y for _, y in corners]
        self.box = (min(xs), min(ys), max(xs), max(ys))
        self.edges = tuple(_edge(a, b) for a, b in zip(corners[-1:] + corners[:-1], corners, strict=True))

    def contains(self, p: Point) -> bool:
        """Whether p is inside and does not only touch."""
        x1, y1, x2, y2 = self.box
        return x1 < p[0] < x2 and y1 < p[1] < y2 and all(nx * p[0] + ny * p[1] > c for nx, ny, c in self.edges)

    def cuts(self, px: float, py: float, qx: float, qy: float) -> bool:
        """Whether the segment pq goes through the inside."""
        low, high = 0.0, 1.0
        for nx, ny, c in self.edges:
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


class Corner(NamedTuple):
    """A corner of a body where a way may turn, with the body's sides before and after it."""

    x: float
    y: float
    before: Edge
    after: Edge

    def tangent(self, x: float, y: float) -> bool:
        """Whether the line to the corner leaves the body on one side: it is seen from outside one of the sides."""
        (ax, ay, ac), (bx, by, bc) = self.before, self.after
        return (ax * x + ay * y - ac) * (bx * x + by * y - bc) <= TOUCH_M


class Roadmap:
    """Tangents between the grown obstacles of a layout, found as they are needed and kept."""

    def __init__(self, connectivity: Connectivity) -> None:
        self.connectivity = connectivity
        layout, near = connectivity.layout, connectivity.radius_m
        far = near + connectivity.margin_m
        near += connectivity.margin_m / 10
        self._bodies = [Body(_grown(core, near, far)) for core in layout.solids[WALLS:]]
        self._bodies += [_thing(disc, connectivity.radius_m, connectivity.margin_m) for disc in layout.discs]
        low, right, top = far - TOUCH_M, layout.width_m - far + TOUCH_M, layout.height_m - far + TOUCH_M
        self._corners = [
            Corner(*at, before, after)
            for body in self._bodies
            for at, before, after in zip(body.corners, body.edges, body.edges[1:] + body.edges[:1], strict=True)
            if low <= at[0] <= right and low <= at[1] <= top and not any(b.contains(at) for b in self._bodies)
        ]
        self._between: dict[int, dict[int, float]] = {}
        self._from: dict[Point, dict[int, float]] = {}

    def shortest(self, p: Point, q: Point) -> Trajectory | None:
        """See `shortest`. Of equally long ways, always the same one."""
        if not self.connectivity.path_exists(p, q):
            return None
        if self.sees(*p, *q):
            return Trajectory((p, q), math.dist(p, q))
        # A* with the distance as the crow flies; -1 is the start, -2 the end.
        qx, qy = q
        last = self._seen(q)
        came: dict[int, int] = {}
        length = {-1: 0.0}
        queue = [(0.0, -1)]
        done = set()
        while queue:
            _, node = heapq.heappop(queue)
            if node == -2:
                return self._trajectory(p, q, came)
            if node in done:
                continue
            done.add(node)
            if node in last and length[node] + last[node] < length.get(-2, math.inf):
                length[-2], came[-2] = length[node] + last[node], node
                heapq.heappush(queue, (length[-2], -2))
            for other, step in (self._seen(p) if node == -1 else self._next(node)).items():
                reached = length[node] + step
                if reached < length.get(other, math.inf):
                    length[other], came[other] = reached, node
                    corner = self._corners[other]
                    heapq.heappush(queue, (reached + math.hypot(corner.x - qx, corner.y - qy), other))
        raise ArithmeticError(f"connected, but no way found from {p} to {q} in {self.connectivity.layout}")

    def sees(self, px: float, py: float, qx: float, qy: float) -> bool:
        """Whether the straight way from p to q leaves out all obstacles."""
        left, right = (px, qx) if px < qx else (qx, px)
        low, high = (py, qy) if py < qy else (qy, py)
        for body in self._bodies:
            x1, y1, x2, y2 = body.box
            if x1 < right and left < x2 and y1 < high and low < y2 and body.cuts(px, py, qx, qy):
                return False
        return True

    def _next(self, node: int) -> dict[int, float]:
        """The corners that a way may go to from a corner, with the distances."""
        if node not in self._between:
            corner = self._corners[node]
            self._between[node] = {
                number: step
                for number, step in self._tangents(corner.x, corner.y)
                if number != node
                and corner.tangent(self._corners[number].x, self._corners[number].y)
                and self.sees(corner.x, corner.y, self._corners[number].x, self._corners[number].y)
            }
        return self._between[node]

    def _seen(self, p: Point) -> dict[int, float]:
        """The corners that a way may go to from p, with the distances; the same as those it may come from."""
        if p not in self._from:
            if len(self._from) >= REMEMBERED:
                self._from.clear()
            self._from[p] = {
                number: step
                for number, step in self._tangents(*p)
                if self.sees(*p, self._corners[number].x, self._corners[number].y)
            }
        return self._from[p]

    def _tangents(self, x: float, y: float) -> list[tuple[int, float]]:
        # `Corner.tangent`, written out, since this is where the time goes.
        return [
            (number, math.hypot(cx - x, cy - y))
            for number, (cx, cy, (ax, ay, ac), (bx, by, bc)) in enumerate(self._corners)
            if (ax * x + ay * y - ac) * (bx * x + by * y - bc) <= TOUCH_M
        ]

    def _trajectory(self, p: Point, q: Point, came: dict[int, int]) -> Trajectory:
        points, node = [q], came[-2]
        while node != -1:
            points.append(self._corners[node][:2])
            node = came[node]
        points.append(p)
        points.reverse()
        return Trajectory(tuple(points), sum(map(math.dist, points, points[1:])))


def hits(way: Trajectory, disc: Disc, radius_m: float, margin_m: float = MARGIN_M) -> bool:
    """Whether a way would not be taken if the disc were in the layout."""
    body = _thing(disc, radius_m, margin_m)
    return any(body.cuts(*p, *q) for p, q in pairwise(way.points))


@lru_cache(maxsize=4096)
def _thing(disc: Disc, radius_m: float, margin_m: float) -> Body:
    x, y, r = disc
    return Body(_grown(((x, y),), radius_m + margin_m / 10 + r, radius_m + margin_m + r))


def _edge(a: Point, b: Point) -> Edge:
    """The side from a to b of a counterclockwise polygon; what only touches it is outside."""
    length = math.dist(a, b)
    nx, ny = (a[1] - b[1]) / length, (b[0] - a[0]) / length
    return Edge(nx, ny, nx * a[0] + ny * a[1] + TOUCH_M)


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
            corners += _arc(b, far, first, sweep, math.ceil(sweep / widest) if sweep > TOUCH_M else 0)
    return tuple(corners)


def _arc(at: Point, radius: float, first: float, sweep: float, count: int) -> Polygon:
    angles = [first + sweep * k / max(count, 1) for k in range(count + 1)]
    return tuple((at[0] + radius * math.cos(angle), at[1] + radius * math.sin(angle)) for angle in angles)
