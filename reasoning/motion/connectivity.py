"""Whether a disc gets from one point to another in a layout: exact, "no" included, without searching for a way.

A convex obstacle grown by the disc's radius is convex. Two free points are separated if and only if a cycle of grown
obstacles, each overlapping the next, goes round one of them and not round the other. The cycles of a spanning forest
of the overlaps generate all others, so each point gets a signature, one bit for each of these cycles that goes round
it, and two points are connected if and only if their signatures are equal.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cached_property, lru_cache

from reasoning.motion.convex import Point, Polygon, centre, closest, nearest
from reasoning.motion.cycles import Graph, Link, Segment, cycle_segments, meets, shortest_odd
from reasoning.motion.layout import Disc, Layout

MARGIN_M = 0.01
"""Connectivity is decided for a disc that is larger by so much, so that a trajectory has room."""
ROW_M = 0.5
"""Pieces of cycles are sorted into rows of so many metres."""
REMEMBERED = 4096
"""How many points a layout remembers."""


class Connectivity:
    """Connectivity of the free space of a disc of `radius_m` in a layout, with `margin_m` all around.

    Raises ValueError unless the radius is at least 0 and the margin at least 1 mm. Touching is allowed.
    """

    def __init__(self, layout: Layout, radius_m: float, margin_m: float = MARGIN_M) -> None:
        if not (math.isfinite(radius_m) and radius_m >= 0):
            raise ValueError(f"the radius of a disc is at least 0, not {radius_m}")
        if not (math.isfinite(margin_m) and margin_m >= 0.001):
            raise ValueError(f"the margin is at least 1 mm, not {margin_m}")
        self.layout, self.radius_m, self.margin_m = layout, radius_m, margin_m
        self._reach = radius_m + margin_m
        self._boxes = _boxes(layout.bare, self._reach)
        self._discs = [(x, y, (r + self._reach) ** 2) for x, y, r in layout.discs]
        self._signatures: dict[Point, int | None] = {}

    def with_discs(self, discs: Iterable[Disc]) -> Connectivity:
        """The same room and robot with other discs; what belongs to the furniture is not computed again."""
        return Connectivity(self.layout.with_discs(discs), self.radius_m, self.margin_m)

    def free(self, p: Point) -> bool:
        """Whether the disc can be at p."""
        return not self._in_furniture(p) and not self._in_discs(p)

    def path_exists(self, p: Point, q: Point) -> bool:
        """Whether the disc can be at p and at q and get from one to the other."""
        first = self._signature(p)
        return first is not None and first == self._signature(q)

    def blockers(self, p: Point, q: Point) -> frozenset[int] | None:
        """None if there is a path. Otherwise the numbers of a smallest set of discs that with the furniture leaves no
        path: without any one of them there is one. Empty when the furniture is enough."""
        if self.path_exists(p, q):
            return None
        if not _connectivity(self.layout.bare, self.radius_m, self.margin_m).path_exists(p, q):
            return frozenset()
        covering = [*self._in_discs(p), *self._in_discs(q)]
        return frozenset((min(covering),)) if covering else self._ring(p, q)

    def _in_furniture(self, p: Point) -> bool:
        x, y = p
        for x1, y1, x2, y2, core in self._boxes:
            if x1 < x < x2 and y1 < y < y2 and nearest(p, core)[0] < self._reach:
                return True
        return False

    def _in_discs(self, p: Point) -> list[int]:
        x, y = p
        return [i for i, (cx, cy, square) in enumerate(self._discs) if (x - cx) ** 2 + (y - cy) ** 2 < square]

    def _signature(self, p: Point) -> int | None:
        """Which cycles go round p, as bits; None where the disc cannot be."""
        if p in self._signatures:
            return self._signatures[p]
        signature = None
        if self.free(p):
            signature, (x, y) = 0, p
            for low, high, foot, slope, mask in self._rows[int(y / ROW_M)]:
                if low <= y < high and x < foot + (y - low) * slope:  # on the half-line from p to the right
                    signature ^= mask
        if len(self._signatures) >= REMEMBERED:
            self._signatures.clear()
        self._signatures[p] = signature
        return signature

    @cached_property
    def _links(self) -> tuple[Link, ...]:
        return _furniture_links(self.layout.bare, self._reach) + _disc_links(self.layout, self._reach)

    @cached_property
    def _rows(self) -> list[list[Segment]]:
        """The segments of cycles in each row of the room."""
        rows: list[list[Segment]] = [[] for _ in range(int(self.layout.height_m / ROW_M) + 1)]
        for segment in cycle_segments(self._links):
            first, last = max(0, int(segment.low / ROW_M)), min(len(rows) - 1, int(segment.high / ROW_M))
            for row in rows[first : last + 1]:
                row.append(segment)
        return rows

    def _ring(self, p: Point, q: Point) -> frozenset[int]:
        """The discs of an odd cycle with the fewest discs: one that goes round p and not q, or round q and not p."""
        solids = len(self.layout.solids)
        next_to: Graph = {}
        for a, b, way in self._links:
            odd = sum(meets(p, way[i], way[i + 1]) ^ meets(q, way[i], way[i + 1]) for i in range(3)) % 2
            next_to.setdefault(a, []).append((b, odd))
            next_to.setdefault(b, []).append((a, odd))
        best: list[int] = []
        for start in sorted(i for i in next_to if i >= solids):
            found = shortest_odd(next_to, start, solids)
            if found and (not best or len(found) < len(best)):
                best = found
        return frozenset(i - solids for i in best)


@lru_cache(maxsize=1024)
def _connectivity(layout: Layout, radius_m: float, margin_m: float) -> Connectivity:
    return Connectivity(layout, radius_m, margin_m)


Boxed = tuple[float, float, float, float, Polygon]


@lru_cache(maxsize=256)
def _boxes(bare: Layout, reach_m: float) -> tuple[Boxed, ...]:
    """The furniture and walls, each with the box in which the disc's centre may be too near."""
    return tuple(
        (
            min(x for x, _ in core) - reach_m,
            min(y for _, y in core) - reach_m,
            max(x for x, _ in core) + reach_m,
            max(y for _, y in core) + reach_m,
            core,
        )
        for core in bare.solids
    )


