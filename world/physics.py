"""The floor: bodies, drives, belts and joints in one rigid-body space. The only module that imports pymunk.

All is seen from above. A robot is driven by a velocity that a bounded force pulls it to; at rest the same force, only
stronger, is its brake. An object rides a belt by friction. Bodies are discs that do not turn, but for heavy things in
rooms: two discs a metre apart. In rooms robots run into solids, persons and one another, and drive over things.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, sin
from typing import Literal, NamedTuple

import pymunk
from pymunk import batch

Point = tuple[float, float]

BRAKE = 5.0
"""A brake is so many times stronger than what pulls at it: who is run into stays where it is."""
ROLLING_N = 5.0
"""What is left of a drive's resistance when its body is pulled along by another."""
NOTHING = pymunk.ShapeFilter(mask=0)
SOLID, ROBOT, THING, PERSON = 1 << 28, 1 << 29, 1 << 30, 1 << 31
IN_ROOMS = {
    "robot": pymunk.ShapeFilter(categories=ROBOT, mask=SOLID | ROBOT | PERSON),
    "object": pymunk.ShapeFilter(categories=THING, mask=SOLID),
    "person": pymunk.ShapeFilter(categories=PERSON, mask=ROBOT),
}
WALLS, WALL_M = "", 0.001
TURNING_M, CARRIED_M = 1.0, 0.05
"""How hard a heavy thing is to turn: friction at so many metres; less while it is carried at both ends."""


class _Body(NamedTuple):
    body: pymunk.Body
    shape: pymunk.Shape
    drive: pymunk.PivotJoint | None
    control: pymunk.Body
    solid: pymunk.ShapeFilter
    mass_kg: float
    brake_n: float


