"""Where things stand: a room, its furniture and what can be moved, in metres.

The room reaches from (0, 0) to (width_m, height_m) and ends at its walls. Furniture is simple polygons, at any angle,
which may be non-convex; what can be moved is discs. Everything is rounded to 1 mm, and polygons are brought to one
form, so that equal layouts are equal keys.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

from reasoning.motion.convex import MILLIMETRE, Point, Polygon, canonical, convex_parts

Disc = tuple[float, float, float]
"""x_m, y_m, radius_m"""
WALL_M = 1.0
"""How thick a wall is drawn, outside the room."""
WALLS = 4
"""How many of a layout's solids are walls."""


@dataclass(frozen=True)
class Layout:
    """Raises ValueError for a room without an area, a disc without a radius, what is no simple polygon, and numbers
    that are not finite. Discs are numbered by their order."""

    width_m: float
    height_m: float
    polygons: tuple[tuple[Point, ...], ...] = ()
    discs: tuple[Disc, ...] = ()

    def __post_init__(self) -> None:
        for name, side in (("width_m", self.width_m), ("height_m", self.height_m)):
            if not (math.isfinite(side) and side >= 0.001):
                raise ValueError(f"{name} of a room must be positive and finite, not {side}")
            object.__setattr__(self, name, round(float(side), MILLIMETRE))
        for disc in self.discs:
            if not all(map(math.isfinite, disc)) or disc[2] < 0.001:
                raise ValueError(f"a disc needs finite coordinates and a positive radius, not {disc}")
        polygons = tuple(canonical(tuple((float(x), float(y)) for x, y in polygon)) for polygon in self.polygons)
        discs = tuple((round(x, MILLIMETRE), round(y, MILLIMETRE), round(r, MILLIMETRE)) for x, y, r in self.discs)
        object.__setattr__(self, "polygons", polygons)
        object.__setattr__(self, "discs", discs)

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.width_m, self.height_m, self.polygons, self.discs))

    @cached_property
    def bare(self) -> Layout:
        """The same room without discs."""
        return replace(self, discs=()) if self.discs else self

    def with_discs(self, discs: Iterable[Disc]) -> Layout:
        """The same room with other discs."""
        return replace(self, discs=tuple(discs))

    @cached_property
    def solids(self) -> tuple[Polygon, ...]:
        """Walls and furniture as convex polygons; the walls come first and stand outside the room."""
        w, h, t = self.width_m, self.height_m, WALL_M
        walls = ((-t, -t, w + t, 0.0), (w, -t, w + t, h + t), (-t, h, w + t, h + t), (-t, -t, 0.0, h + t))
        boxes = tuple(((x, y), (x2, y), (x2, y2), (x, y2)) for x, y, x2, y2 in walls)
        return boxes + tuple(part for polygon in self.polygons for part in convex_parts(polygon))
