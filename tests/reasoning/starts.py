"""All starts of a small team, and the least makespans of many starts from one program.

In the program the start is a choice: for each length, every start that has a plan is found, and one refutation serves
all others. Starts are complete up to the names of the workers: the rules know no names, so a team whose workers have
changed names has the same plans under the new names.
"""

from __future__ import annotations

from itertools import combinations, product
from random import Random
from typing import NamedTuple

from reasoning.asking import exchanging_one
from reasoning.domain import load
from reasoning.reference import Kind
from reasoning.solver import Assumption, Program
from reasoning.values import Problem, Question, Value

DOMAIN = "factory"
Cell = tuple[int, int]


class Start(NamedTuple):
    size: Cell
    boxes: int
    workers: tuple[tuple[Cell, int], ...]
    carrier: Cell

    def problem(self) -> Problem:
        state: dict[str, Value] = {"at(c1)": term(self.carrier), "attached(c1)": "none"}
        for number, (cell, effector) in enumerate(self.workers, 1):
            state |= {f"at(w{number})": term(cell), f"effector(w{number})": effector}
        for box in range(1, self.boxes + 1):
            state |= {f"line({box})": self.size[0] + box, f"stage({box})": 0, f"wet({box})": 0}
        static: dict[str, Value] = {"width": self.size[0], "height": self.size[1], "line": self.size[0], "delay": 2}
        return Problem(DOMAIN, static, state, f"w{len(self.workers) + 1}")


def term(cell: Cell) -> str:
    return f"({cell[0]},{cell[1]})"


def starts(size: Cell, workers: int, boxes: int) -> list[Start]:
    """All of them, up to the workers' names."""
    cells = [(x, y) for x in range(1, size[0] + 1) for y in range(1, size[1] + 1)]
    return [
        Start(size, boxes, tuple(zip(places, tools, strict=True)), carrier)
        for places in combinations(cells, workers)
        for tools in product((1, 2, 3), repeat=workers)
        for carrier in cells
    ]


def sample(size: Cell, workers: int, boxes: int, count: int) -> list[Start]:
    every = starts(size, workers, boxes)
    return Random(str((size, workers, boxes))).sample(every, min(count, len(every)))


def optima(
    given: list[Start],
    kind: Kind,
    entry: str = "reference",
    *,
    step: int | None = None,
    guest: bool = True,
    longest: int = 60,
    shortest: int = 1,
) -> list[int]:
    """The least makespan of each start by the program `reference` or `plan`, lending in `step` or earlier, borrowing in
    `step` or later (None: whenever); all starts have the same objects, and none needs fewer than `shortest` steps."""
    problem, every = given[0].problem(), [start.problem().state for start in given]
    same = {fluent: value for fluent, value in problem.state.items() if all(s[fluent] == value for s in every)}
    facts = [f"static({key},{value})." for key, value in problem.static.items()]
    facts += [f"init({fluent},{value})." for fluent, value in same.items()]
    facts += [f"own(w{number})." for number in range(1, len(given[0].workers) + 1)]
    facts += [f"guest({problem.guest})."] if guest else []
    facts += ["{ start(0..N) : starts(N) } = 1.", f"starts({len(given) - 1})."]
    facts += ["init(F,V) :- start(S), of(S,F,V).", "#show start/1."]
    facts += [
        f"of({number},{fluent},{value})."
        for number, state in enumerate(every)
        for fluent, value in state.items()
        if fluent not in same
    ]
    if entry == "reference":
        facts += {
            "alone": [],
            "lend": [f"lend({'#sup' if step is None else step})."],
            "borrow": [f"borrow({step or 0})."],
        }[kind]
    program = Program([load(DOMAIN).program(entry)], facts, load(DOMAIN).data.solver if entry == "plan" else ())
    program.ground(("base", ()), *(("step", (t,)) for t in range(1, shortest)))
    found: dict[int, int] = {}
    for within in range(shortest, longest + 1):
        program.ground(("step", (within,)))
        assumed: list[Assumption] = [("last", (t,), t == within) for t in range(within + 1)]
        if entry == "plan":
            by = step if step is not None else within if kind == "lend" else 0
            assumed = [("done", (within,), True), *exchanging_one(Question(kind, within, min(by, within)))]
        while len(found) < len(given):
            model = program.solve([*assumed, *(("start", (number,), False) for number in found)]).model
            if model is None:
                break
            found |= {int(atom.args[0]): within for atom in model.atoms if atom.name == "start"}
    return [found[number] for number in range(len(given))]
