"""The least makespans of all starts at once, by retrograde analysis: from the goal backwards, step by step, the set of
all states from which it can be reached. A third planner, written from the rules of the painting factory and sharing
nothing with the others; for at most two workers, one carrier and new boxes.

A set of states is a set of bits for each state of the boxes: bit number ((c P + p2) P + p1) says where the robots are.
Worker i is at place p_i, (effector - 1) cells + cell; the carrier at c, a cell, or cells + i when it is attached to
worker i; P is the number of places. Steps of all states are then shifts of one large integer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import product
from typing import NamedTuple

Cell = tuple[int, int]
Worker = tuple[Cell, int]
Sets = Mapping["Line", int]
TOOLS = 3


class Line(NamedTuple):
    """What the boxes are like: line shifts so far, the stage of each box, and the box that is wet (or none, -1)."""

    shifts: int
    stages: tuple[int, ...]
    wet: frozenset[int] = frozenset()


class Floor:
    """A workspace with so many workers and new boxes; its line is as long as it is wide."""

    def __init__(self, width: int, height: int, workers: int, boxes: int) -> None:
        self.width, self.height, self.workers, self.boxes = width, height, workers, boxes
        self.cells = width * height
        self.places = TOOLS * self.cells
        self.crew = self.places**workers  # so many ways to place the workers
        self.last = width + boxes
        self.everything = self._where(lambda places, c: True)
        self.apart = self._where(lambda places, c: len({p % self.cells for p in places}) == workers)
        self.tied = [self._where(lambda places, c, i=i: c == self.cells + i) for i in range(workers)]
        self.at = [
            [self._crew(lambda places, i=i, z=z: places[i] % self.cells == z) for z in range(self.cells)]
            for i in range(workers)
        ]

    def bit(self, workers: Sequence[Worker], carrier: Cell) -> int:
        """The number of the bit of a state with a free carrier; workers are (cell, effector)."""
        number = self._cell(carrier)
        for cell, tool in reversed(workers):
            number = number * self.places + (tool - 1) * self.cells + self._cell(cell)
        return number

    def _cell(self, cell: Cell) -> int:
        return (cell[1] - 1) * self.width + cell[0] - 1

    def _crew(self, holds: Callable[[tuple[int, ...]], bool]) -> int:
        every = enumerate(product(range(self.places), repeat=self.workers))
        return sum(1 << n for n, places in every if holds(places[::-1]))

    def _where(self, holds: Callable[..., bool]) -> int:
        every = range(self.cells + self.workers)
        return sum(self._crew(lambda places, c=c: holds(places, c)) << c * self.crew for c in every)

    @cache  # noqa: B019
    def worker(self, i: int, *, column: int = 0, row: int = 0, tool: int = 0) -> int:
        """All states in which worker i is in this column, in this row, and has this effector; 0: whatever."""

        def holds(places: tuple[int, ...], _: int) -> bool:
            t, cell = divmod(places[i], self.cells)
            y, x = divmod(cell, self.width)
            return column in (0, x + 1) and row in (0, y + 1) and tool in (0, t + 1)

        return self._where(holds)

    @cache  # noqa: B019
    def facing(self, way: int) -> int:
        """All states in which the second worker is next to the first one, in direction `way` (1: east)."""
        return self._where(lambda p, c: p[1] % self.cells - p[0] % self.cells == way and self._same_row(p))

    def _same_row(self, places: tuple[int, ...]) -> bool:
        return len({p % self.cells // self.width for p in places}) == 1

    @cache  # noqa: B019
    def lines(self) -> tuple[Line, ...]:
        """All states that boxes can be in on the way to the goal."""
        found = []
        for shifts in range(self.last + 1):
            kinds: list[list[tuple[int, bool]]] = []
            for box in range(self.boxes):
                place = self.width + box + 1 - shifts
                inside = [(stage, False) for stage in range(4)] + [(1, True)]
                kinds.append(inside if 1 < place <= self.width else [(0, False)] if place > 1 else [(3, False)])
            for one in product(*kinds):
                wet = frozenset(box for box, (_, is_wet) in enumerate(one) if is_wet)
                found.append(Line(shifts, tuple(stage for stage, _ in one), wet))
        return tuple(found)

    def goal(self) -> Sets:
        return {Line(self.last, (3,) * self.boxes): self.apart}

    # ---- one step back
    def before(self, after: Sets) -> Sets:
        """All states from which one step leads into `after`; also those of `after`, from which waiting would."""
        found: dict[Line, int] = {}
        for line in self.lines():
            states = after.get(line, 0)
            for following, works in self._line_steps(line):
                if following in after:
                    here = self._robots(after[following], frozenset(works))
                    for i, (column, tool) in works.items():
                        here &= self.worker(i, column=column, row=self.height, tool=tool)
                    states |= here
            if states:
                found[line] = states & self.apart
        return found

    def _line_steps(self, line: Line) -> Iterator[tuple[Line, Mapping[int, tuple[int, int]]]]:
        """What boxes can be like after a step, and which worker works where, with which effector."""
        yield Line(line.shifts, line.stages), {}
        yield Line(min(line.shifts + 1, self.last), line.stages), {}
        options = [
            (box, place, line.stages[box] + 1)
            for box in range(self.boxes)
            if 1 < (place := self.width + box + 1 - line.shifts) <= self.width
            and line.stages[box] < 3
            and box not in line.wet
        ]
        for chosen in product([None, *options], repeat=self.workers):
            works = {i: one for i, one in enumerate(chosen) if one}
            boxes = [box for box, _, _ in works.values()]
            if works and len(set(boxes)) == len(boxes):
                stages = tuple(stage + (box in boxes) for box, stage in enumerate(line.stages))
                wet = frozenset(box for box in boxes if stages[box] == 1)
                yield Line(line.shifts, stages, wet), {i: (place, tool) for i, (_, place, tool) in works.items()}

    def _robots(self, after: int, busy: frozenset[int]) -> int:
        """Where robots may have been a step before; `busy` workers stay and keep their effectors."""
        after &= self.apart
        ways = [("idle",) if i in busy else ("idle", "swap", "east", "west") for i in range(self.workers)]
        free, still, idle = 0, [0] * self.workers, [0] * self.workers
        for chosen in product(*ways):
            states = after
            for i, way in enumerate(chosen):
                states = self._moved_back(states, i, way)
            if set(chosen) == {"east", "west"}:
                states &= ~self.facing(1 if chosen[0] == "east" else -1)
            moved = {i for i, way in enumerate(chosen) if way in ("east", "west")}
            for i in range(self.workers):
                still[i] |= states if i not in moved else 0
                idle[i] |= states if chosen[i] == "idle" and i not in busy else 0
            for i in moved:
                states &= ~self.tied[i]
            free |= states
        found = free | self._carrier_moved_back(free)
        for i in range(self.workers):
            found |= self._tied_back(still[i], i) | self._carried_back(idle[i] & self.tied[i], i)
        return found

    def _moved_back(self, after: int, i: int, way: str) -> int:
        unit = self.places**i
        if way == "east":
            return (after >> unit) & ~self.worker(i, column=self.width) & self.everything
        if way == "west":
            return (after << unit) & ~self.worker(i, column=1) & self.everything
        if way == "swap":
            found = 0
            for old, new in product(range(1, TOOLS + 1), repeat=2):
                if old != new:
                    shift = (new - old) * self.cells * unit
                    moved = after >> shift if shift > 0 else after << -shift
                    found |= moved & self.worker(i, column=1, tool=old)
            return found
        return after

    def _carrier_moved_back(self, after: int) -> int:
        found = 0
        block = (1 << self.crew) - 1
        for cell in range(self.cells):
            y, x = divmod(cell, self.width)
            for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
                if 0 <= x + dx < self.width and 0 <= y + dy < self.height:
                    there = cell + dx + dy * self.width
                    found |= ((after >> there * self.crew) & block) << cell * self.crew
        return found

    def _tied_back(self, after: int, i: int) -> int:
        """Before the carrier was attached to worker i, or detached from it."""
        found, block, tied = 0, (1 << self.crew) - 1, (self.cells + i) * self.crew
        for cell in range(self.cells):
            found |= ((after >> tied) & block & self.at[i][cell]) << cell * self.crew
            found |= ((after >> cell * self.crew) & block & self.at[i][cell]) << tied
        return found

    def _carried_back(self, after: int, i: int) -> int:
        unit = self.width * self.places**i
        pushed = (after >> unit) & ~self.worker(i, row=self.height)
        pulled = (after << unit) & ~self.worker(i, row=1)
        return (pushed | pulled) & self.everything

    # ---- exchanges
    def giving(self, less: Floor, after: Sets) -> Sets:
        """All states from which a step in which a worker is given leads into `after`, of the team without it."""
        pit = [place for place in range(self.places) if place % self.cells % self.width == 0]
        found: dict[Line, int] = {}
        for line, states in less.before(after).items():
            for i in range(self.workers):
                units = [self.places**n for n in range(self.workers) if n != i]
                for carrier in range(self.cells + less.workers):  # who is given is not attached
                    block = (states >> carrier * less.crew) & ((1 << less.crew) - 1)
                    spread = sum((block >> n & 1) << n * unit for unit in units for n in range(self.places))
                    spread = spread if units else block
                    where = carrier if carrier < self.cells else self.cells + 1 - i
                    both = sum(spread << place * self.places**i for place in pit)
                    found[line] = found.get(line, 0) | both << where * self.crew
        return {line: states & self.apart for line, states in found.items()}

    def taking(self, more: Floor, after: Sets) -> Sets:
        """All states of one worker from which a step in which another one is taken leads into `after`, of both."""
        pit = [place for place in range(self.places) if place % self.cells % self.width == 0]
        found: dict[Line, int] = {}
        for line, states in after.items():
            for carrier, place in product(range(self.cells + 1), pit):
                block = (states >> (carrier * self.places + place) * self.places) & ((1 << self.places) - 1)
                found[line] = found.get(line, 0) | block << carrier * self.places
        return self.before(found)
