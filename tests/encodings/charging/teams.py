"""Small teams of the charging factory, told or drawn at random."""

from __future__ import annotations

import random
from collections.abc import Sequence

from reasoning.values import Problem, Value

DOMAIN = "charging"
CAPACITY, RATE = 12, 4
Cell = tuple[int, int]


def team(
    workers: Sequence[tuple[Cell, int, int]],
    boxes: int | Sequence[tuple[int, int, int]] = 1,
    *,
    charger: Cell | None = (1, 1),
    docked: str = "none",
    size: Cell = (3, 2),
    guest: str = "",
    broken: Sequence[str] = (),
) -> Problem:
    """Workers are (cell, effector, battery); boxes so many new ones, or (line position, stage, wet) each."""
    state: dict[str, Value] = {}
    for i, ((x, y), effector, battery) in enumerate(workers, 1):
        state |= {f"at(w{i})": f"({x},{y})", f"effector(w{i})": effector, f"battery(w{i})": battery}
    if charger is not None:
        state |= {"at(c1)": f"({charger[0]},{charger[1]})", "docked(c1)": docked}
    if isinstance(boxes, int):
        boxes = [(size[0] + i, 0, 0) for i in range(1, boxes + 1)]
    for i, (place, stage, wet) in enumerate(boxes, 1):
        state |= {f"line({i})": place, f"stage({i})": stage, f"wet({i})": wet}
    state |= {f"broken({robot})": 1 for robot in broken}
    static = {"width": size[0], "height": size[1], "line": size[0], "delay": 2, "capacity": CAPACITY, "rate": RATE}
    return Problem(DOMAIN, static, state, guest)


def drawn(seed: int) -> Problem:
    """Some state that a very small team may be in, mid-plan as a rule, low on power."""
    rng = random.Random(seed)
    several = rng.random() < 0.6  # a second worker, or one to be borrowed, on a floor of one row: searches are plain
    cells = [(x, y) for x in (1, 2) for y in ((1,) if several else (1, 2))]
    places = rng.sample(cells, 2 if several and rng.random() < 0.5 else 1)
    workers = [(place, rng.randint(1, 3), rng.choice((0, 1, 2, 3, 5, 12))) for place in places]
    charger, docked = rng.choice(cells), "none"
    if rng.random() < 0.3:
        charger, docked = places[0], "w1"
    stage = rng.choice((0, 1, 2, 2, 2))
    box = rng.choice((2, 2, 3)), stage, int(stage == 1 and rng.random() < 0.5)
    size, guest = (2, 1 if several else 2), "w2" if several and len(places) == 1 else ""
    return team(workers, [box], charger=charger, docked=docked, size=size, guest=guest)
