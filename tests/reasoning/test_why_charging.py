"""Why not, in the charging factory: minimal clashes known by hand, and agreement with the planner on what is drawn."""

from __future__ import annotations

import random

import pytest

from ops.cases import read_case
from reasoning.planner import Planner, predict
from reasoning.reasons import contradicts, follow, never, no_plan, not_possible
from reasoning.values import Problem
from reasoning.why import Clash, Possible, explain
from tests.encodings.charging.teams import DOMAIN, drawn, team
from tests.encodings.charging.test_charging_agreement import problem_of, step_of
from tests.reasoning.test_why import allowed, check_minimal, clash

EMPTY = team([((2, 2), 3, 1)], [(2, 2, 0)])
"""One box, at the last place where it can be worked on, and beside it who can finish it, were there power."""
DOCKED = team([((2, 2), 1, 5)], [(2, 0, 0)], charger=(2, 2), docked="w1")
APART = team([((2, 2), 1, 5)], 1)


def test_a_drained_worker_is_charged_first() -> None:
    assert clash(no_plan(EMPTY, 3, 9)) >= {"stamped(1)", "start(battery(w1),1)", "rule(battery)", "steps(3)"}
    charged = team([((2, 2), 3, 2)], [(2, 2, 0)])
    assert isinstance(explain(no_plan(charged, 3, 4)), Possible)


@pytest.mark.parametrize(
    ("problem", "expected"),
    [
        (team([], 1), {"stamped(1)", "start(stage(1),0)", "crew"}),
        (
            team([((2, 2), 1, 1)], 1, charger=None),
            {"stamped(1)", "start(stage(1),0)", "start(battery(w1),1)", "robot(w1)", "crew", "rule(battery)"},
        ),
        (
            team([((1, 2), 1, 9)], [(1, 0, 0)]),
            {"stamped(1)", "start(stage(1),0)", "start(line(1),1)", "robot(w1)", "crew", "rule(work_column)",
             "rule(work_pit)"},
        ),
    ],
)  # fmt: skip
def test_what_can_never_be(problem: Problem, expected: set[str]) -> None:
    assert clash(never(problem)) == expected
    assert Planner(problem).hopeless()


@pytest.mark.parametrize(
    ("problem", "action", "others", "expected"),
    [
        (EMPTY, "move(w1,left)", (), {"robot(w1)", "start(battery(w1),1)", "rule(battery)"}),
        (DOCKED, "move(w1,left)", (), {"robot(w1)", "start(docked(c1),w1)", "rule(move_tied)"}),
        (DOCKED, "dock(c1,w1)", (), {"robot(w1)", "start(docked(c1),w1)", "rule(docked)"}),
        (DOCKED, "charge(c1)", ("workOn(w1,1)",), {"robot(c1)", "robot(w1)", "beside(workOn(w1,1))", "rule(undocked)",
         "rule(busy)"}),
        (APART, "charge(c1)", (), {"robot(c1)", "start(docked(c1),none)", "rule(undocked)"}),
        (APART, "dock(c1,w1)", (), {"robot(c1)", "robot(w1)", "start(at(c1),(1,1))", "start(at(w1),(2,2))",
         "rule(dock_apart)"}),
        (APART, "swapEndEffector(w1,2)", (), {"robot(w1)", "start(at(w1),(2,2))", "rule(swap_outside)"}),
        (APART, "attach(c1,w1)", (), {"rule(unknown)"}),
    ],
)  # fmt: skip
def test_an_action_that_was_not_possible(
    problem: Problem, action: str, others: tuple[str, ...], expected: set[str]
) -> None:
    assert clash(not_possible(problem, action, others)) == {f"action({action})"} | expected


@pytest.mark.slow
def test_the_planner_says_the_same_of_drawn_steps() -> None:
    rng, possible_ones = random.Random(2), 0
    for _ in range(25):
        problem, step = problem_of(rng), step_of(rng)
        _, kept = predict(problem, [step])
        assert allowed(not_possible(problem, step[0], step)) == (kept == 1), (problem.state, step)
        possible_ones += kept
    assert possible_ones >= 2


@pytest.mark.parametrize("seed", [3, *(pytest.param(n, marks=pytest.mark.slow) for n in (0, 5))])
def test_every_clash_is_minimal_and_agrees_with_the_planner(seed: int) -> None:
    problem = drawn(seed)
    found = Planner(problem).shortest()
    if found.plan is None:
        return
    assert isinstance(explain(never(problem)), Possible)
    shortest = found.plan.makespan
    assert isinstance(explain(no_plan(problem, shortest, shortest + 1)), Possible)
    check_minimal(no_plan(problem, shortest - 1, shortest))


# ---------------------------------------------------------------- a suspicion
def test_the_charger_that_does_not_charge() -> None:
    case = read_case("charging/charge_failed").case
    seen = {"commanded(charge(c1),1)", "seen(battery(w1),1)", "seen(docked(c1),w1)"}
    assert clash(contradicts(case, whole="c1")) == {"cleared(c1)", *seen}
    assert clash(contradicts(case, broken="w1")) == {"suspect(w1)", "most(1)", *seen}
    assert isinstance(explain(contradicts(case, broken="c1")), Possible)


def test_who_failed_to_dock_is_open_until_somebody_looks() -> None:
    case = read_case("charging/dock_failed").case
    assert isinstance(explain(contradicts(case, broken="c1")), Possible)
    assert isinstance(explain(contradicts(case, broken="w1")), Possible)
    sound = {"w1": "sound"}
    assert clash(contradicts(case, broken="w1", findings=sound)) == {"suspect(w1)", "inspected(w1,sound)"}
    assert isinstance(explain(contradicts(case, whole="w1")), Possible)


def test_following_a_plan_through_a_charge() -> None:
    plan = {"T": [("move(c1,up)",), ("move(c1,right)",), ("dock(c1,w1)",), ("charge(c1)",)]}
    states = follow(DOMAIN, EMPTY.static, {"T": EMPTY.state}, plan)["T"]
    assert [state["battery(w1)"] for state in states] == [1, 1, 1, 1, 5]
    assert [state["docked(c1)"] for state in states] == ["none", "none", "none", "w1", "w1"]


def test_a_clash_is_told_of_a_way_that_breaks_the_rule() -> None:
    found = explain(not_possible(EMPTY, "workOn(w1,1)"))
    assert isinstance(found, Clash)
    way = found.without["rule(battery)"]
    assert ("battery", "(w1,1)") in {(str(a.args[0]), str(a.args[3])) for a in way.atoms if a.name == "breach"}
