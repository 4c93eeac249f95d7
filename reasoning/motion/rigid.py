"""Rigid bodies in the plane, moving and turning among a layout's obstacles.

A body is capsules (a segment with a radius; a disc is one whose ends are the same) in its own frame. A pose is where
the frame's origin is, in metres, and how it is turned, in radians. Between two poses of a path a body moves straight
and turns the shorter way, both evenly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from reasoning.motion.convex import Point, Polygon, nearest, turn
from reasoning.motion.layout import WALLS, Layout

Pose = tuple[float, float, float]


class Capsule(NamedTuple):
    a: Point
    b: Point
    radius_m: float


Body = tuple[Capsule, ...]


def carried(length_m: float, robot_m: float, thing_m: float) -> Body:
    """Two robots of radius `robot_m` that hold a thing of half-width `thing_m` by its ends, `length_m` apart; the
    origin is midway, and the second robot ahead."""
    back, front = (-length_m / 2, 0.0), (length_m / 2, 0.0)
    return Capsule(back, back, robot_m), Capsule(front, front, robot_m), Capsule(back, front, thing_m)


def between(first: Point, second: Point) -> Pose:
    """The pose of what two robots at these places carry."""
    (x, y), (x2, y2) = first, second
    return (x + x2) / 2, (y + y2) / 2, math.atan2(y2 - y, x2 - x)


def placed(point: Point, pose: Pose) -> Point:
    """Where a point of the body is."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return pose[0] + c * point[0] - s * point[1], pose[1] + s * point[0] + c * point[1]


def extent(body: Body) -> float:
    """The radius of the disc around the origin in which the body is, metres."""
    return max(math.hypot(*end) + radius for a, b, radius in body for end in (a, b))


def at_share(first: Pose, second: Pose, share: float) -> Pose:
    """The pose at a share (0 to 1) of the way between two poses."""
    return (
        first[0] + share * (second[0] - first[0]),
        first[1] + share * (second[1] - first[1]),
        first[2] + share * turning(first, second),
    )


def turning(first: Pose, second: Pose) -> float:
    """The angle of the shorter turn, from -pi to pi."""
    return math.remainder(second[2] - first[2], 2 * math.pi)


class Surroundings:
    """How far bodies are from the obstacles of a layout."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._solids = [
            (min(x for x, _ in s), min(y for _, y in s), max(x for x, _ in s), max(y for _, y in s), s)
            for s in layout.solids[WALLS:]
        ]

    def clearance(self, body: Body, pose: Pose) -> float:
        """The distance from the body to the nearest obstacle or wall, metres; not above 0 when they overlap."""
        best = math.inf
        for a, b, radius in body:
            best = min(best, self._gap(placed(a, pose), placed(b, pose), radius, best))
        return best

    def moves(self, body: Body, first: Pose, second: Pose, margin_m: float) -> bool:
        """Whether the body keeps off everything all the way between two poses, by a quarter of the margin at least.

        From each pose it goes on only as far as no point of it can have used up the clearance there.
        """
        reach = max(math.hypot(*end) for a, b, _ in body for end in (a, b))
        way_m = math.dist(first[:2], second[:2]) + reach * abs(turning(first, second))
        gone_m = 0.0
        while gone_m < way_m:
            clear = self.clearance(body, at_share(first, second, gone_m / way_m))
            if clear <= margin_m / 2:
                return False
            gone_m += clear - margin_m / 4
        return self.clearance(body, second) > margin_m / 2

    def clear_path(self, body: Body, path: Sequence[Pose], margin_m: float) -> bool:
        """Whether all of a path of poses is clear."""
        return all(self.moves(body, *pair, margin_m) for pair in pairwise(path))

    def _gap(self, a: Point, b: Point, radius: float, best: float) -> float:
        """The capsule's clearance, as far as it is below `best`."""
        (ax, ay), (bx, by) = a, b
        left, right = (ax, bx) if ax < bx else (bx, ax)
        low, high = (ay, by) if ay < by else (by, ay)
        best = min(best, min(left, low, self._layout.width_m - right, self._layout.height_m - high) - radius)
        for x, y, r in self._layout.discs:
            best = min(best, _from_segment((x, y), a, b) - r - radius)
        for x1, y1, x2, y2, core in self._solids:
            away = max(x1 - right, left - x2, y1 - high, low - y2)
            if away - radius < best:
                best = min(best, _apart(a, b, core) - radius)
        return best


def _apart(a: Point, b: Point, core: Polygon) -> float:
    """The distance of a segment from a convex polygon, 0 when they meet."""
    gap = nearest(a, core)[0]
    if a == b or gap == 0.0:
        return gap
    if any(_cross(a, b, c, d) for c, d in zip(core[-1:] + core[:-1], core, strict=True)):
        return 0.0
    return min(gap, nearest(b, core)[0], *(_from_segment(corner, a, b) for corner in core))


def _cross(a: Point, b: Point, c: Point, d: Point) -> bool:
    return (turn(a, b, c) > 0) != (turn(a, b, d) > 0) and (turn(c, d, a) > 0) != (turn(c, d, b) > 0)


def _from_segment(p: Point, a: Point, b: Point) -> float:
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    if square == 0.0:
        return math.dist(p, a)
    t = min(1.0, max(0.0, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square))
    return math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy)
