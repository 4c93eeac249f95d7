"""Least makespans of the charging factory: against breadth-first search, and without the dominance rules."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from reasoning.domain import load
from reasoning.planner import Planner
from reasoning.solver import Assumption, Program
from reasoning.values import Answer, Problem, Question
from tests.encodings.charging.search import Team
from tests.encodings.charging.teams import DOMAIN, drawn, team
from tests.reasoning.optima import approve, least

LONGEST = 6
QUESTIONS = [
    Question("alone", 0),
    *(Question("lend", 0, step) for step in (0, 2, 20)),
    *(Question("borrow", 0, step) for step in (0, 2)),
]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(16))
def test_breadth_first_search_finds_the_same_makespans(seed: int) -> None:
    problem = drawn(seed)
    planner, searched = Planner(problem), Team(problem, LONGEST)
    for question in QUESTIONS:
        if question.kind == "borrow" and not problem.guest:
            continue
        asked: dict[int, Answer] = {}

        def ask(q: Question, asked: dict[int, Answer] = asked) -> bool:
            asked[q.within] = planner.answer(q)
            return asked[q.within].verdict == "yes"

        found = least(ask, question, LONGEST)
        assert found == searched.makespan(question.kind, question.step), question
        if found is not None:
            assert planner.lower_bound() <= found
            approve(problem, asked[found])


def test_a_longer_plan_with_charging_and_a_change_of_rows_is_the_least_as_well() -> None:
    """Come, dock, charge, undock, up, work, and two shifts."""
    problem = team([((2, 1), 3, 1)], [(2, 2, 0)], charger=(1, 1), size=(2, 2))
    found = Planner(problem).shortest()
    assert found.plan is not None
    assert (found.status, found.plan.makespan) == ("optimal", 8)
    assert Team(problem, 8).makespan("alone", 0) == 8
    approve(problem, Answer(Question("alone", 8), "yes", found.plan))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_the_dominance_rules_keep_a_best_plan(seed: int) -> None:
    """Teams that are too large for the plain search: the same makespans without these rules."""
    workers = [((1, 1), 1 + seed % 3, 2 + seed % 5), ((2, 2), 2, seed % 4)]
    problem = team(workers, [(2, seed % 3, 0), (3, 1, 0)], guest="w3")
    planner = Planner(problem)
    for question in (Question("alone", 0), Question("lend", 0, 5), Question("borrow", 0, 2)):
        with_rules = least(lambda q: planner.answer(q).verdict == "yes", question, 14)
        assert with_rules == least(plain(problem), question, 14)


def plain(problem: Problem) -> Callable[[Question], bool]:
    """The planner's program without its dominance rules, asked in the same way."""
    folder = load(DOMAIN).folder
    parts = [
        line.split('"')[1] for line in (folder / "plan.lp").read_text().splitlines() if line.startswith("#include")
    ]
    kept = [folder / part for part in parts if "dominance" not in part]
    assert len(parts) - len(kept) == 4
    facts = [f"static({k},{v})." for k, v in problem.static.items()]
    facts += [f"init({f},{v})." for f, v in problem.state.items()] + [f"guest({problem.guest})."]
    program = Program(kept, facts)
    program.ground(("base", ()), *(("step", (t,)) for t in range(1, 15)))

    def ask(question: Question) -> bool:
        kind, within, step, *_ = question
        assumptions: list[Assumption] = [("done", (within,), True)]
        assumptions += [("lent", (within,), kind == "lend"), ("borrowed", (within,), kind == "borrow")]
        if kind == "lend":
            assumptions.append(("lent", (min(step + 1, within),), True))
        if kind == "borrow":
            assumptions.append(("borrowed", (min(step, within),), False))
        return bool(program.solve(assumptions).satisfiable)

    return ask
