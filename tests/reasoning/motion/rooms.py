"""Seeded rooms, and a second opinion on them from shapely, which shares nothing with the code under test."""

from __future__ import annotations

import math
import random

import shapely
from shapely.geometry import LineString, Point, Polygon, box

from reasoning.motion.layout import Layout

SHAPES = (
    ((0, 0), (1, 0), (1, 1), (0, 1)),
    ((0, 0), (1, 0), (1, 0.3), (0.3, 0.3), (0.3, 1), (0, 1)),
    ((0, 0), (1, 0), (1, 1), (0.8, 1), (0.8, 0.2), (0.2, 0.2), (0.2, 1), (0, 1)),
    ((0, 0), (1, 0), (0.5, 1)),
)
"""A box, a corner sofa, a bay and a wedge, in a square of side 1."""


def drawn(seed: int) -> Layout:
    """A room of 4 to 12 m with furniture at any angle, a broken barrier, and things."""
    rng = random.Random(seed)
    width, height = rng.uniform(4, 12), rng.uniform(4, 9)
    pieces = []
    for _ in range(rng.randint(2, 7)):
        shape, long, wide = rng.choice(SHAPES), rng.uniform(0.4, 3), rng.uniform(0.2, 1.5)
        pieces.append(_piece(shape, long, wide, rng.uniform(0, width), rng.uniform(0, height), rng.uniform(0, 7)))
    y, x = rng.uniform(1, height - 1), 0.0
    while x < width:  # pieces of a barrier, with gaps that may be too narrow
        long = rng.uniform(0.5, 2.5)
        pieces.append(_piece(SHAPES[0], long, 0.15, x, y, rng.uniform(-0.2, 0.2)))
        x += long + rng.uniform(0, 0.65)
    things = [
        (rng.uniform(0, width), rng.uniform(0, height), rng.uniform(0.05, 0.35)) for _ in range(rng.randint(0, 8))
    ]
    return Layout(width, height, tuple(pieces), tuple(things))


def lined_up(seed: int) -> Layout:
    """A room with little furniture and rows of things that a robot may or may not pass between."""
    rng = random.Random(seed)
    pieces = (_piece(SHAPES[0], 2.5, 0.3, rng.uniform(0, 2), rng.uniform(2, 5), rng.uniform(-0.5, 0.5)),)
    things = []
    for _ in range(2):
        x, y = rng.uniform(0.1, 0.5), rng.uniform(1.5, 6.5)
        while x < 8:
            things.append((x, y + rng.uniform(-0.3, 0.3), 0.1))
            x += rng.uniform(0.35, 0.72)
    return Layout(8, 8, pieces, tuple(things))


def _piece(
    shape: tuple[tuple[float, float], ...], long: float, wide: float, x: float, y: float, angle: float
) -> tuple[tuple[float, float], ...]:
    c, s = math.cos(angle), math.sin(angle)
    return tuple((x + c * long * u - s * wide * v, y + s * long * u + c * wide * v) for u, v in shape)


def obstacles(layout: Layout, grown_m: float = 0.0, fine: int = 6) -> shapely.Geometry:
    """Furniture and things, grown; arcs are `fine` chords a quarter turn."""
    shapes = [*(Polygon(p) for p in layout.polygons), *(Point(x, y) for x, y, _ in layout.discs)]
    growth = [grown_m] * len(layout.polygons) + [r + grown_m for _, _, r in layout.discs]
    return shapely.union_all(shapely.buffer(shapes, growth, quad_segs=fine))


def rooms_parts(layout: Layout, grown_m: float, fine: int = 6) -> list[shapely.Geometry]:
    """The connected parts of where the centre of a disc of radius `grown_m` can be."""
    inner = box(grown_m, grown_m, layout.width_m - grown_m, layout.height_m - grown_m)
    free = inner.difference(obstacles(layout, grown_m, fine))
    return [part for part in shapely.get_parts(free) if part.area > 0]


def part_of(parts: list[shapely.Geometry], p: tuple[float, float]) -> int | None:
    """Which part a point is in; None where the disc cannot be."""
    return next((number for number, part in enumerate(parts) if shapely.contains_xy(part, *p)), None)


def clearance(layout: Layout, points: list[tuple[float, float]]) -> float:
    """How near a way comes to an obstacle or a wall, metres; things as polygons of 2048 corners."""
    way = LineString(points)
    x1, y1, x2, y2 = way.bounds
    near = min(x1, y1, layout.width_m - x2, layout.height_m - y2)
    things = [way.distance(Point(x, y)) - r for x, y, r in layout.discs]
    return min(near, *(way.distance(Polygon(p)) for p in layout.polygons), *things, math.inf)
