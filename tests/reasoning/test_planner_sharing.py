"""The planner's answers to questions about several robots against the plain reference planner, and its plans."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

import pytest

from reasoning.domain import load
from reasoning.ledger import harder
from reasoning.planner import Planner
from reasoning.reading import facts
from reasoning.solver import Program
from reasoning.values import Answer, Problem, Promises, Question, promised, steps
from tests.reasoning.teams import DOMAIN, drawn

PARTS = [load(DOMAIN).folder / f"reference_{part}.lp" for part in ("state", "start", "rules")]
KINDS = ("carrier", "stamper", "worker")
CRAFTS = {1: "painter", 2: "waxer", 3: "stamper"}


def plain(problem: Problem, question: Question) -> bool:
    """Can it be done? From scratch, by a program written for clarity alone."""
    told = [*facts(problem), *(f"guest({name})." for name, kind in problem.guests if kind != "carrier")]
    for kind in {kind for kind, _ in question.gives}:
        told += [f"give({kind},{n},{step})." for n, step in enumerate(steps(question.gives, kind), 1)]
    for kind in {kind for _, kind in problem.guests}:
        allowed = steps(question.takes, kind)
        told += [f"take({kind},{n},{step})." for n, step in enumerate(allowed, 1)] + [f"most({kind},{len(allowed)})."]
    program = Program([*PARTS, Path(__file__).with_name("plain_share.lp")], told)
    program.ground(("base", ()), *(("step", (t,)) for t in range(1, question.within + 1)))
    solved = program.solve([("last", (t,), t == question.within) for t in range(question.within + 1)])
    return bool(solved.satisfiable)


def some(seed: int) -> tuple[Problem, list[Question]]:
    """A small team, perhaps with fixed workers and without a carrier, and questions to it."""
    rng = random.Random(seed)
    problem = drawn(seed, most_workers=2, most_boxes=1)
    state = dict(problem.state)
    if rng.random() < 0.3 and state["attached(c1)"] == "none":
        del state["at(c1)"], state["attached(c1)"]
    if rng.random() < 0.4:
        state["fixed(w1)"] = 1
    guests = (("c2", "carrier"), ("w7", "stamper"), ("w8", "worker"), ("w9", "worker"))
    problem = replace(problem, state=state, guest="", guests=tuple(g for g in guests if rng.random() < 0.7) or guests)
    mine = ["carrier"] * ("at(c1)" in state) + ["worker"] * ("effector(w2)" in state)
    mine += [CRAFTS[int(state["effector(w1)"])] if "fixed(w1)" in state else "worker"]
    return problem, [question(rng, [*mine, *(kind for _, kind in problem.guests)], problem) for _ in range(6)]


def question(rng: random.Random, mine: list[str], problem: Problem) -> Question:
    within = rng.randint(2, 9)

    def promises(kinds: list[str], share: float) -> Promises:
        return tuple(sorted((kind, rng.randrange(within)) for kind in kinds if rng.random() < share))

    return Question("share", within, 0, promises(mine, 0.3), promises([kind for _, kind in problem.guests], 0.5))


def hold(answer: Answer) -> None:
    """Does the plan do what was asked, and is what it shows told?"""
    plan, asked = answer.plan, answer.question
    assert plan is not None
    assert plan.makespan <= asked.within
    done = asked._replace(gives=promised(plan.gave), takes=promised(plan.took))
    assert harder(done, asked)
    acts = {(t, action) for t, step in enumerate(plan.steps) for action in step}
    assert {(one.step, f"giveRobot({one.robot})") for one in plan.gave} == {a for a in acts if "give" in a[1]}
    assert len(plan.took) == sum("take" in action for _, action in acts)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(12), 101])
def test_answers_are_those_of_the_plain_planner(seed: int) -> None:
    problem, questions = some(seed)
    planner = Planner(problem)
    for asked in questions:
        answer = planner.answer(asked)
        assert answer.verdict == ("yes" if plain(problem, asked) else "no"), (problem, asked)
        if answer.verdict == "yes":
            hold(answer)
        elif answer.easiest is not None:
            assert harder(asked, answer.easiest)
            assert not plain(problem, answer.easiest), (problem, asked, answer.easiest)


def test_what_nobody_could_promise_is_refused_at_once() -> None:
    problem, _ = some(0)
    planner = Planner(problem)
    assert planner.answer(Question("share", 9, 0, (("worker", -1),))).verdict == "no"
    assert planner.answer(Question("share", 9, 0, tuple(("worker", 5) for _ in range(9)))).verdict == "no"
