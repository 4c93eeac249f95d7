"""Rooms of the sizes that were published, drawn with a seed, for the benchmark of housekeeping."""

from __future__ import annotations

import random
from typing import Any, NamedTuple

from reasoning.geometry import Room, middle, room
from reasoning.motion.oracle import Oracle
from reasoning.setup import Refused, compile_setup
from reasoning.values import Problem

DOMAIN = "housekeeping"
SIDE = 8
DEPOSIT = [0, 3, 0, 3]
KINDS = ("book", "magazine", "cushion", "toy")
PIECES = 3


class Size(NamedTuple):
    """Robots, things, and the length of a shortest plan."""

    robots: int
    things: int
    steps: int


SIZES = [
    Size(*size)
    for size in [
        (1, 2, 8), (1, 3, 12), (1, 1, 4), (2, 2, 4), (2, 3, 7), (2, 4, 8), (2, 5, 11), (2, 6, 12), (3, 6, 8), (4, 6, 8),
        (5, 6, 4), (5, 6, 7), (6, 8, 7), (4, 7, 8), (4, 8, 8), (5, 7, 7), (5, 8, 8),
    ]
]  # fmt: skip
"""In the order of the publication (Aker 2013)."""


def problem(size: Size, seed: int, level: str) -> Problem | None:
    """A draw, perhaps of another length than is wanted; None if this one has no room for everything."""
    draw = random.Random(f"{size} {seed}")
    furniture = [_piece(draw, number) for number in range(PIECES)]
    known = Room("none", (SIDE, SIDE), tuple((f["name"], _metres(f["corners"])) for f in furniture), 0.25, 0.12)
    oracle = Oracle()
    free = [c for c in known.cells if oracle.free(known.layout, known.robot_m, middle(c))]
    tidy, ahead = placing(size)
    inside = [c for c in free if c[0] <= DEPOSIT[1] and c[1] <= DEPOSIT[3]]
    outside = [c for c in free if c not in inside]
    if len(inside) < size.things + 2 or len(outside) < size.things + size.robots:
        return None
    things = draw.sample(inside, tidy) + draw.sample(outside, size.things - tidy)
    starts = things[tidy : tidy + ahead]
    starts += draw.sample([c for c in free if c not in things], size.robots - ahead)
    team: dict[str, Any] = {
        "room": "living_room",
        "deposit": DEPOSIT,
        "robots": [{"name": f"r{n}", "at": list(c)} for n, c in enumerate(starts, 1)],
        "things": [{"name": f"thing_{n}", "kind": draw.choice(KINDS), "at": list(c)} for n, c in enumerate(things, 1)],
        "furniture": furniture,
    }
    setup = compile_setup(DOMAIN, {"house": {"geometry": level}, "teams": {"T1": team}})
    assert not isinstance(setup, Refused), setup
    return Problem(DOMAIN, setup.static, setup.states["T1"])


def placing(size: Size) -> tuple[int, int]:
    """How many things are in their place at the start, and how many robots stand at one that is not, so that counting
    alone does not forbid the wanted length, and does forbid a shorter one."""
    robots, things, steps = size
    options = [(tidy, ahead) for tidy in range(things) for ahead in range(min(robots, things - tidy) + 1)]
    return next(o for o in options if _needed(robots, things - o[0], o[1]) == steps)


def _needed(robots: int, loads: int, ahead: int) -> int:
    return next(k for k in range(999) if ahead * ((k + 1) // 4) + (robots - ahead) * (k // 4) >= loads)


def _piece(draw: random.Random, number: int) -> dict[str, Any]:
    """A rectangle at any angle, as a piece of furniture in centimetres."""
    x, y = draw.randint(100, 700), draw.randint(100, 700)
    ux, uy = draw.randint(-100, 100), draw.randint(20, 100)
    share = draw.choice([3, 5, 8])
    vx, vy = -uy * share // 10, ux * share // 10
    corners = [[x, y], [x + ux, y + uy], [x + ux + vx, y + uy + vy], [x + vx, y + vy]]
    return {"name": f"piece_{number}", "corners": corners}


def _metres(corners: list[list[int]]) -> tuple[tuple[float, float], ...]:
    return tuple((x / 100, y / 100) for x, y in corners)


def known_room(drawn: Problem) -> Room:
    """The room of a draw."""
    found = room(drawn.domain, drawn.static, drawn.state)
    assert found is not None
    return found
