"""What planners ask about motion, with what was found kept by layout, and the questions counted.

The answers are exact for discs and the same whatever was asked before.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from reasoning.motion.connectivity import MARGIN_M, Connectivity
from reasoning.motion.convex import Point
from reasoning.motion.layout import Layout
from reasoning.motion.trajectory import Roadmap, Trajectory

KEPT_LAYOUTS = 2048
"""How many layouts are kept; those that were asked about longest ago go first."""

Key = tuple[Layout, float]
Made = TypeVar("Made")


@dataclass
class Counts:
    """Questions so far, and the layouts that had to be built for them."""

    queries: int = 0
    trajectories: int = 0
    layouts: int = 0


class Oracle:
    """Answers about discs that keep `margin_m` off everything."""

    def __init__(self, margin_m: float = MARGIN_M) -> None:
        self.margin_m = margin_m
        self.counts = Counts()
        self._connectivity: OrderedDict[Key, Connectivity] = OrderedDict()
        self._roadmaps: OrderedDict[Key, Roadmap] = OrderedDict()

    def connectivity(self, layout: Layout, radius_m: float) -> Connectivity:
        """The connectivity of a layout, built at most once as long as it is kept."""

        def build() -> Connectivity:
            self.counts.layouts += 1
            return Connectivity(layout, radius_m, self.margin_m)

        return _kept(self._connectivity, (layout, radius_m), build)

    def free(self, layout: Layout, radius_m: float, p: Point) -> bool:
        """Whether the disc can be at p."""
        self.counts.queries += 1
        return self.connectivity(layout, radius_m).free(p)

    def path_exists(self, layout: Layout, radius_m: float, p: Point, q: Point) -> bool:
        """Whether the disc gets from p to q."""
        self.counts.queries += 1
        return self.connectivity(layout, radius_m).path_exists(p, q)

    def blockers(self, layout: Layout, radius_m: float, p: Point, q: Point) -> frozenset[int] | None:
        """None if there is a path, otherwise a smallest set of discs that leaves none (empty: the furniture)."""
        self.counts.queries += 1
        return self.connectivity(layout, radius_m).blockers(p, q)

    def shortest(self, layout: Layout, radius_m: float, p: Point, q: Point) -> Trajectory | None:
        """A shortest trajectory; None if there is no path."""
        self.counts.trajectories += 1
        roadmap = _kept(self._roadmaps, (layout, radius_m), lambda: Roadmap(self.connectivity(layout, radius_m)))
        return roadmap.shortest(p, q)

    def time_estimate(self, layout: Layout, radius_m: float, p: Point, q: Point, speed: float) -> int | None:
        """Time units for the shortest trajectory, rounded up and at least 1, at `speed` metres per unit; None if
        there is no path."""
        trajectory = self.shortest(layout, radius_m, p, q)
        return None if trajectory is None else max(1, math.ceil(trajectory.length_m / speed - 1e-6))


def _kept(store: OrderedDict[Key, Made], key: Key, build: Callable[[], Made]) -> Made:
    found = store.get(key)
    if found is None:
        found = store[key] = build()
        if len(store) > KEPT_LAYOUTS:
            store.popitem(last=False)
    else:
        store.move_to_end(key)
    return found
