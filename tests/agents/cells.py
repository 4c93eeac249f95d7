"""Cells, and ways between them, as the made-up house writes them."""

from __future__ import annotations

import math
from itertools import pairwise

from bus.messages import Value
from reasoning.solver import parse

Cell = tuple[int, int]


def cell(value: Value) -> Cell:
    x, y = parse(str(value))[1]
    return int(x), int(y)


def term(at: Cell) -> str:
    return f"({at[0]},{at[1]})"


def grip(holds: tuple[str, int] | None) -> str:
    return "none" if holds is None else f"grip({holds[0]},{holds[1]})"


def stop_before(
    points: list[tuple[float, float]], at: tuple[float, float], near_m: float
) -> tuple[float, float] | None:
    """Where a robot on this way stops before it comes so near to something at `at`; None if it does not."""
    for (ax, ay), (bx, by) in pairwise(points):
        pieces = max(1, math.ceil(math.hypot(bx - ax, by - ay) / 0.05))
        before = (ax, ay)
        for k in range(1, pieces + 1):
            here = ax + (bx - ax) * k / pieces, ay + (by - ay) * k / pieces
            if math.dist(here, at) < near_m and math.dist(here, at) < math.dist(before, at):
                return before
            before = here
    return None
