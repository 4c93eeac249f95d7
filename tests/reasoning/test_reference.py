"""The reference is the oracle: the fast planner finds the same least makespans, alone, lending and borrowing.

All starts of a size are asked of one program, in which the start is a choice: for each length, every start that has a
plan is found, and one refutation serves all others. So are the starts asked of the fast planner's program, with its
options and assumptions; on a sample the planner itself is asked, with its bounds. Starts are complete up to the names
of the workers (the rules know no names); where they are too many, a seeded sample is drawn: the numbers are beside each
test.
"""

from __future__ import annotations

import time
from itertools import product

import pytest

from reasoning import reference
from reasoning.checker import Exchange, check
from reasoning.planner import Planner
from reasoning.reference import Kind
from reasoning.sharing import Asking, Known, Ledger, advance
from reasoning.values import Plan, Problem, Question
from tests.reasoning import everywhere
from tests.reasoning.retrograde import Floor
from tests.reasoning.starts import DOMAIN, Start, optima, sample, starts

KINDS: tuple[Kind, ...] = ("alone", "lend", "borrow")


def compare(given: list[Start], kind: Kind) -> list[int]:
    """Both programs, start by start."""
    expected, told = optima(given, kind), optima(given, kind, "plan")
    assert [(s, x, y) for s, x, y in zip(given, expected, told, strict=True) if x != y] == []
    return expected


def agree(given: list[Start], kind: Kind) -> None:
    """And the planner itself."""
    for start, optimum in zip(given, compare(given, kind), strict=True):
        fast = Planner(start.problem()).shortest(kind=kind)
        assert (fast.status, fast.lower_bound) == ("optimal", optimum), start
        assert fast.plan is not None
        assert fast.plan.makespan == optimum, start


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_the_fast_planner_agrees_on_every_start_of_the_smallest_floor(kind: Kind) -> None:
    """One worker, one box: all 48 starts of a floor of 2 by 2."""
    compare(starts((2, 2), 1, 1), kind)


@pytest.mark.slow
@pytest.mark.parametrize(("workers", "boxes"), [(1, 1), (2, 1)])
def test_the_fast_planner_agrees_on_a_small_floor(workers: int, boxes: int) -> None:
    """2 of 108 (one worker) or 810 (two workers) starts of a floor of 3 by 2."""
    for kind in KINDS:
        agree(sample((3, 2), workers, boxes, 2), kind)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("workers", "boxes"), list(product((1, 2), (1, 2, 3))))
def test_the_fast_planner_agrees_on_every_start_of_small_floors(workers: int, boxes: int, kind: Kind) -> None:
    """All starts of 2 by 2, 48 or 216 (with two workers and three boxes 40 of them); all 108 of 3 by 2 with one worker
    and up to two boxes, else 10 of 108 or 810; and with one box 2 of the published floor's 675 or 14,175, where the
    planner itself is asked."""
    compare(sample((2, 2), workers, boxes, 40 if (workers, boxes) == (2, 3) else 216), kind)
    compare(sample((3, 2), workers, boxes, 108 if workers == 1 and boxes < 3 else 10), kind)
    if boxes == 1:
        agree(sample((5, 3), workers, boxes, 2), kind)


def retrograde(given: list[Start], kind: Kind, step: int | None, longest: int) -> list[int | None]:
    floor = Floor(*given[0].size, len(given[0].workers), given[0].boxes)
    if kind == "alone":
        row = everywhere.alone(floor, longest)
    elif kind == "lend":
        row = everywhere.lending(floor, longest, step)
    else:
        row = everywhere.borrowing(floor, longest, step or 0)
    return [everywhere.least(row, floor, start.workers, start.carrier) for start in given]


ASKED: list[tuple[Kind, int | None]] = [("alone", None), ("lend", None), ("borrow", 0), ("borrow", 4)]


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "step"), ASKED)
def test_retrograde_analysis_agrees_with_the_reference_on_all_starts_of_the_smallest_floor(
    kind: Kind, step: int | None
) -> None:
    given = starts((2, 2), 1, 1)
    assert retrograde(given, kind, step, 20) == optima(given, kind, step=step)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "step"), [("alone", None), ("lend", None), ("lend", 3)])
def test_retrograde_analysis_agrees_with_the_reference_on_starts_of_two_workers(kind: Kind, step: int | None) -> None:
    """20 of 810."""
    given = sample((3, 2), 2, 1, 20)
    assert retrograde(given, kind, step, 20) == optima(given, kind, step=step)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "step", "boxes"), [("alone", None, 3), ("lend", None, 2), ("borrow", 6, 1)])
def test_the_fast_planner_finds_the_least_makespans_of_the_published_floor(
    kind: Kind, step: int | None, boxes: int
) -> None:
    """One worker: 8 of 675; `bench.coverage` takes all, and two workers."""
    given = sample((5, 3), 1, boxes, 8)
    found = retrograde(given, kind, step, 20 if kind == "borrow" else 38)
    assert found == optima(given, kind, "plan", step=step, guest=kind == "borrow")


@pytest.mark.parametrize("kind", KINDS)
def test_the_reference_has_the_published_optimum_and_plans_that_the_checker_accepts(kind: Kind) -> None:
    problem = Start((5, 3), 1, (((1, 3), 1),), (1, 1)).problem()
    found = reference.shortest(problem, kind)
    assert (found.status, found.proof) == ("optimal", f"{found.lower_bound - 1} steps were refuted")
    assert found.lower_bound == {"alone": 15, "lend": 15, "borrow": 11}[kind]
    approve(problem, found.plan, kind)


@pytest.mark.slow
def test_one_question_from_scratch() -> None:
    problem = Start((5, 3), 1, (((1, 3), 1),), (1, 1)).problem()
    assert [reference.answer(problem, Question("alone", k)).verdict for k in (14, 15, 17)] == ["no", "yes", "yes"]
    assert [reference.answer(problem, Question("lend", 15, s)).verdict for s in (13, 14)] == ["no", "yes"]
    latest = [reference.answer(problem, Question("borrow", 13, s)).verdict for s in range(13)]
    assert "".join(verdict[0] for verdict in latest) == "yyyyyyyyynnnn"


@pytest.mark.slow
def test_one_program_for_two_teams_finds_what_questions_and_answers_find() -> None:
    """T1 cannot do in 13 steps alone what T2 helps it with."""
    needy, helping = Start((3, 2), 2, (((1, 2), 1),), (1, 1)), Start((3, 2), 1, (((1, 2), 1), ((2, 2), 2)), (1, 1))
    problems = {"t1": needy.problem(), "t2": helping.problem()}
    found = reference.joint(problems)
    alone = reference.shortest(needy.problem()).lower_bound
    assert (found.status, found.lower_bound) == ("optimal", 14)
    assert found.lower_bound < alone
    planners = {team: Planner(problem) for team, problem in problems.items()}
    ledgers = {team: Ledger(planner.lower_bound()) for team, planner in planners.items()}
    while isinstance(result := advance(ledgers, 2), Asking):
        for team, question in result.questions.items():
            answer = planners[team].answer(question)
            finish = (answer.plan.makespan, (answer.plan.exchange or ("", 0))[1]) if answer.plan else ()
            ledgers[team] = ledgers[team].learn(Known(question, answer.verdict, *finish))
    assert (result.status, result.makespan) == ("optimal", 14)
    assert reference.joint(problems, longest=3).lower_bound == 4


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