@lru_cache(maxsize=256)
def _furniture_links(bare: Layout, reach_m: float) -> tuple[Link, ...]:
    links = []
    boxes = _boxes(bare, reach_m)
    for i, (x1, y1, x2, y2, a) in enumerate(boxes):
        for j, (x3, y3, x4, y4, b) in enumerate(boxes[:i]):
            if x1 < x4 and x3 < x2 and y1 < y4 and y3 < y2:
                gap, on_a, on_b = closest(a, b)
                if gap < 2 * reach_m:
                    links.append(Link(i, j, (centre(a), on_a, on_b, centre(b))))
    return tuple(links)


def _disc_links(layout: Layout, reach_m: float) -> tuple[Link, ...]:
    links, solids = [], len(layout.solids)
    boxes = _boxes(layout.bare, 2 * reach_m)
    for i, (x, y, r) in enumerate(layout.discs):
        at = (x, y)
        for j, (x1, y1, x2, y2, core) in enumerate(boxes):
            if x1 < x + r and x - r < x2 and y1 < y + r and y - r < y2:
                gap, on_core = nearest(at, core)
                if gap < r + 2 * reach_m:
                    links.append(Link(solids + i, j, (at, at, on_core, centre(core))))
        for j, (x2, y2, r2) in enumerate(layout.discs[:i]):
            if math.dist(at, (x2, y2)) < r + r2 + 2 * reach_m:
                links.append(Link(solids + i, solids + j, (at, at, (x2, y2), (x2, y2))))
    return tuple(links)
