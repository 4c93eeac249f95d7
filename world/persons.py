"""People in rooms: they walk as the scene says, straight from stop to stop, and nothing moves them.

They stop for whatever is in front of them, and go on when it is gone. Who is late for a stop goes there all the same,
and then to the next.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import dist

from bus.scene import Entity
from world import lookout, plane
from world.physics import Point
from world.things import Thing
from world.truth import Truth

WALK_MPS = 1.0
FRONT_M = 0.3
"""So far ahead people look."""
POLITE_M = 0.1
"""So far they keep from others."""


class Persons:
    """All persons of the scene; `walking` are those who are on their feet now."""

    def __init__(self, truth: Truth) -> None:
        self._truth = truth
        self._walks = {e.id: e for e in truth.scene.entities if e.stops}
        self.walking: set[str] = set()

    def next_tick(self) -> int | None:
        """When somebody moves next."""
        ticks = [self._due(walk) for walk in self._walks.values()]
        return min((max(tick, self._truth.tick + 1) for tick in ticks if tick is not None), default=None)

    def control(self) -> None:
        """Let everybody walk or stand for the coming tick."""
        floor, dt_s = self._truth.floor, self._truth.scene.dt_s
        self.walking.clear()
        for name, walk in self._walks.items():
            person, due = self._truth.things[name], self._due(walk)
            if due is None or due > self._truth.tick:
                floor.speed_up(name, (0.0, 0.0))
                continue
            here, goal = floor.where(name), self._goal(walk)
            far_m = dist(here, goal)
            if far_m <= WALK_MPS * dt_s:
                floor.put(name, goal)
                person.walked += 1
            elif self._clear(person, here, goal):
                self.walking.add(name)
                floor.speed_up(name, ((goal[0] - here[0]) * WALK_MPS / far_m, (goal[1] - here[1]) * WALK_MPS / far_m))
            else:
                floor.speed_up(name, (0.0, 0.0))

    def _due(self, walk: Entity) -> int | None:
        """The tick at which a person sets out to its next stop, or has set out."""
        rounds, number = divmod(self._truth.things[walk.id].walked, len(walk.stops))
        if rounds and not walk.again_s:
            return None
        return round((walk.stops[number].at_s + rounds * walk.again_s) / self._truth.scene.dt_s)

    def _goal(self, walk: Entity) -> Point:
        stop = walk.stops[self._truth.things[walk.id].walked % len(walk.stops)]
        ox, oy = self._truth.layout.origin(walk.team)
        return ox + stop.x_m, oy + stop.y_m

    def _clear(self, person: Thing, here: Point, goal: Point) -> bool:
        """Nobody and nothing is in front."""
        radius_m = self._truth.kind(person).radius_m
        share = min(FRONT_M / dist(here, goal), 1.0)
        ahead = [lookout.between(here, goal, share * part) for part in (0.1, 0.5, 1.0)]
        for other in self._truth.of(person.place):
            for disc in lookout.discs(self._truth, other) if other is not person else ():
                near_m = radius_m + disc.radius_m + POLITE_M
                if any(dist(at, disc.at) < min(near_m, dist(here, disc.at)) for at in ahead):
                    return False
        return all(
            plane.off(at, solid) >= min(radius_m, plane.off(here, solid))
            for solid in self._solids(person)
            for at in ahead
        )

    def _solids(self, person: Thing) -> Iterator[list[Point]]:
        ox, oy = self._truth.layout.origin(person.place)
        for solid in self._truth.layout.spaces[person.place].solids:
            yield [(ox + x, oy + y) for x, y in solid.corners]
