"""Robots that drive along ways over the floor of a room, alone or two with one thing, and stop before what is ahead.

A robot is pulled along its way by a bounded force. It looks ahead for as far as it needs to stop; before what may go by
itself, people and robots that drive, it waits for a while. Of two robots whose ways cross, the one that set out later
lets the other pass. Who does not get on although nothing is in sight is held up.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, ceil, dist, hypot, sqrt
from typing import Literal

import msgspec

from world import lookout
from world.lookout import Disc
from world.physics import Point
from world.things import Thing
from world.truth import Truth
from world.ways import Way

ACCEL_MPS2 = 5.0
SPARE = 0.8
"""The share of what its force allows that a robot drives with: the rest keeps it on its way."""
EARLY_S = 0.15
"""So much before its time is over a robot is there."""
LAG_M = 0.05
"""Who is so far from where it is to be by now is held up."""
SETTLING_S = 0.5
"""So long one tries to get the last bit of the way."""
CRAWL_MPS = 0.1
SETTLED_M = 0.005
"""Who is that near to where it was to go has got there: a mechanical stop does the rest."""
CLAIM_M, CLAIMED_M = 1.0, 0.1
"""So much of a way that is driven, in such pieces, is kept free by those who set out later."""
NEARBY_M = 2.0
"""Who is farther away than so much, besides, need not think of that."""
CORRECTION_HZ = 10.0

Outcome = Literal["", "there", "blocked", "too_heavy", "stopped"]


class Trip(msgspec.Struct):
    """A drive of one robot, or of two with one thing, as it is saved: ways in metres on the world's floor, the `ticks`
    it is given, the `seconds` it is to take, `driven_s` of them it has driven, at `rate` of its speed, and `waited`
    ticks. `load` is what two carry. What lies `under` the robots at the start is not in the way, nor what lies in the
    last cell, if they hold nothing."""

    team: str
    robots: list[str]
    ways: list[list[Point]]
    ticks: int
    accel_mps2: float
    seconds: float
    driven_s: float = 0.0
    rate: float = 0.0
    waited: int = 0
    load: str = ""
    under: list[str] = []
    outcome: Outcome = ""


class Driver:
    """All trips that are under way, in the order in which they began. `walking`: persons that walk now."""

    def __init__(self, truth: Truth) -> None:
        self._truth, self._floor, self._dt_s = truth, truth.floor, truth.scene.dt_s
        self.trips: list[Trip] = []
        self._ways: dict[int, Way] = {}
        self.walking: set[str] = set()
        rooms = [space for space in truth.scene.workspaces if space.room]
        self._walls = {space.team: [*truth.layout.walls(space)] for space in rooms}

    def set_out(self, robots: list[Thing], ways: list[list[Point]], ticks: int) -> Trip:
        """From now on, robots of one team, within so many ticks. Raises ValueError for ways that cannot be driven."""
        truth, team = self._truth, robots[0].place
        held = {robot.partner for robot in robots if robot.end}
        pull_n = sum(truth.force_n(robot) for robot in robots) - sum(truth.force_n(truth.things[h]) for h in held)
        mass_kg = sum(self._floor.mass_kg(name) for name in (*held, *(robot.id for robot in robots)))
        accel = min(ACCEL_MPS2, SPARE * pull_n / mass_kg) if pull_n > 0 else ACCEL_MPS2
        way = Way(ways, accel)
        seconds = max(ticks * self._dt_s - EARLY_S, way.seconds)
        trip = Trip(team, [robot.id for robot in robots], ways, ticks, accel, seconds)
        trip.load = robots[0].partner if len(robots) == 2 else ""
        robot_m = truth.kind(robots[0]).radius_m
        for thing in truth.of(team):
            lying = truth.kind(thing).role == "object" and thing.id not in held
            for disc in lookout.discs(truth, thing) if lying else ():
                if any(dist(disc.at, start) < disc.radius_m + robot_m for start in way.places[0]):
                    trip.under.append(thing.id)
        self.trips.append(trip)
        self._ways[id(trip)] = way
        self._ease(trip, True)
        return trip

    def take_up(self, trips: list[Trip]) -> None:
        """Go on with trips that were under way when the world was saved."""
        self.trips = trips
        self._ways = {id(trip): Way(trip.ways, trip.accel_mps2) for trip in trips}
        for trip in trips:
            self._ease(trip, not trip.outcome)

    def end(self, trip: Trip) -> None:
        """It is over: who got there, and is still there, stands exactly where it was to go, with what it holds."""
        places, robots = self._ways[id(trip)].places[-1], [self._truth.things[name] for name in trip.robots]
        if trip.outcome == "there" and self._lag_m(robots, places) < 2 * SETTLED_M:
            for robot, at in zip(robots, places, strict=True):
                self._floor.put(robot.id, at)
                thing = self._truth.things.get(robot.partner)
                if thing is not None and not thing.heavy:
                    self._floor.put(thing.id, at)
            if trip.load and robots[0].partner == robots[1].partner == trip.load:
                (x_m, y_m), (east_m, north_m) = places
                self._floor.put(trip.load, places[0], atan2(north_m - y_m, east_m - x_m))
        self.trips.remove(trip)
        del self._ways[id(trip)]

    # ------------------------------------------------------------ every tick
    def control(self) -> None:
        """Command all drives for the coming tick."""
        for trip in self.trips:
            if not trip.outcome:
                self._control(trip)

    def _control(self, trip: Trip) -> None:
        way, robots = self._ways[id(trip)], [self._truth.things[name] for name in trip.robots]
        if any(robot.broken or robot.place != trip.team for robot in robots):
            return self._halt(trip, "stopped")
        if self._lag_m(robots, way.at(self._driven(trip))) > LAG_M:
            held = [self._truth.things[robot.partner] for robot in robots if robot.end]
            for thing in held:
                thing.known = True
            return self._halt(trip, "too_heavy" if any(thing.heavy for thing in held) else "blocked")
        if trip.driven_s >= trip.seconds:
            trip.waited += 1
            if self._lag_m(robots, way.places[-1]) < SETTLED_M:
                return self._halt(trip, "there")
            if trip.waited * self._dt_s > SETTLING_S:
                return self._halt(trip, "blocked")
        before = way.at(self._driven(trip))
        if trip.driven_s < trip.seconds:
            speed_mps = (self._driven(trip, self._dt_s) - self._driven(trip)) / self._dt_s
            clear, other = self._look(trip, speed_mps * trip.rate)
            change = trip.accel_mps2 * self._dt_s / max(speed_mps, CRAWL_MPS)
            trip.rate = min(trip.rate + change, 1.0) if clear else max(trip.rate - change, 0.0)
            if clear or trip.rate > 0.0:
                trip.waited = 0
            elif other is None or not other.patient or trip.waited >= self._truth.period:
                if other is not None:
                    other.thing.known = True
                return self._halt(trip, "blocked")
            else:
                trip.waited += 1
            trip.driven_s = min(trip.driven_s + trip.rate * self._dt_s, trip.seconds)
        for name, here, there in zip(trip.robots, before, way.at(self._driven(trip)), strict=True):
            self._command(name, here, there)
        return None

    def _command(self, name: str, here: Point, there: Point) -> None:
        """Go as the way goes from here to there within the tick, and make up for what is lacking to be here."""
        x_m, y_m = self._floor.where(name)
        dx_m, dy_m = here[0] - x_m, here[1] - y_m
        lack_m = hypot(dx_m, dy_m)
        gain = min(CORRECTION_HZ, sqrt(ACCEL_MPS2 / lack_m)) if lack_m else 0.0
        velocity = (there[0] - here[0]) / self._dt_s + gain * dx_m, (there[1] - here[1]) / self._dt_s + gain * dy_m
        self._floor.drive(name, velocity, self._truth.force_n(self._truth.things[name]))

    def _halt(self, trip: Trip, outcome: Outcome) -> None:
        trip.outcome = outcome
        self._ease(trip, False)
        for name in trip.robots:
            self._floor.halt(name)

    def _ease(self, trip: Trip, carried: bool) -> None:
        """Two carry what they hold together."""
        if trip.load:
            self._floor.ease(trip.load, carried)

    def _driven(self, trip: Trip, more_s: float = 0.0) -> float:
        """How many metres of its way it is to have driven, now or in a little while at full rate."""
        way = self._ways[id(trip)]
        return way.driven((trip.driven_s + more_s) * way.seconds / trip.seconds)

    def _lag_m(self, robots: list[Thing], places: tuple[Point, ...]) -> float:
        return max(dist(self._floor.where(robot.id), at) for robot, at in zip(robots, places, strict=True))

    # ------------------------------------------------------------ what is ahead
    def _look(self, trip: Trip, speed_mps: float) -> tuple[bool, Disc | None]:
        """Whether the way is clear for as far as it takes to stop, and which body is in the way, if it is one."""
        way, metres = self._ways[id(trip)], self._driven(trip)
        stop_m = speed_mps**2 / (2 * trip.accel_mps2)
        robot_m = self._truth.kind(self._truth.things[trip.robots[0]]).radius_m
        held = self._truth.things.get(self._truth.things[trip.robots[0]].partner)
        thing_m = self._truth.kind(held).radius_m if held is not None else 0.0
        ahead = []
        for k in range(1, ceil(lookout.reach_m(stop_m, patient=True) / lookout.SPACING_M) + 1):
            far_m = k * lookout.SPACING_M
            ahead.append((far_m, [*lookout.parts(way.at(metres + far_m), robot_m, thing_m)]))
            if metres + far_m >= way.metres:
                break
        now = [*lookout.parts(way.at(metres), robot_m, thing_m)]
        others = [*self._others(trip, way), *self._claims(trip, now)]
        other = lookout.in_the_way(now, ahead, others, self.walking, stop_m)
        return other is None and not lookout.wall_ahead(now, ahead, self._walls[trip.team], stop_m), other

    def _others(self, trip: Trip, way: Way) -> Iterator[Disc]:
        """All bodies in the room that may be in the way of a trip."""
        truth = self._truth
        held = {truth.things[name].partner for name in trip.robots}
        under_way = {name for other in self.trips if not other.outcome for name in other.robots}
        last = {truth.layout.nearest(trip.team, at) for at in way.places[-1]} if held == {""} else set()
        for thing in truth.of(trip.team):
            role = truth.kind(thing).role
            if role != "object" and thing.id not in trip.robots:
                yield from lookout.discs(truth, thing, patient=role == "person" or thing.id in under_way)
            elif role == "object" and thing.id not in held and thing.id not in trip.under:
                ends = {
                    truth.layout.nearest(trip.team, truth.floor.end(thing.id, 1 + i)) for i in range(1 + thing.heavy)
                }
                if not ends & last:
                    yield from lookout.discs(truth, thing)

    def _claims(self, trip: Trip, now: list[tuple[Point, float]]) -> Iterator[Disc]:
        """What those who set out before are about to drive over; not for who is in the middle of it."""
        for other in self.trips[: self.trips.index(trip)]:
            if other.outcome or other.rate == 0.0 or other.team != trip.team:
                continue
            way, metres = self._ways[id(other)], self._driven(other)
            robot = self._truth.things[other.robots[0]]
            radius_m = self._truth.kind(robot).radius_m
            if dist(now[0][0], way.at(metres)[0]) > CLAIM_M + NEARBY_M:
                continue
            claims = [
                Disc(robot, at, radius_m, patient=True)
                for k in range(round(CLAIM_M / CLAIMED_M))
                for at in way.at(metres + k * CLAIMED_M)
            ]
            if all(dist(at, claim.at) >= r_m + radius_m for claim in claims for at, r_m in now):
                yield from claims
