"""Small teams of the painting factory for the planner's tests, told or drawn at random."""

from __future__ import annotations

import random
from collections.abc import Sequence

from reasoning.values import Problem, Value

DOMAIN = "factory"
Cell = tuple[int, int]


def team(
    workers: Sequence[tuple[Cell, int]],
    boxes: int | Sequence[tuple[int, int, int]] = 1,
    *,
    carrier: Cell | None = (1, 1),
    tied: str = "none",
    size: Cell = (5, 3),
    guest: str = "",
    broken: Sequence[str] = (),
) -> Problem:
    """Workers are (cell, effector); boxes so many new ones, or (line position, stage, wet) each."""
    state: dict[str, Value] = {}
    for i, ((x, y), effector) in enumerate(workers, 1):
        state |= {f"at(w{i})": f"({x},{y})", f"effector(w{i})": effector}
    if carrier is not None:
        state |= {"at(c1)": f"({carrier[0]},{carrier[1]})", "attached(c1)": tied}
    if isinstance(boxes, int):
        boxes = [(size[0] + i, 0, 0) for i in range(1, boxes + 1)]
    for i, (place, stage, wet) in enumerate(boxes, 1):
        state |= {f"line({i})": place, f"stage({i})": stage, f"wet({i})": wet}
    state |= {f"broken({robot})": 1 for robot in broken}
    return Problem(DOMAIN, {"width": size[0], "height": size[1], "line": size[0], "delay": 2}, state, guest)


def drawn(
    seed: int,
    *,
    widths: Sequence[int] = (2, 3),
    heights: Sequence[int] = (2,),
    most_workers: int = 2,
    most_boxes: int = 2,
    breaks: float = 0.0,
) -> Problem:
    """Some state that a team may be in, mid-plan as a rule."""
    rng = random.Random(seed)
    size = rng.choice(widths), rng.choice(heights)
    cells = [(x, y) for x in range(1, size[0] + 1) for y in range(1, size[1] + 1)]
    places = rng.sample(cells, rng.randint(1, most_workers))
    workers = [(place, rng.randint(1, 3)) for place in places]
    carrier, tied = rng.choice(cells), "none"
    if rng.random() < 0.25:
        i = rng.randrange(len(places))
        carrier, tied = places[i], f"w{i + 1}"
    first, boxes = rng.randint(1, size[0] + 1), []
    for place in range(first, first + rng.randint(1, most_boxes)):
        stage = rng.randint(0, 3) if place > 1 else 3
        boxes.append(
            (place if rng.random() < 0.9 else max(place - 1, 2), stage, int(stage == 1 and rng.random() < 0.5))
        )
    robots = ["c1", *(f"w{i}" for i in range(1, len(places) + 1))]
    guest = f"w{len(places) + 1}" if rng.random() < 0.7 else ""
    broken = [rng.choice(robots)] if rng.random() < breaks else []
    return team(workers, boxes, carrier=carrier, tied=tied, size=size, guest=guest, broken=broken)