class Floor:
    """Bodies by name. Positions in metres, velocities in m/s, forces in N; all calls are cheap but `step`."""

    def __init__(self, dt_s: float, firm_mps2: float) -> None:
        """`dt_s`: length of a physics step. `firm_mps2`: the deceleration that brakes and belts are made for."""
        self._space = pymunk.Space()
        self._dt_s, self._firm = dt_s, firm_mps2
        self._bodies: dict[str, _Body] = {}
        self._belts: dict[str, pymunk.Body] = {}
        self._couplings: dict[tuple[str, str], pymunk.PivotJoint] = {}
        self._turning: dict[str, pymunk.GearJoint] = {}
        # Positions are read from the space all at once: one call for a hundred bodies costs what ten single ones do.
        self._buffer = batch.Buffer()
        self._order: list[str] = []
        self._at: dict[str, Point] = {}
        self._stale = True

    # ------------------------------------------------------------ bodies
    def add(self, name: str, at: Point, *, radius_m: float, mass_kg: float, layer: int, belt: str = "") -> None:
        """A body at rest, with a drive of its own or riding a belt. Bodies of the same layer collide."""
        body = pymunk.Body(mass_kg, float("inf"))
        body.position = at
        solid = pymunk.ShapeFilter(categories=1 << layer, mask=1 << layer)
        shape = pymunk.Circle(body, radius_m)
        shape.filter = solid
        control = self._belt(belt) if belt else pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        brake_n = mass_kg * self._firm * (1.0 if belt else BRAKE)
        drive = pymunk.PivotJoint(control, body, (0, 0), (0, 0))
        drive.max_bias, drive.max_force = 0.0, brake_n
        self._bodies[name] = _Body(body, shape, drive, control, solid, mass_kg, brake_n)
        self.lower(name)

    def stand(
        self, name: str, at: Point, *, role: Literal["robot", "object", "person"], radius_m: float, mass_kg: float,
        force_n: float, heading_rad: float | None = None,
    ) -> None:  # fmt: skip
        """A body at rest in a room, held by friction or brakes of `force_n`. With a heading it has a second end, a
        metre away in that direction."""
        heavy = heading_rad is not None
        body = pymunk.Body(mass_kg, mass_kg / 4 if heavy else float("inf"))
        if role == "person":
            body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        middle = (0.5, 0.0) if heavy else (0.0, 0.0)
        body.center_of_gravity = middle  # first: what comes next is about it
        body.angle = heading_rad or 0.0
        body.position = at
        control = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        drive = pymunk.PivotJoint(control, body, middle, middle) if role != "person" else None
        if drive is not None:
            drive.max_bias, drive.max_force = 0.0, force_n
        if heavy:
            turning = pymunk.GearJoint(control, body, 0.0, 1.0)
            turning.max_bias, turning.max_force = 0.0, force_n * TURNING_M
            self._turning[name] = turning
        shape = pymunk.Segment(body, (0, 0), (1, 0), radius_m) if heavy else pymunk.Circle(body, radius_m)
        shape.filter = IN_ROOMS[role]
        self._bodies[name] = _Body(body, shape, drive, control, IN_ROOMS[role], mass_kg, force_n)
        self.lower(name)

    def wall(self, start: Point, end: Point) -> None:
        """What nobody gets through."""
        self._space.collision_slop = WALL_M
        self._space.add(piece := pymunk.Segment(self._space.static_body, start, end, WALL_M))
        piece.filter = pymunk.ShapeFilter(categories=SOLID)

    def lift(self, name: str) -> None:
        """Take a body off the floor: nothing touches or moves it any more, it keeps its place."""
        if (it := self._bodies[name]).body.space is not None:
            self._space.remove(*self._parts(name))
            it.body.velocity = (0.0, 0.0)
            self._at[name] = it.body.position.x, it.body.position.y
            self._order = []
            self._stale = True

    def put(self, name: str, at: Point, heading_rad: float = 0.0) -> None:
        """Put a body elsewhere, at rest, on the floor or lifted as it was before."""
        body = self._bodies[name].body
        if body.space is None:
            self._order = []
        body.angle, body.angular_velocity = heading_rad, 0.0
        body.position = at
        body.velocity = (0.0, 0.0)
        self._at[name] = at

    def lower(self, name: str) -> None:
        """Put a lifted body back on the floor."""
        if self._bodies[name].body.space is None:
            self._space.add(*self._parts(name))
            self._order = []
            self._stale = True

    def heading(self, name: str) -> float:
        return float(self._bodies[name].body.angle)

    def end(self, name: str, number: int) -> Point:
        """Where an end of a body is; the first is where the body is."""
        x_m, y_m = self.where(name)
        angle = self.heading(name)
        return (x_m, y_m) if number == 1 else (x_m + cos(angle), y_m + sin(angle))

    def where(self, name: str) -> Point:
        return (self.positions() if self._stale else self._at)[name]

    def positions(self) -> Mapping[str, Point]:
        """Where all bodies are; good until the next call of anything else."""
        if self._stale:
            self._read()
        return self._at

    def velocity(self, name: str) -> Point:
        velocity = self._bodies[name].body.velocity
        return velocity.x, velocity.y

    def speed_up(self, name: str, velocity: Point) -> None:
        """Give a body a velocity at once: people, and bodies that were on their way when the world was last saved."""
        self._bodies[name].body.velocity = velocity

    def solid(self, name: str, solid: bool) -> None:
        """Whether the body collides with its layer."""
        it = self._bodies[name]
        it.shape.filter = it.solid if solid else NOTHING

    def mass_kg(self, name: str) -> float:
        return self._bodies[name].mass_kg

    # ------------------------------------------------------------ what moves them
    def drive(self, name: str, velocity: Point, force_n: float) -> None:
        """Pull towards this velocity with at most this force, until told otherwise."""
        it = self._bodies[name]
        it.control.velocity = velocity
        self._pull(name, force_n)

    def halt(self, name: str) -> None:
        """Pull towards standing still, with the force of the drive before."""
        self._bodies[name].control.velocity = (0.0, 0.0)

    def brake(self, name: str) -> None:
        """Hold fast what was halted: it resists being pushed."""
        self._pull(name, self._bodies[name].brake_n)

    def release(self, name: str) -> None:
        """Let itself be pulled."""
        self._pull(name, ROLLING_N)

    def ease(self, name: str, carried: bool) -> None:
        """A heavy thing is carried at both ends, or is not any more."""
        self._turning[name].max_force = self._bodies[name].brake_n * (CARRIED_M if carried else TURNING_M)

    def run_belt(self, belt: str, velocity: Point) -> None:
        self._belt(belt).velocity = velocity

    def couple(self, one: str, other: str, end: int = 0) -> None:
        """Join two bodies where they stand, or the middle of the first with that end of the other."""
        a, b = self._bodies[one].body, self._bodies[other].body
        joint = pymunk.PivotJoint(a, b, (0, 0), (end - 1, 0)) if end else pymunk.PivotJoint(a, b, a.position)
        joint.collide_bodies = False
        self._space.add(joint)
        self._couplings[one, other] = joint

    def uncouple(self, one: str, other: str) -> None:
        """Undo `couple` of the same two."""
        key = (one, other) if (one, other) in self._couplings else (other, one)
        self._space.remove(self._couplings.pop(key))

    def coupled(self, one: str, other: str) -> bool:
        return (one, other) in self._couplings or (other, one) in self._couplings

    def step(self, times: int) -> None:
        """Let so many physics steps pass."""
        advance, dt_s = self._space.step, self._dt_s
        self._stale = True
        for _ in range(times):
            advance(dt_s)

    def _pull(self, name: str, force_n: float) -> None:
        if (drive := self._bodies[name].drive) is not None:
            drive.max_force = force_n

    def _parts(self, name: str) -> list[pymunk.Body | pymunk.Shape | pymunk.Constraint]:
        """Everything of a body that the space knows."""
        it = self._bodies[name]
        return [part for part in (it.body, it.shape, it.drive, self._turning.get(name)) if part is not None]

    def standing(self) -> tuple[list[str], list[float]]:
        """All bodies that are not lifted, the same list until one is lifted, lowered or added, or put elsewhere while
        it is lifted; and their positions as x, y, x, y, ..."""
        if not self._order:
            names = {it.body.id: name for name, it in self._bodies.items()} | {self._space.static_body.id: WALLS}
            self._buffer.clear()
            batch.get_space_bodies(self._space, batch.BodyFields.BODY_ID, self._buffer)
            self._order = [names[number] for number in memoryview(self._buffer.int_buf()).cast("P")]
        self._buffer.clear()
        batch.get_space_bodies(self._space, batch.BodyFields.POSITION, self._buffer)
        numbers: list[float] = memoryview(self._buffer.float_buf()).cast("d").tolist()  # type: ignore[assignment]
        return self._order, numbers

    def _read(self) -> None:
        """Take all positions from the space; who is lifted keeps its own."""
        order, numbers = self.standing()
        self._at.update(zip(order, zip(numbers[::2], numbers[1::2], strict=True), strict=True))
        self._stale = False

    def _belt(self, belt: str) -> pymunk.Body:
        if belt not in self._belts:
            self._belts[belt] = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        return self._belts[belt]
