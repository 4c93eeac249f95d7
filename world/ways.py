"""Ways over the floor of a room and how fast they can be driven: by one robot, or by two that carry one thing.

A way is points, and straight between them. Speeds are such that a bounded acceleration suffices on the straight, and
that the corners are cut by no more than `CUT_M`. Whoever has more time drives the same way more slowly.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from itertools import accumulate, pairwise
from math import atan2, cos, dist, hypot, inf, pi, sin, sqrt

from bus.messages import Value
from world.physics import Point

FASTEST_MPS = 2.0
CUT_M = 0.001
APART_M = 0.01
"""Two robots that carry one thing are a metre apart; their ways may be off by so much."""
_POINT = re.compile(r"\((-?\d{1,6}),(-?\d{1,6})\)")


def read(written: Value | None) -> list[Point]:
    """The points of ``((x,y),...)`` in millimetres; none for what is no way."""
    text = str(written)
    if not re.fullmatch(rf"\({_POINT.pattern}(,{_POINT.pattern})*,?\)", text):
        return []
    return [(int(x) / 1000, int(y) / 1000) for x, y in _POINT.findall(text)]


class Way:
    """The way of one robot, or of two, whose points belong together. `accel_mps2` is what they can. Raises ValueError
    for ways that do not fit together."""

    def __init__(self, ways: list[list[Point]], accel_mps2: float) -> None:
        if len({len(points) for points in ways}) != 1 or not ways[0]:
            raise ValueError("the ways differ in their number of points")
        if any(abs(dist(*pair) - 1.0) > APART_M for pair in zip(*ways, strict=True) if len(pair) == 2):
            raise ValueError("the ways do not keep a metre apart")
        places = [*zip(*ways, strict=True)]
        kept = places[:1] + [b for a, b in pairwise(places) if _far(a, b) > 0.0]
        self.places: list[tuple[Point, ...]] = kept
        lengths = [_far(a, b) for a, b in pairwise(kept)]
        self._metres = [0.0, *accumulate(lengths)]
        speeds = self._speeds(lengths, accel_mps2)
        self._legs = [_Leg(length, *ends, accel_mps2) for length, ends in zip(lengths, pairwise(speeds), strict=True)]
        self._seconds = [0.0, *accumulate(leg.seconds for leg in self._legs)]

    @property
    def seconds(self) -> float:
        """How long it takes at least."""
        return self._seconds[-1]

    @property
    def metres(self) -> float:
        return self._metres[-1]

    def driven(self, seconds: float) -> float:
        """How many metres of the way are driven after so many seconds."""
        if seconds >= self._seconds[-1]:
            return self._metres[-1]
        number = bisect_right(self._seconds, seconds) - 1
        return self._metres[number] + self._legs[number].driven(seconds - self._seconds[number])

    def at(self, metres: float) -> tuple[Point, ...]:
        """Where the robots are there."""
        if metres >= self._metres[-1]:
            return self.places[-1]
        number = bisect_right(self._metres, metres) - 1
        here, there = self.places[number], self.places[number + 1]
        share = (metres - self._metres[number]) / (self._metres[number + 1] - self._metres[number])
        if len(here) == 1:
            return (_between(here[0], there[0], share),)
        # What they carry is rigid: it turns about its middle while that moves straight.
        (x_m, y_m), angle = _between(_middle(here), _middle(there), share), _angle(here)
        angle += share * ((_angle(there) - angle + pi) % (2 * pi) - pi)
        dx_m, dy_m = cos(angle) / 2, sin(angle) / 2
        return (x_m - dx_m, y_m - dy_m), (x_m + dx_m, y_m + dy_m)

    def _speeds(self, lengths: list[float], accel: float) -> list[float]:
        """At each point, at most: for the corner there, and for what can be braked and gained between."""
        speeds = [0.0] * len(self.places)
        for i in range(1, len(self.places) - 1):
            turn = max(_turn(a, b, c) for a, b, c in zip(*self.places[i - 1 : i + 2], strict=True))
            change = sqrt(8 * accel * CUT_M)
            speeds[i] = min(FASTEST_MPS, change / (2 * sin(turn / 2)) if turn else inf)
        for i, length in enumerate(lengths):
            speeds[i + 1] = min(speeds[i + 1], sqrt(speeds[i] ** 2 + 2 * accel * length))
        for i, length in reversed([*enumerate(lengths)]):
            speeds[i] = min(speeds[i], sqrt(speeds[i + 1] ** 2 + 2 * accel * length))
        return speeds


class _Leg:
    """A straight piece: faster, steadily, slower."""

    def __init__(self, length: float, first: float, last: float, accel: float) -> None:
        top = min(FASTEST_MPS, sqrt(accel * length + (first**2 + last**2) / 2))
        self.first, self.accel, self.top, self.length = first, accel, top, length
        self.rising, falling = (top - first) / accel, (top - last) / accel
        steady = max(length - (top**2 - first**2 + top**2 - last**2) / (2 * accel), 0.0)
        self.until = self.rising + steady / top
        self.seconds = self.until + falling

    def driven(self, seconds: float) -> float:
        risen = min(seconds, self.rising)
        metres = self.first * risen + self.accel * risen**2 / 2
        metres += self.top * min(max(seconds - self.rising, 0.0), self.until - self.rising)
        falling = max(seconds - self.until, 0.0)
        return min(metres + self.top * falling - self.accel * falling**2 / 2, self.length)


def _far(a: tuple[Point, ...], b: tuple[Point, ...]) -> float:
    """How far it is for who has furthest."""
    return max(map(dist, a, b))


def _between(a: Point, b: Point, share: float) -> Point:
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def _middle(pair: tuple[Point, ...]) -> Point:
    return (pair[0][0] + pair[1][0]) / 2, (pair[0][1] + pair[1][1]) / 2


def _angle(pair: tuple[Point, ...]) -> float:
    return atan2(pair[1][1] - pair[0][1], pair[1][0] - pair[0][0])


def _turn(a: Point, b: Point, c: Point) -> float:
    """By how much a way turns at b, 0 to pi."""
    one, other = (b[0] - a[0], b[1] - a[1]), (c[0] - b[0], c[1] - b[1])
    if hypot(*one) == 0.0 or hypot(*other) == 0.0:
        return 0.0
    return abs((atan2(other[1], other[0]) - atan2(one[1], one[0]) + pi) % (2 * pi) - pi)
