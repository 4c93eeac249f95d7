"""Plane geometry of convex polygons, in metres: what layouts, connectivity and trajectories are made of.

Polygons are tuples of vertices, counterclockwise, without repeating the first. A *core* is a convex polygon or a
single point; a disc is a core of one point with a radius around it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

Point = tuple[float, float]
Polygon = tuple[Point, ...]
MILLIMETRE = 3
"""Coordinates are rounded to so many decimals."""


def turn(a: Point, b: Point, c: Point) -> float:
    """Twice the signed area of the triangle: positive when a, b, c turn left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@lru_cache(maxsize=4096)
def canonical(vertices: tuple[Point, ...]) -> Polygon:
    """The same simple polygon rounded to 1 mm, counterclockwise, from its least vertex, without idle vertices.

    Raises ValueError when it is no simple polygon with an area.
    """
    if not all(math.isfinite(v) for point in vertices for v in point):
        raise ValueError(f"a polygon with a coordinate that is not finite: {vertices}")
    points = [(round(x, MILLIMETRE), round(y, MILLIMETRE)) for x, y in vertices]
    idle = True
    while idle:
        once = [b for a, b in zip(points[-1:] + points[:-1], points, strict=True) if a != b]
        around = list(zip(once[-1:] + once[:-1], once, once[1:] + once[:1], strict=True))
        # Integers of millimetres, so that "on one line" is exact.
        kept = [b for a, b, c in around if turn(_mm(a), _mm(b), _mm(c)) != 0]
        idle, points = len(kept) < len(points), kept
    if len(points) < 3:
        raise ValueError(f"a polygon needs three corners that are not on one line: {vertices}")
    if len(points) > 3 and not _simple(points):
        raise ValueError(f"a polygon that crosses or touches itself: {vertices}")
    if sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(points, points[1:] + points[:1], strict=True)) < 0:
        points.reverse()
    first = points.index(min(points))
    return tuple(points[first:] + points[:first])


def _mm(point: Point) -> tuple[int, int]:
    return round(point[0] * 1000), round(point[1] * 1000)


def _simple(points: list[Point]) -> bool:
    if len(points) == 4 and (_convex(points) or _convex(points[::-1])):
        return True
    exact = [_mm(p) for p in points]
    edges = list(zip(exact, exact[1:] + exact[:1], strict=True))
    return not any(
        _touch(*edges[i], *edges[j])
        for i in range(len(edges))
        for j in range(i + 2, len(edges))
        if (j + 1) % len(edges) != i
    )


def _touch(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether the closed segments ab and cd have a point in common."""
    s, t, u, v = turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)
    if (s > 0) != (t > 0) and (u > 0) != (v > 0) and 0 not in (s, t, u, v):
        return True
    return any(
        side == 0 and min(e[0], f[0]) <= p[0] <= max(e[0], f[0]) and min(e[1], f[1]) <= p[1] <= max(e[1], f[1])
        for side, p, e, f in ((s, c, a, b), (t, d, a, b), (u, a, c, d), (v, b, c, d))
    )


@lru_cache(maxsize=4096)
def convex_parts(polygon: Polygon) -> tuple[Polygon, ...]:
    """Convex polygons that together cover the canonical `polygon`: ears are cut off, then put together again as long
    as the result is convex (Hertel and Mehlhorn 1983)."""
    if _convex(polygon):
        return (polygon,)
    left = list(polygon)
    parts: list[Polygon] = []
    while len(left) > 3:
        ear = next(i for i in range(len(left)) if _is_ear(left, i))
        parts.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    parts.append(tuple(left))
    i = 0
    while i < len(parts):
        merged = next(((j, m) for j in range(i + 1, len(parts)) if (m := _merged(parts[i], parts[j]))), None)
        if merged is None:
            i += 1
        else:
            j, parts[i] = merged
            del parts[j]
    return tuple(parts)


def _convex(polygon: Sequence[Point]) -> bool:
    return all(turn(polygon[k - 2], polygon[k - 1], polygon[k]) >= 0 for k in range(len(polygon)))


def _is_ear(points: list[Point], i: int) -> bool:
    a, b, c = points[i - 1], points[i], points[(i + 1) % len(points)]
    return turn(a, b, c) > 0 and not any(
        turn(a, b, p) >= 0 and turn(b, c, p) >= 0 and turn(c, a, p) >= 0 for p in points if p not in (a, b, c)
    )


def _merged(a: Polygon, b: Polygon) -> Polygon | None:
    """The union of two convex polygons with a common edge, if it is convex."""
    for i in range(len(a)):
        tail, head = a[i - 1], a[i]
        if tail not in b:
            continue
        k = b.index(tail)
        rest = b[k:] + b[:k]
        if rest[-1] == head:
            ring = a[i:] + a[:i] + rest[1:-1]
            return ring if _convex(ring) else None
    return None


def nearest(p: Point, core: Polygon) -> tuple[float, Point]:
    """Distance of p from a core, 0 inside, and the point of the core that is nearest."""
    if len(core) == 1:
        return math.dist(p, core[0]), core[0]
    px, py = p
    best, at, inside = math.inf, p, True
    ax, ay = core[-1]
    for bx, by in core:
        dx, dy, ex, ey = bx - ax, by - ay, px - ax, py - ay
        if dx * ey - dy * ex < 0:
            inside = False
            t = (dx * ex + dy * ey) / (dx * dx + dy * dy)
            t = 0.0 if t < 0 else 1.0 if t > 1 else t
            x, y = ax + t * dx, ay + t * dy
            if (square := (px - x) ** 2 + (py - y) ** 2) < best:
                best, at = square, (x, y)
        ax, ay = bx, by
    return (0.0, p) if inside else (math.sqrt(best), at)


def closest(a: Polygon, b: Polygon) -> tuple[float, Point, Point]:
    """Distance of two cores, 0 when they overlap, and a nearest point of each."""
    common = _common(a, b) if len(a) > 2 and len(b) > 2 else None
    if common is not None:
        return 0.0, common, common
    one = min((*nearest(p, b), p) for p in a)
    other = min((*nearest(p, a), p) for p in b)
    return (one[0], one[2], one[1]) if one[0] <= other[0] else other


def _common(a: Polygon, b: Polygon) -> Point | None:
    """A point of two convex polygons, if they have one: what is left of a when b cuts it on all sides."""
    left = a
    for tail, head in zip(b[-1:] + b[:-1], b, strict=True):
        left = _clipped(left, tail, head)
        if not left:
            return None
    return centre(left)


def _clipped(polygon: Polygon, tail: Point, head: Point) -> Polygon:
    """The part of a convex polygon that is not right of the line."""
    kept: list[Point] = []
    sides = [turn(tail, head, p) for p in polygon]
    for i, (side, p) in enumerate(zip(sides, polygon, strict=True)):
        before, q = sides[i - 1], polygon[i - 1]
        if (before < 0 < side) or (side < 0 < before):
            t = before / (before - side)
            kept.append((q[0] + t * (p[0] - q[0]), q[1] + t * (p[1] - q[1])))
        if side >= 0:
            kept.append(p)
    return tuple(kept)


def centre(core: Polygon) -> Point:
    """The mean of the vertices: a point inside."""
    return sum(p[0] for p in core) / len(core), sum(p[1] for p in core) / len(core)
