"""A second planner, by breadth-first search, written from the rules of the painting factory; for very small teams.

No broken robots. A search state is (workers, carrier, shifts, stages, wet, exchanged), with one carrier at most.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

from reasoning.values import Problem

Cell = tuple[int, int]


class Worker(NamedTuple):
    cell: Cell
    tool: int


class Where(NamedTuple):
    workers: tuple[Worker | None, ...]  # None: not here
    carrier: Cell | None
    tied: int  # index of the worker, or -1
    shifts: int
    stages: tuple[int, ...]
    wet: frozenset[int]
    exchanged: bool = False


class Team:
    def __init__(self, problem: Problem) -> None:
        state = problem.state
        self.width, self.height = int(problem.static["width"]), int(problem.static["height"])
        names = sorted(f[9:-1] for f in state if f.startswith("effector("))
        boxes = sorted(int(f[5:-1]) for f in state if f.startswith("line("))
        self.line = [int(state[f"line({b})"]) for b in boxes]
        self.last = max(self.line, default=0)
        workers: list[Worker | None] = [Worker(cell(state[f"at({w})"]), int(state[f"effector({w})"])) for w in names]
        carriers = [f[9:-1] for f in state if f.startswith("attached(")]
        assert len(carriers) <= 1
        place, tied = None, -1
        for c in carriers:
            place = cell(state[f"at({c})"])
            tied = names.index(str(state[f"attached({c})"])) if state[f"attached({c})"] != "none" else -1
        wet = frozenset(i for i, b in enumerate(boxes) if state[f"wet({b})"])
        stages = tuple(int(state[f"stage({b})"]) for b in boxes)
        guest = [None] if problem.guest else []
        self.start = Where((*workers, *guest), place, tied, 0, stages, wet)

    def least(self, kind: str, step: int, longest: int) -> int | None:
        """The least makespan alone, lending in step `step` or earlier, or borrowing in `step` or later; None: beyond
        `longest`. Layer by layer; a state once seen is seen again, dry, by waiting."""
        layer, seen, allowed = {self.start}, {self.start}, ""
        for t in range(longest + 1):
            if any(self.goal(s) and s.exchanged == (kind != "alone") for s in layer):
                return t
            before, allowed = allowed, {"alone": "", "lend": "give" * (t <= step), "borrow": "take" * (t >= step)}[kind]
            if before != allowed:
                layer |= {s for s in seen if not s.wet}
                seen = set(layer)
            if allowed == "" and kind == "lend":
                layer = {s for s in layer if s.exchanged}
            layer = {n for s in layer for n in self.next(s, allowed)} - seen
            seen |= layer
        return None

    def goal(self, s: Where) -> bool:
        return s.shifts >= self.last and all(stage == 3 for stage in s.stages)

    def next(self, s: Where, allowed: str) -> Iterator[Where]:
        choices = [list(self.choices(s, i, allowed)) for i in range(len(s.workers))]
        rides = list(self.rides(s))
        for acts, ride, shift in product(product(*choices), rides, (False, True)):
            after = self.apply(s, acts, ride, shift)
            if after is not None:
                yield after

    def choices(self, s: Where, i: int, allowed: str) -> Iterator[tuple[str, int]]:
        worker = s.workers[i]
        yield "idle", 0
        if worker is None:
            if allowed == "take" and not s.exchanged:
                yield from (("take", 10 * y + tool) for y in range(1, self.height + 1) for tool in (1, 2, 3))
            return
        (x, y), tool = worker
        if s.tied != i:
            yield from (("move", d) for d in (-1, 1) if 1 <= x + d <= self.width)
            if x == 1 and allowed == "give" and not s.exchanged:
                yield "give", 0
        if x == 1:
            yield from (("swap", e) for e in (1, 2, 3) if e != tool)
        if x > 1 and y == self.height:
            for b, place in enumerate(self.line):
                if max(place - s.shifts, 0) == x and s.stages[b] == tool - 1 and b not in s.wet:
                    yield "work", b

    def rides(self, s: Where) -> Iterator[tuple[str, int]]:
        yield "idle", 0
        if s.carrier is None:
            return
        x, y = s.carrier
        if s.tied >= 0:
            yield "detach", s.tied
            yield from (("lift", d) for d in (-1, 1) if 1 <= y + d <= self.height)
            return
        yield from (("slide", d) for d in (-1, 1) if 1 <= x + d <= self.width)
        yield from (("rise", d) for d in (-1, 1) if 1 <= y + d <= self.height)
        yield from (("attach", i) for i, w in enumerate(s.workers) if w is not None and w.cell == s.carrier)

    def apply(self, s: Where, acts: tuple[tuple[str, int], ...], ride: tuple[str, int], shift: bool) -> Where | None:
        workers, stages, wet, exchanged = list(s.workers), list(s.stages), set(), s.exchanged
        worked = [arg for name, arg in acts if name == "work"]
        if (
            len(set(worked)) < len(worked)
            or (shift and worked)
            or sum(name in ("take", "give") for name, _ in acts) > 1
        ):
            return None
        for i, (name, arg) in enumerate(acts):
            worker = s.workers[i]
            if name == "take":
                workers[i], exchanged = Worker((1, arg // 10), arg % 10), True
            elif name == "give":
                workers[i], exchanged = None, True
            elif worker is not None:
                (x, y), tool = worker
                if name == "move":
                    workers[i] = Worker((x + arg, y), tool)
                elif name == "swap":
                    workers[i] = Worker((x, y), arg)
                elif name == "work":
                    stages[arg] += 1
                    wet |= {arg} if stages[arg] == 1 else set()
        carrier, tied = s.carrier, s.tied
        name, arg = ride
        if carrier is not None:
            x, y = carrier
            if name == "slide":
                carrier = x + arg, y
            elif name == "rise":
                carrier = x, y + arg
            elif name in ("attach", "detach"):
                if acts[arg][0] not in ("idle", "swap", "work"):
                    return None
                tied = arg if name == "attach" else -1
            elif name == "lift":
                passenger = workers[s.tied]
                if acts[s.tied][0] != "idle" or passenger is None:
                    return None
                carrier = x, y + arg
                workers[s.tied] = Worker(carrier, passenger.tool)
        cells = [(i, w.cell) for i, w in enumerate(workers) if w is not None]
        if len({c for _, c in cells}) < len(cells):
            return None
        before = {i: w.cell for i, w in enumerate(s.workers) if w is not None}
        if any(c != c2 and before.get(i) == c2 and before.get(j) == c for i, c in cells for j, c2 in cells):
            return None
        return Where(
            tuple(workers), carrier, tied, min(s.shifts + shift, self.last), tuple(stages), frozenset(wet), exchanged
        )


def cell(text: int | str) -> Cell:
    x, y = str(text).strip("()").split(",")
    return int(x), int(y)
