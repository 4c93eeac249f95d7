"""Ways over the floor: who is pulled where, from which tick to which.

A leg is driven by two commands: this velocity, and after a while standstill. Both take effect with the same bounded
force, so what is lost while coming to speed is won while coming to rest: the distance is exact whatever the mass.
"""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from math import dist, hypot

from world.physics import Point
from world.things import MOVING, RAMP, Leg, Thing
from world.truth import Truth

TRIM_M = 0.0002
"""Who is that near needs no correction."""
TRIM_FROM, TRIM_TO, TRIM_RAMP, TRIM_WITHIN_M = 0.76, 0.80, 0.05, 0.05
"""A correction at a period's end, in shares of the period, for whom it is worth it."""


class Motion:
    """Commands to drives and belts, by the tick at which they are due."""

    def __init__(self, truth: Truth) -> None:
        self._truth, self._floor = truth, truth.floor
        self._due: dict[int, list[Callable[[], None]]] = {}
        self._ticks: list[int] = []
        self._halts: dict[int, list[str]] = {}
        self._hops: list[tuple[str, Point, float]] = []
        self._moving, self._ramp = round(MOVING * truth.period), round(RAMP * truth.period)

    def next_tick(self) -> int | None:
        return self._ticks[0] if self._ticks else None

    def run(self, tick: int) -> None:
        """Give the commands that are due by `tick`."""
        while self._ticks and self._ticks[0] <= tick:
            for command in self._due.pop(heappop(self._ticks)):
                command()

    def hop(self, thing: Thing, goal: Point, pulled: Thing | None = None) -> None:
        """From a cell to another one within the period that begins now, with `pulled` in tow."""
        start, period = self._truth.tick, self._truth.period
        mass_kg = self._floor.mass_kg(thing.id)
        if pulled is not None:
            mass_kg += self._floor.mass_kg(pulled.id)
            self._floor.release(pulled.id)
        self._go(thing.id, Leg(goal, start, start + self._moving, self._ramp), mass_kg)
        if not self._hops:
            self._at(start + round(TRIM_FROM * period), self._trim)
        self._hops.append((thing.id, goal, mass_kg))

    def _trim(self) -> None:
        """Correct who is a little off."""
        start, period = self._truth.tick, self._truth.period
        stop, ramp = start + round((TRIM_TO - TRIM_FROM) * period), round(TRIM_RAMP * period)
        for name, goal, mass_kg in self._hops:
            if dist(self._floor.where(name), goal) < TRIM_WITHIN_M:
                self._go(name, Leg(goal, start, stop, ramp), mass_kg)
        self._hops.clear()

    def travel(self, thing: Thing) -> None:
        """Along its route, from now on, or on from where it was when the world was saved."""
        mass_kg = self._floor.mass_kg(thing.id)
        for leg in thing.route:
            if leg.stop > self._truth.tick:
                self._at(max(leg.start, self._truth.tick), lambda leg=leg: self._go(thing.id, leg, mass_kg))  # type: ignore[misc]

    def convey(self, belt: str) -> None:
        """A line one position down within the period that begins now."""
        self._floor.run_belt(belt, (-1.0 / (self._moving * self._truth.scene.dt_s), 0.0))
        self._at(self._truth.tick + self._moving, lambda: self._floor.run_belt(belt, (0.0, 0.0)))

    def _go(self, name: str, leg: Leg, mass_kg: float) -> None:
        """One leg, from where the body is now to the leg's end, in the time that is left."""
        x_m, y_m = self._floor.where(name)
        dx_m, dy_m = leg.to[0] - x_m, leg.to[1] - y_m
        distance_m = hypot(dx_m, dy_m)
        if distance_m < TRIM_M:
            return
        dt_s = self._truth.scene.dt_s
        moving_s = (leg.stop - self._truth.tick) * dt_s
        force_n = mass_kg * distance_m / moving_s / (leg.ramp * dt_s)
        self._floor.drive(name, (dx_m / moving_s, dy_m / moving_s), force_n)
        if leg.stop not in self._halts:
            self._halts[leg.stop] = []
            self._at(leg.stop, self._halt)
        self._halts[leg.stop].append(name)

    def _halt(self) -> None:
        for name in self._halts.pop(self._truth.tick):
            self._floor.halt(name)

    def _at(self, tick: int, command: Callable[[], None]) -> None:
        if tick not in self._due:
            self._due[tick] = []
            heappush(self._ticks, tick)
        self._due[tick].append(command)


def route(start: Point, corners: list[Point], first: int, last: int) -> list[Leg]:
    """Legs from `start` over all corners, at rest at each, beginning at tick `first` and over at tick `last`."""
    points = [start, *corners]
    lengths = [hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(points, corners, strict=False)]
    # A short piece gets its share of time too: coming to speed takes what it takes.
    shares = [length + sum(lengths) / len(lengths) for length in lengths]
    legs, tick = [], float(first)
    for corner, share in zip(corners, shares, strict=True):
        ticks = (last - first) * share / sum(shares)
        ramp = max(round(ticks * RAMP), 1)
        legs.append(Leg(corner, round(tick), round(tick + ticks) - ramp - 1, ramp))
        tick += ticks
    return legs
