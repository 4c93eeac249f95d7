"""Bodies and what is known of them: the form in which they are saved.

Whole numbers count physics steps ("ticks") since the beginning of the run.
"""

from __future__ import annotations

from math import atan2

import msgspec

from bus.messages import Value
from world.physics import Point

BENCH = "bench"
GONE = "gone"
MOVING = 0.65
"""The share of a period for which a drive pulls to go from one cell to the next."""
HEAVY_MPS2 = 9.0
"""A heavy thing's friction for each kilogramme."""
RAMP = 0.095
"""The share of a period in which it comes to speed, and to rest again."""
WORD = r"[a-z][A-Za-z0-9_]{0,30}"
"""What bodies may be called, and kinds of things: a small letter, then letters, digits or _."""


def term(cell: Value) -> tuple[int, int]:
    """The cell that is written ``(x,y)``."""
    x, y = str(cell).strip("()").split(",")
    return int(x), int(y)


def heading(cell: tuple[int, int], other: tuple[int, int]) -> float:
    """The direction from a cell to the one beside it, radians."""
    return atan2(other[1] - cell[1], other[0] - cell[0])


class Leg(msgspec.Struct, frozen=True):
    """A straight piece of a way to a point of the floor: pull from tick `start` to tick `stop`, with a force that takes
    `ramp` ticks to come to speed."""

    to: Point
    start: int
    stop: int
    ramp: int


class Given(msgspec.Struct):
    """A robot was given by this team, in a step that ended at this tick; in a house it left for this `room`."""

    team: str
    tick: int
    room: str = ""


class Thing(msgspec.Struct, omit_defaults=True):
    """A body. `place` is its team, ``bench`` or ``gone``; `name` what it is called there. `marks` are attributes that
    fall back to 0 at a tick; `route` is its way along the lane, `given` how it came to be on the bench. `called`: its
    own team calls it home, and nobody else commands it; `waits` is why it does not get on, as it was told last.
    Positions are filled in for saving alone."""

    id: str
    kind: str
    place: str
    name: str
    attributes: dict[str, Value]
    broken: bool = False
    partner: str = ""
    marks: dict[str, int] = {}
    route: list[Leg] = []
    given: Given | None = None
    at: Point = (0.0, 0.0)
    velocity: Point = (0.0, 0.0)
    heavy: bool = False
    known: bool = True
    end: int = 0
    heading_rad: float = 0.0
    walked: int = 0
    called: bool = False
    waits: str = ""
