"""Least makespans: against breadth-first search, against the program without its dominance rules, and as published."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from reasoning.domain import load
from reasoning.planner import Planner
from reasoning.solver import Assumption, Program
from reasoning.values import Answer, Question
from tests.reasoning.bfs import Team
from tests.reasoning.optima import approve, least
from tests.reasoning.teams import DOMAIN, drawn, team

QUESTIONS = [
    *(Question("alone", 0),),
    *(Question("lend", 0, step) for step in (0, 2, 4, 20)),
    *(Question("borrow", 0, step) for step in (0, 2, 5)),
]


SLOW = pytest.mark.slow
MANY = [pytest.param(seed, marks=SLOW if seed > 5 else ()) for seed in range(24)]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2, 11, *(pytest.param(seed, marks=SLOW) for seed in (3, 4, 5, 8, 9))])
def test_breadth_first_search_finds_the_same_makespans(seed: int) -> None:
    problem = drawn(seed, widths=(2,), most_workers=1 + seed % 2, most_boxes=1 + (seed // 2) % 2)
    if "at(w2)" in problem.state:  # three workers are too many for so plain a search
        problem = replace(problem, guest="")
    planner, searched, longest = Planner(problem), Team(problem), 7
    for question in QUESTIONS:
        if question.kind == "borrow" and not problem.guest:
            continue
        asked: dict[int, Answer] = {}

        def ask(q: Question, asked: dict[int, Answer] = asked) -> bool:
            asked[q.within] = planner.answer(q)
            return asked[q.within].verdict == "yes"

        found = least(ask, question, longest)
        assert found == searched.least(question.kind, question.step, longest), question
        if found is not None:
            approve(problem, asked[found])


def parts(*, dominance: bool) -> list[Path]:
    """The planner's files, as its entry file names them."""
    entry = load(DOMAIN).program("plan")
    names = [line.split('"')[1] for line in entry.read_text().splitlines() if line.startswith("#include")]
    return [entry.parent / name for name in names if dominance or not name.startswith(("dominance", "values"))]


@cache
def loaded(seed: int, dominance: bool, longest: int) -> Program:
    problem = drawn(seed, widths=(2, 3, 4), heights=(2, 3), most_workers=3, most_boxes=3, breaks=0.2)
    facts = [f"static({k},{v})." for k, v in problem.static.items()] + [
        f"init({f},{v})." for f, v in problem.state.items()
    ]
    program = Program(parts(dominance=dominance), [*facts, *([f"guest({problem.guest})."] if problem.guest else [])])
    program.ground(("base", ()), *(("step", (t,)) for t in range(1, longest + 1)))
    return program


@pytest.mark.slow
@pytest.mark.parametrize("seed", MANY)
def test_dominance_and_bounds_do_not_change_any_least_makespan(seed: int) -> None:
    longest = 14

    def asking(dominance: bool) -> Callable[[Question], bool]:
        def ask(q: Question) -> bool:
            k = q.within
            assumptions: list[Assumption] = [
                ("done", (k,), True), ("lent", (k,), q.kind == "lend"), ("borrowed", (k,), q.kind == "borrow")
            ]  # fmt: skip
            if q.kind == "lend":
                assumptions.append(("lent", (min(q.step + 1, k),), True))
            if q.kind == "borrow":
                assumptions.append(("borrowed", (min(q.step, k),), False))
            return bool(loaded(seed, dominance, longest).solve(assumptions).satisfiable)

        return ask

    for question in QUESTIONS:
        assert least(asking(True), question, longest) == least(asking(False), question, longest), question


def test_one_worker_and_three_boxes_take_29_steps_as_published() -> None:
    planner = Planner(team([((1, 3), 1)], 3))
    found = planner.shortest()
    assert (found.status, found.lower_bound) == ("optimal", 29)
    assert found.plan is not None
    assert found.plan.makespan == 29
    assert found.proof.startswith("28 steps were refuted")
    approve(team([((1, 3), 1)], 3), Answer(Question("alone", 29), "yes", found.plan))


THREE = [((1, 3), 1), ((1, 2), 3), ((1, 1), 2)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("workers", "boxes", "makespan"), [(THREE[:1], 4, 36), (THREE, 5, 19), ([((1, 3), 1), ((1, 2), 2)], 4, 22)]
)
def test_shortest_plans_of_the_four_teams(
    workers: list[tuple[tuple[int, int], int]], boxes: int, makespan: int
) -> None:
    problem = team(workers, boxes)
    found = Planner(problem).shortest()
    assert (found.status, found.lower_bound) == ("optimal", makespan)
    assert found.plan is not None
    approve(problem, Answer(Question("alone", makespan), "yes", found.plan))


@pytest.mark.slow
def test_the_hard_questions_of_the_published_setup() -> None:
    three = Planner(team(THREE, 5, guest="w4"))
    assert three.answer(Question("lend", 25, 11)).verdict == "no"
    assert three.answer(Question("lend", 25, 12)).verdict == "yes"
    one = Planner(team(THREE[:1], 4, guest="w2"))
    assert one.answer(Question("borrow", 24, 13)).verdict == "no"
    assert one.answer(Question("borrow", 25, 14)).verdict == "yes"
