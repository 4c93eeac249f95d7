"""The reference is the oracle: the fast planner finds the same least makespans, alone, lending and borrowing.

All starts of a size are asked of one reference program, in which the start is a choice: for each length, every start
that has a plan is found, and one refutation serves all others. The fast planner is asked start by start. Where all
starts would be too many for it, a seeded sample is drawn; the numbers are beside each test.
"""

from __future__ import annotations

import time
from itertools import combinations, product
from random import Random
from typing import NamedTuple

import pytest

from reasoning import reference
from reasoning.checker import Exchange, check
from reasoning.domain import load
from reasoning.planner import Planner
from reasoning.reference import Kind
from reasoning.solver import Assumption, Program
from reasoning.values import Plan, Problem, Question, Value

DOMAIN = "factory"
KINDS: tuple[Kind, ...] = ("alone", "lend", "borrow")
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


def optima(given: list[Start], kind: Kind, longest: int = 60) -> list[int]:
    """The reference's least makespan of each start; all have the same objects."""
    problem = given[0].problem()
    facts = [f"static({key},{value})." for key, value in problem.static.items()]
    facts += [f"guest({problem.guest}).", "{ start(0..N) : starts(N) } = 1.", f"starts({len(given) - 1})."]
    facts += ["init(F,V) :- start(S), of(S,F,V).", "#show start/1."]
    facts += {"alone": [], "lend": ["lend(#sup)."], "borrow": ["borrow(0)."]}[kind]
    for number, start in enumerate(given):
        facts += [f"of({number},{fluent},{value})." for fluent, value in start.problem().state.items()]
    program = Program([load(DOMAIN).program("reference")], facts)
    found: dict[int, int] = {}
    for within in range(longest + 1):
        program.ground(("step", (within,)) if within else ("base", ()))
        while len(found) < len(given):
            assumed: list[Assumption] = [("last", (t,), t == within) for t in range(within + 1)]
            model = program.solve([*assumed, *(("start", (number,), False) for number in found)]).model
            if model is None:
                break
            found |= {int(atom.args[0]): within for atom in model.atoms if atom.name == "start"}
    return [found[number] for number in range(len(given))]


def agree(given: list[Start], kind: Kind) -> None:
    for start, optimum in zip(given, optima(given, kind), strict=True):
        fast = Planner(start.problem()).shortest(kind=kind)
        assert (fast.status, fast.lower_bound) == ("optimal", optimum), start
        assert fast.plan is not None
        assert fast.plan.makespan == optimum, start


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("workers", "boxes"), list(product((1, 2), (1, 2, 3))))
def test_the_fast_planner_agrees_on_a_small_floor(workers: int, boxes: int, kind: Kind) -> None:
    """2 of 108 (one worker) or 810 (two workers) starts for each number of boxes and each kind of question."""
    agree(sample((3, 2), workers, boxes, 2), kind)


def test_the_fast_planner_agrees_on_every_start_of_the_smallest_floor() -> None:
    """One worker, one box: all 48 starts of a floor of 2 by 2."""
    agree(starts((2, 2), 1, 1), "alone")


@pytest.mark.parametrize("boxes", [1, 2])
def test_the_fast_planner_agrees_on_the_published_floor(boxes: int) -> None:
    """2 of 675 starts with one worker, 2 of 14,175 with two."""
    for workers in (1, 2):
        agree(sample((5, 3), workers, boxes, 2), "alone")


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_the_fast_planner_agrees_on_more_starts(kind: Kind) -> None:
    """All 48 starts of the smallest floor, then 6 and 3 of the others; with all of them it would take hours."""
    agree(starts((2, 2), 1, 2), kind)
    for workers, boxes in product((1, 2), (1, 2, 3)):
        agree(sample((3, 2), workers, boxes, 6), kind)
        agree(sample((5, 3), workers, boxes, 3), kind)


@pytest.mark.parametrize("kind", KINDS)
def test_the_reference_has_the_published_optimum_and_plans_that_the_checker_accepts(kind: Kind) -> None:
    problem = Start((5, 3), 1, (((1, 3), 1),), (1, 1)).problem()
    found = reference.shortest(problem, kind)
    assert (found.status, found.proof) == ("optimal", f"{found.lower_bound - 1} steps were refuted")
    assert found.lower_bound == {"alone": 15, "lend": 15, "borrow": 11}[kind]
    approve(problem, found.plan, kind)


def test_one_question_from_scratch() -> None:
    problem = Start((5, 3), 1, (((1, 3), 1),), (1, 1)).problem()
    assert [reference.answer(problem, Question("alone", k)).verdict for k in (14, 15, 17)] == ["no", "yes", "yes"]
    assert [reference.answer(problem, Question("lend", 15, s)).verdict for s in (13, 14)] == ["no", "yes"]
    latest = [reference.answer(problem, Question("borrow", 13, s)).verdict for s in range(13)]
    assert "".join(verdict[0] for verdict in latest) == "yyyyyyyyynnnn"


def test_the_search_ends_when_its_time_is_over() -> None:
    problem = Start((5, 3), 3, (((1, 3), 1),), (1, 1)).problem()
    assert reference.shortest(problem, seconds=0.1, clock=time.monotonic).status == "unknown"
    assert reference.shortest(problem, longest=5).lower_bound == 6


def approve(problem: Problem, plan: Plan | None, kind: Kind) -> None:
    assert plan is not None
    assert (plan.exchange is None) == (kind == "alone")
    loans = []
    if plan.exchange is not None:
        robot, at = plan.exchange
        loans = [Exchange("w1", "T0", -9, "T", at, robot)] if kind == "borrow" else []
    found = check(
        DOMAIN, problem.static, {"T": problem.state}, {"T": plan.steps}, exchanges=loans, details={"T": plan.details}
    )
    assert found == []
