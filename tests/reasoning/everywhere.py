"""Least makespans of all starts at once, alone, lending and borrowing: tables of retrograde analysis.

A row of a table tells from which states the goal is reached within 0, 1, 2 ... steps.
"""

from __future__ import annotations

from collections.abc import Sequence

from tests.reasoning.retrograde import Cell, Floor, Line, Sets, Worker


def united(one: Sets, other: Sets) -> Sets:
    return {line: one.get(line, 0) | other.get(line, 0) for line in (*one, *other)}


def alone(floor: Floor, longest: int) -> list[Sets]:
    """From which states the goal is reached within 0, 1, 2 ... steps, by nobody else."""
    found = [floor.goal()]
    while len(found) <= longest:
        found.append(floor.before(found[-1]))
    return found


def lending(floor: Floor, longest: int, step: int | None = None) -> list[Sets]:
    """From which states within 0, 1, 2 ... steps when a worker is given in `step` or earlier (None: whenever)."""
    less = Floor(floor.width, floor.height, floor.workers - 1, floor.boxes)
    given: list[Sets] = [{}, *(floor.giving(less, sets) for sets in alone(less, longest - 1))]
    if step is None:
        return _growing(floor, given)
    row = given
    for _ in range(step):
        row = [united(now, floor.before(later)) for now, later in zip(given, [{}, *row[:-1]], strict=True)]
    return row


def borrowing(floor: Floor, longest: int, step: int = 0) -> list[Sets]:
    """From which states within 0, 1, 2 ... steps when one worker is taken in `step` or later; for one worker."""
    more = Floor(floor.width, floor.height, floor.workers + 1, floor.boxes)
    row = _growing(floor, [{}, *(floor.taking(more, sets) for sets in alone(more, longest - 1))])
    for _ in range(step):
        row = [{}, *(floor.before(sets) for sets in row[:-1])]
    return row


def _growing(floor: Floor, exchanged: list[Sets]) -> list[Sets]:
    """The exchange may be now or later."""
    row: list[Sets] = []
    for now in exchanged:
        row.append(united(now, floor.before(row[-1])) if row else now)
    return row


def least(row: list[Sets], floor: Floor, workers: Sequence[Worker], carrier: Cell) -> int | None:
    """The least number of steps from a start; None: more than were looked at."""
    start, bit = Line(0, (0,) * floor.boxes), floor.bit(workers, carrier)
    return next((steps for steps, sets in enumerate(row) if sets.get(start, 0) >> bit & 1), None)
