"""Plane geometry of points and polygons, in metres: who is near to what, and who sees whom."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import hypot

from world.physics import Point


def away(p: Point, a: Point, b: Point) -> float:
    """How far p is from the segment ab."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    along = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square if square else 0.0
    along = min(max(along, 0.0), 1.0)
    return hypot(p[0] - a[0] - along * dx, p[1] - a[1] - along * dy)


def edges(corners: Sequence[Point]) -> Iterable[tuple[Point, Point]]:
    return pairwise((*corners, corners[0]))


def inside(p: Point, corners: Sequence[Point]) -> bool:
    """Is p inside a polygon? By counting how often a line to the right crosses its edges."""
    odd = False
    for (ax, ay), (bx, by) in edges(corners):
        if (ay > p[1]) != (by > p[1]) and p[0] < ax + (p[1] - ay) * (bx - ax) / (by - ay):
            odd = not odd
    return odd


def off(p: Point, corners: Sequence[Point]) -> float:
    """How far p is from a polygon; 0 inside."""
    return 0.0 if inside(p, corners) else min(away(p, a, b) for a, b in edges(corners))


def hidden(p: Point, q: Point, polygons: Iterable[Sequence[Point]]) -> bool:
    """Does the line of sight pq meet one of the polygons?"""
    return any(inside(p, corners) or any(_cross(p, q, a, b) for a, b in edges(corners)) for corners in polygons)


def _cross(p: Point, q: Point, a: Point, b: Point) -> bool:
    return _left(p, q, a) != _left(p, q, b) and _left(a, b, p) != _left(a, b, q)


def _left(a: Point, b: Point, c: Point) -> bool:
    return (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0])
