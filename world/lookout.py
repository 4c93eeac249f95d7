"""What a robot in a room sees ahead of it: whether its way is clear for as far as it needs to stop.

Ways are planned so that they just miss what is known: only what would be touched by more than `GRAZE_M` is in the way.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from math import dist
from typing import NamedTuple

from world import plane
from world.physics import Point
from world.things import Thing
from world.truth import Truth

GRAZE_M = 0.001
GAP_M = 0.1
"""So far from what is in its way a robot stops."""
APPROACH_M = 0.15
"""So much farther it looks out for what moves."""
RESPECT_M = 0.25
"""So far robots keep from people who walk, if they can."""
SPACING_M = 0.05
BAR = (0.25, 0.5, 0.75)
"""Where what is between the ends of a heavy thing is looked at, while it is carried."""


class Disc(NamedTuple):
    """What may be in the way; `patient`: it may go by itself, and waiting is worth it."""

    thing: Thing
    at: Point
    radius_m: float
    patient: bool


def discs(truth: Truth, thing: Thing, patient: bool = False) -> list[Disc]:
    """A body as it stands or lies; of a heavy thing that lies, the ends are in the way."""
    ends = (1, 2) if thing.heavy else (1,)
    return [Disc(thing, truth.floor.end(thing.id, end), truth.kind(thing).radius_m, patient) for end in ends]


def between(a: Point, b: Point, share: float) -> Point:
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def parts(places: Sequence[Point], robot_m: float, thing_m: float) -> Iterator[tuple[Point, float]]:
    """One robot, or two and what is between them, at these places."""
    for at in places:
        yield at, robot_m
    if len(places) == 2:
        for share in BAR:
            yield between(places[0], places[1], share), thing_m


def reach_m(stop_m: float, *, patient: bool) -> float:
    """How far to look out for somebody, by what it takes to stop."""
    return stop_m + GAP_M + (stop_m + APPROACH_M if patient else 0.0)


def in_the_way(
    now: Sequence[tuple[Point, float]],
    ahead: Sequence[tuple[float, Sequence[tuple[Point, float]]]],
    others: Iterable[Disc],
    walking: Collection[str],
    stop_m: float,
) -> Disc | None:
    """The first of `others` that would be touched: `ahead` are the places that are so many metres ahead. Whoever is
    near already and does not come nearer is not in the way. More room is left to people who are `walking`."""
    for other in others:
        extra_m = RESPECT_M if other.thing.id in walking else 0.0
        reach = reach_m(stop_m, patient=other.patient)
        # Nobody gets nearer by more than it drives: most are too far away to be looked at twice.
        far_m = [dist(was, other.at) for was, _ in now]
        limits_m = [radius_m + other.radius_m + extra_m - GRAZE_M for _, radius_m in now]
        if all(far - reach > limit for far, limit in zip(far_m, limits_m, strict=True)):
            continue
        for metres, places in ahead:
            if metres > reach:
                break
            for (at, _), far, limit in zip(places, far_m, limits_m, strict=True):
                if dist(at, other.at) < min(limit, far - 1e-6):
                    return other
    return None


def wall_ahead(
    now: Sequence[tuple[Point, float]],
    ahead: Sequence[tuple[float, Sequence[tuple[Point, float]]]],
    walls: Iterable[tuple[Point, Point]],
    stop_m: float,
) -> bool:
    """Would a wall or furniture be touched? As `in_the_way`."""
    reach = reach_m(stop_m, patient=False)
    for a, b in walls:
        for part, (was, radius_m) in enumerate(now):
            far_m = plane.away(was, a, b)
            if far_m - reach <= radius_m:
                limit_m = min(radius_m - GRAZE_M, far_m - 1e-6)
                if any(plane.away(places[part][0], a, b) < limit_m for metres, places in ahead if metres <= reach):
                    return True
    return False
