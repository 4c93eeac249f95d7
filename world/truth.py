"""What is: every body with its properties, whom it belongs to and where it stands.

Whole numbers count physics steps ("ticks") since the beginning of the run.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from bus.messages import Value
from bus.scene import Entity, Kind, Scene
from world.layout import Layout
from world.physics import Floor, Point
from world.things import BENCH, GONE, HEAVY_MPS2, MOVING, RAMP, Thing, heading, term

MOST_BODIES = 2000
"""What teams are shown of more would be too large for a message."""


class Truth:
    """All things of a scene, on their floor. `tick` is now, `step` the highest step executed so far, `fluents` what
    each team is shown besides the bodies."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.layout = Layout(scene)
        self.period = round(scene.period_s / scene.dt_s)
        self.tick = 0
        self.step = -1
        self.fluents: dict[str, dict[str, Value]] = {w.team: dict(w.fluents) for w in scene.workspaces}
        self.things: dict[str, Thing] = {}
        self._named: dict[tuple[str, str], Thing] = {}
        self._of: dict[str, dict[str, Thing]] = {}
        self._marked: dict[str, Thing] = {}
        metre_per_second = 1.0 / (MOVING * scene.period_s)
        self.floor = Floor(scene.dt_s, metre_per_second / (RAMP * scene.period_s))
        for space in scene.workspaces:
            for a, b in self.layout.walls(space) if space.room else ():
                self.floor.wall(a, b)

    def begin(self) -> None:
        """Put everything where the scene says."""
        for entity in self.scene.entities:
            kind = self.scene.kinds[entity.kind]
            place = BENCH if entity.place == BENCH else entity.team
            own = {k: v for k, v in entity.attributes.items() if k in kind.attributes}
            thing = Thing(entity.id, entity.kind, place, entity.name, own, entity.broken, known=entity.known)
            if entity.end:
                thing.heavy, thing.heading_rad = True, heading(term(entity.place), term(entity.end))
            self.enter(thing, self._start(entity, kind))
        for entity in self.scene.entities:
            kind = self.scene.kinds[entity.kind]
            partner = self.find(entity.team, str(entity.attributes.get(kind.couples, "")))
            if partner is not None:
                self.couple(self.things[entity.id], partner)

    def _start(self, entity: Entity, kind: Kind) -> Point:
        if entity.place == BENCH:
            return self.layout.slot(entity.id)
        if kind.track == "line":
            return self.layout.line(entity.team, int(entity.place))
        return self.layout.cell(entity.team, *term(entity.place))

    # ------------------------------------------------------------ who
    def kind(self, thing: Thing) -> Kind:
        return self.scene.kinds[thing.kind]

    def find(self, place: str, name: str) -> Thing | None:
        return self._named.get((place, name))

    def of(self, place: str) -> Collection[Thing]:
        """Everything that belongs to a place, in the order in which it came there."""
        return self._of.get(place, {}).values()

    def places(self) -> Iterator[tuple[str, Collection[Thing]]]:
        """Every place and what belongs to it."""
        return ((place, things.values()) for place, things in self._of.items())

    def enter(self, thing: Thing, at: Point, velocity: Point = (0.0, 0.0)) -> None:
        """A thing comes into the world."""
        kind = self.kind(thing)
        self.things[thing.id] = thing
        self._named[thing.place, thing.name] = thing
        self._of.setdefault(thing.place, {})[thing.id] = thing
        if thing.marks:
            self._marked[thing.id] = thing
        if kind.track == "floor":
            self._stand(thing, at)
            self.floor.speed_up(thing.id, velocity)
            return
        self.floor.add(
            thing.id,
            at,
            radius_m=kind.radius_m,
            mass_kg=kind.mass_kg,
            layer=kind.layer,
            belt=thing.place if kind.track == "line" else "",
        )
        if velocity != (0.0, 0.0):
            self.floor.speed_up(thing.id, velocity)
        if thing.place in (BENCH, GONE) or thing.route:
            self.floor.solid(thing.id, False)
        if thing.place == GONE or kind.track == "line":
            self.floor.lift(thing.id)

    def _stand(self, thing: Thing, at: Point) -> None:
        kind = self.kind(thing)
        self.floor.stand(
            thing.id,
            at,
            role=kind.role,
            radius_m=kind.radius_m,
            mass_kg=kind.heavy_n / HEAVY_MPS2 if thing.heavy else kind.mass_kg,
            force_n=self.force_n(thing),
            heading_rad=thing.heading_rad if thing.heavy else None,
        )
        if thing.place not in self.layout.spaces:
            self.floor.lift(thing.id)

    def belongs(self, thing: Thing, place: str, name: str) -> None:
        """From now on it belongs to `place` and is called `name` there."""
        del self._named[thing.place, thing.name], self._of[thing.place][thing.id]
        thing.place, thing.name = place, name
        self._named[place, name] = self._of.setdefault(place, {})[thing.id] = thing

    def mark(self, thing: Thing, attribute: str, periods: float) -> None:
        """Set an attribute to 1 that falls back to 0 by itself."""
        thing.attributes[attribute] = 1
        thing.marks[attribute] = self.tick + round(periods * self.period)
        self._marked[thing.id] = thing

    def fade(self) -> bool:
        """Let the marks go whose time is over; whether there were any."""
        faded = False
        for thing in list(self._marked.values()):
            for mark in [m for m, until in thing.marks.items() if until <= self.tick]:
                thing.attributes[mark], faded = 0, True
                del thing.marks[mark]
            if not thing.marks:
                del self._marked[thing.id]
        return faded

    def force_n(self, thing: Thing) -> float:
        """What a robot pulls with, or what holds a thing to the floor."""
        kind = self.kind(thing)
        return kind.traction_n if kind.role == "robot" else kind.heavy_n if thing.heavy else kind.friction_n

    def grip(self, robot: Thing, thing: Thing, end: int) -> None:
        robot.partner, robot.end = thing.id, end
        self.floor.couple(robot.id, thing.id, end)

    def ungrip(self, robot: Thing) -> None:
        self.floor.uncouple(robot.id, robot.partner)
        robot.partner, robot.end = "", 0

    def holders(self, thing: Thing) -> list[Thing]:
        """The robots that hold it."""
        return [other for other in self.things.values() if other.end and other.partner == thing.id]

    def couple(self, one: Thing, other: Thing) -> None:
        one.partner, other.partner = other.id, one.id
        self.floor.couple(one.id, other.id)

    def uncouple(self, one: Thing) -> None:
        other = self.things[one.partner]
        self.floor.uncouple(one.id, other.id)
        one.partner = other.partner = ""

    # ------------------------------------------------------------ where
    def local(self, thing: Thing) -> Point:
        """Where its body is, in the coordinates of the place it belongs to."""
        ox, oy = self.layout.origin(thing.place)
        x_m, y_m = self.floor.where(thing.id)
        return x_m - ox, y_m - oy

    def cell(self, thing: Thing) -> tuple[int, int]:
        """The cell whose centre is nearest to its body."""
        return self.layout.nearest(thing.place, self.floor.where(thing.id))

    def line(self, thing: Thing) -> int:
        """The line position nearest to its body."""
        return max(round(self.local(thing)[0]), 0)

    def travels(self, thing: Thing) -> bool:
        """Whether it is still on its way along the lane."""
        return bool(thing.route) and thing.route[-1].stop + thing.route[-1].ramp >= self.tick

    def transport(self, giver: str, taker: str = "") -> int:
        """The steps that a robot takes from team to team; to the bench as many as to the nearest team."""
        usual = self.scene.transport_delay_steps
        others = {(t.giver, t.taker): t.steps for t in self.scene.transports}
        takers = [taker] if taker else [team for team in self.layout.spaces if team != giver]
        return min((others.get((giver, team), usual) for team in takers), default=usual)

    def lie_on_line(self, thing: Thing, position: int) -> None:
        """It lies at this position. While the line stands nothing can move it: it takes no part in physics."""
        self.floor.lift(thing.id)
        self.floor.put(thing.id, self.layout.line(thing.place, position))

    # ------------------------------------------------------------ saved
    def save(self) -> list[Thing]:
        """All things with their positions and velocities, complete."""
        at = self.floor.positions()
        for thing in self.things.values():
            thing.at = at[thing.id]
            room = self.kind(thing).track == "floor"
            thing.velocity = self.floor.velocity(thing.id) if thing.route or room else (0.0, 0.0)
            thing.heading_rad = self.floor.heading(thing.id) if thing.heavy else 0.0
        return list(self.things.values())

    def restore(self, things: list[Thing]) -> None:
        """The same things again, in an empty world."""
        for thing in things:
            self.enter(thing, thing.at, thing.velocity)
        for thing in things:
            partner = self.things.get(thing.partner)
            if partner is not None and thing.end:
                self.floor.couple(thing.id, partner.id, thing.end)
            # Both know of the coupling; one whose kind couples made it.
            elif partner is not None and self.kind(thing).couples and not self.floor.coupled(thing.id, partner.id):
                self.floor.couple(thing.id, partner.id)
