"""A second planner, by breadth-first search, written from the rules of the charging factory; for very small teams.

No broken robots, one charger. It tries every combination of what everybody might do in a step; the search itself is
that of the painting factory.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

from reasoning.values import Problem
from tests.reasoning import bfs

Cell = tuple[int, int]
Act = tuple[str, int, int]
SIDES = ((-1, 0), (1, 0), (0, 1), (0, -1))


class Worker(NamedTuple):
    cell: Cell
    tool: int
    battery: int


class Where(NamedTuple):
    workers: tuple[Worker | None, ...]  # None: not here
    charger: Cell
    docked: int  # index of the worker, or -1
    shifts: int
    stages: tuple[int, ...]
    wet: frozenset[int]
    exchanged: bool = False


class Team(bfs.Team):
    """`longest` steps are looked at; of a battery, what they could use and no more makes a difference."""

    def __init__(self, problem: Problem, longest: int) -> None:
        state, static = problem.state, problem.static
        self.width, self.height = int(static["width"]), int(static["height"])
        self.most, self.rate, self.longest = int(static["capacity"]), int(static["rate"]), longest
        names = sorted(f[9:-1] for f in state if f.startswith("effector("))
        boxes = sorted(int(f[5:-1]) for f in state if f.startswith("line("))
        self.line = [int(state[f"line({b})"]) for b in boxes]
        self.last = max(self.line, default=0)
        workers = [
            Worker(cell(state[f"at({w})"]), int(state[f"effector({w})"]), self.useful(int(state[f"battery({w})"])))
            for w in names
        ]
        partner = str(state["docked(c1)"])
        docked = names.index(partner) if partner != "none" else -1
        wet = frozenset(i for i, b in enumerate(boxes) if state[f"wet({b})"])
        stages = tuple(int(state[f"stage({b})"]) for b in boxes)
        guest = (None,) if problem.guest else ()
        self.start = Where((*workers, *guest), cell(state["at(c1)"]), docked, 0, stages, wet)

    def useful(self, battery: int) -> int:
        return min(battery, self.longest + 1)

    def makespan(self, kind: str, step: int) -> int | None:
        """See `tests.reasoning.bfs.Team.least`."""
        return self.least(kind, step, self.longest)

    def next(self, s: Where, allowed: str) -> Iterator[Where]:
        choices = [list(self.choices(s, i, allowed)) for i in range(len(s.workers))]
        for acts, own, shift in product(product(*choices), self.charging(s), (False, True)):
            after = self.apply(s, acts, own, shift and s.shifts < self.last)
            if after is not None:
                yield after

    def choices(self, s: Where, i: int, allowed: str) -> Iterator[Act]:
        yield "idle", 0, 0
        worker = s.workers[i]
        if worker is None:
            if allowed == "take" and not s.exchanged:
                yield from (("take", y, tool) for y in range(1, self.height + 1) for tool in (1, 2, 3))
            return
        (x, y), tool, battery = worker
        if battery < 2:
            return
        if s.docked != i:
            yield from (("move", *side) for side in SIDES if self.inside(x + side[0], y + side[1]))
            if x == 1 and allowed == "give" and not s.exchanged:
                yield "give", 0, 0
        if x == 1:
            yield from (("swap", e, 0) for e in (1, 2, 3) if e != tool)
        if x > 1 and y == self.height:
            for b, place in enumerate(self.line):
                if max(place - s.shifts, 0) == x and s.stages[b] == tool - 1 and b not in s.wet:
                    yield "work", b, 0

    def charging(self, s: Where) -> Iterator[Act]:
        yield "idle", 0, 0
        x, y = s.charger
        if s.docked >= 0:
            yield from (("undock", s.docked, 0), ("charge", s.docked, 0))
            return
        yield from (("move", *side) for side in SIDES if self.inside(x + side[0], y + side[1]))
        yield from (("dock", i, 0) for i, w in enumerate(s.workers) if w is not None and w.cell == s.charger)

    def inside(self, x: int, y: int) -> bool:
        return 1 <= x <= self.width and 1 <= y <= self.height

    def apply(self, s: Where, acts: tuple[Act, ...], own: Act, shift: bool) -> Where | None:
        worked = [b for name, b, _ in acts if name == "work"]
        if len(set(worked)) < len(worked) or (shift and worked):
            return None
        stages, exchanged, workers = list(s.stages), s.exchanged, [*s.workers]
        for i, (name, a, b) in enumerate(acts):
            worker = s.workers[i]
            if name == "take":
                workers[i], exchanged = Worker((1, a), b, self.useful(self.most)), True
            elif name == "give":
                workers[i], exchanged = None, True
            elif worker is not None and name != "idle":
                (x, y), tool, battery = worker
                place = (x + a, y + b) if name == "move" else (x, y)
                workers[i] = Worker(place, a if name == "swap" else tool, battery - 1)
                if name == "work":
                    stages[a] += 1
        name, a, b = own
        charger, docked = s.charger, s.docked
        if name == "move":
            charger = charger[0] + a, charger[1] + b
        elif name in ("dock", "undock"):
            if acts[a][0] not in ("idle", "swap", "work"):
                return None
            docked = a if name == "dock" else -1
        elif name == "charge":
            worker = s.workers[a]
            if acts[a][0] != "idle" or worker is None:
                return None
            workers[a] = worker._replace(battery=self.useful(min(worker.battery + self.rate, self.most)))
        if self.crowded(s.workers, workers):
            return None
        wet = frozenset(b for b in worked if stages[b] == 1)
        return Where(tuple(workers), charger, docked, s.shifts + shift, tuple(stages), wet, exchanged)

    def crowded(self, before: tuple[Worker | None, ...], after: list[Worker | None]) -> bool:
        """Two workers share a cell, or exchange their cells."""
        for i, one in enumerate(after):
            for j, two in enumerate(after):
                if i == j or one is None or two is None:
                    continue
                was, were = before[i], before[j]
                if one.cell == two.cell:
                    return True
                if was and were and (one.cell, two.cell) == (were.cell, was.cell):
                    return True
        return False


def cell(text: int | str) -> Cell:
    x, y = str(text).strip("()").split(",")
    return int(x), int(y)
