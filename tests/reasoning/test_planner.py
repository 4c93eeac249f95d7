"""The planner's answers, budgets, predictions and words; makespans are compared in test_planner_optimality.py."""

from __future__ import annotations

from dataclasses import replace

import pytest

from reasoning.planner import Planner, predict
from reasoning.reading import rest
from reasoning.values import Answer, Plan, Problem, Question
from tests.reasoning import published
from tests.reasoning.teams import team

SETUP, STEPS = published.load()
GUESTS = {"T1": "w2", "T4": "w2"}


def of_published(name: str) -> Problem:
    return Problem(published.DOMAIN, SETUP.static, SETUP.states[name], GUESTS.get(name, ""))


# ---- prediction
@pytest.mark.parametrize("name", ["T1", "T2", "T3"])
def test_the_published_plans_are_possible_and_reach_the_goal(name: str) -> None:
    plan, possible = predict(of_published(name), STEPS[name], published.DETAILS.get(name, {}))
    assert possible == 27
    assert len(plan.states) == 28
    assert [set(step) for step in plan.steps] == [set(step) for step in STEPS[name]]
    assert {plan.states[-1][f] for f in plan.states[-1] if f.startswith("stage")} == {3}
    assert {plan.states[-1][f] for f in plan.states[-1] if f.startswith("line")} == {0}
    assert plan.exchange == {"T1": ("w2", 13), "T2": ("w3", 11), "T3": ("w1", 13)}[name]


def test_the_fourth_team_fails_where_its_broken_carrier_is_repaired_and_goes_on_from_there() -> None:
    problem, steps = of_published("T4"), STEPS["T4"]
    plan, possible = predict(problem, steps)
    assert possible == 17  # repair of a carrier that is not known to be broken
    failed, possible = predict(problem, [*steps[:16], ("workOn(w1,1)",)])
    assert possible == 17
    assert plan.states[17]["attached(c1)"] == "w1"
    broken = replace(problem, state={**failed.states[17], "broken(c1)": 1})
    left, possible = predict(broken, steps[17:], {(1, "takeRobot(w2,1,2)"): {"effector": 3}})
    assert possible == 10
    assert left.exchange == ("w2", 1)
    assert left.details == {(1, "takeRobot(w2,1,2)"): {"effector": 3}}
    assert all(left.states[-1][f"stage({b})"] == 3 for b in (1, 2, 3))


@pytest.mark.parametrize(
    ("spoiled", "possible"),
    [
        (("jump(w1)",), 1),
        (("no term (",), 1),
        (("move(w1,up)",), 1),
        (("move(w9,right)",), 1),
        (("move(w1,right)",), 2),
        ((), 2),
    ],
)
def test_prediction_stops_before_the_first_step_that_is_not_possible(spoiled: tuple[str, ...], possible: int) -> None:
    problem = team([((1, 3), 1)], 1)
    plan, length = predict(problem, [("move(w1,right)",), spoiled, ("move(w1,left)", "move(w1,right)")])
    assert length == plan.makespan == possible
    assert len(plan.states) == possible + 1
    assert plan.states[0] == problem.state
    assert plan.states[1]["at(w1)"] == "(2,3)"


def test_from_a_state_that_may_not_be_only_a_way_out_is_possible() -> None:
    problem = team([((1, 3), 1), ((1, 3), 2)], 1)
    assert predict(problem, [("lineShift",)])[1] == 0
    plan, possible = predict(problem, [("move(w1,right)",), ("lineShift",)])
    assert (possible, plan.states[0]) == (2, problem.state)


def test_the_rest_of_a_plan() -> None:
    plan, _ = predict(of_published("T1"), STEPS["T1"], published.DETAILS["T1"])
    left = rest(plan, 13)
    assert (left.makespan, left.exchange, left.states[0]) == (14, ("w2", 0), plan.states[13])
    assert left.details == {(0, "takeRobot(w2,1,2)"): {"effector": 3}}
    assert rest(plan, 14).exchange is None
    assert rest(plan, 14).details == {}
    assert rest(rest(plan, 5), 8) == left


# ---- questions
def test_a_plan_tells_states_as_sensors_do_and_without_robots_that_left() -> None:
    answer = Planner(team([((1, 3), 1), ((1, 2), 3)], 1)).answer(Question("lend", 20, 3))
    assert answer.verdict == "yes"
    assert answer.plan is not None
    robot, step = answer.plan.exchange or ("", 99)
    assert step <= 3
    assert f"at({robot})" in answer.plan.states[step]
    assert not [f for f in answer.plan.states[step + 1] if robot in f]
    assert answer.plan.states[0] == team([((1, 3), 1), ((1, 2), 3)], 1).state


def test_a_borrowed_robot_comes_with_an_effector_that_is_told() -> None:
    answer = Planner(team([], 1, guest="w1")).answer(Question("borrow", 20, 4))
    assert answer.verdict == "yes"
    assert answer.plan is not None
    (((step, action), detail),) = answer.plan.details.items()
    assert action.startswith("takeRobot(w1,1,")
    assert answer.plan.exchange == ("w1", step)
    assert answer.plan.states[step + 1]["effector(w1)"] == detail["effector"]


def test_what_is_asked_without_sense_is_answered_with_no() -> None:
    planner = Planner(team([((1, 3), 1)], 1))
    for question in (Question("borrow", 30, 0), Question("lend", 30, -1), Question("alone", 3)):
        assert planner.answer(question) == Answer(question, "no")


def test_an_empty_order_is_done_at_once_but_an_exchange_takes_its_step() -> None:
    planner = Planner(team([((1, 3), 1)], 0, guest="w2"))
    found = planner.shortest()
    assert (found.status, found.lower_bound) == ("optimal", 0)
    assert planner.answer(Question("lend", 1, 0)).verdict == "yes"
    assert planner.answer(Question("borrow", 3, 2)).plan is not None
    assert planner.answer(Question("lend", 0, 0)).verdict == "no"


def test_broken_robots_are_repaired_before_they_are_used() -> None:
    found = Planner(team([((2, 1), 3)], [(2, 2, 0)], size=(2, 2), broken=["w1"])).shortest()
    assert found.plan is not None
    steps = found.plan.steps
    assert "repair(w1)" in steps[0]
    assert found.plan.makespan == Planner(team([((2, 1), 3)], [(2, 2, 0)], size=(2, 2))).shortest().lower_bound


def test_wet_boxes_wait_for_one_step() -> None:
    dry = Planner(team([((2, 2), 2)], [(2, 1, 0)], size=(2, 2), carrier=None)).shortest().plan
    wet = Planner(team([((2, 2), 2)], [(2, 1, 1)], size=(2, 2), carrier=None)).shortest().plan
    assert dry is not None
    assert wet is not None
    assert "workOn(w1,1)" in dry.steps[0]
    assert wet.makespan == dry.makespan + 1


# ---- hopelessness, bounds, budgets
@pytest.mark.parametrize(
    ("problem", "words"),
    [
        (team([((1, 3), 1)], [(1, 2, 0), (2, 0, 0)]), "box 1 is at line position 1"),
        (team([((1, 2), 1)], 1, carrier=None), "no worker can ever stand beside the line"),
        (team([], 1), "no worker can ever stand"),
    ],
)
def test_hopeless_states_say_why(problem: Problem, words: str) -> None:
    planner = Planner(problem)
    assert words in planner.hopeless()
    assert planner.answer(Question("alone", 99)).verdict == "no"
    found = planner.shortest()
    assert (found.status, found.proof) == ("infeasible", planner.hopeless())


@pytest.mark.parametrize("problem", [team([((1, 3), 1)], 3), team([], 1, guest="w1"), team([((1, 3), 3)], [(1, 3, 0)])])
def test_states_that_are_not_hopeless(problem: Problem) -> None:
    assert Planner(problem).hopeless() == ""


def test_the_bound_is_admissible_and_has_a_reason() -> None:
    planner = Planner(team([((1, 3), 1)], [(2, 2, 0)], size=(2, 2), carrier=None))
    found = planner.shortest()
    assert planner.lower_bound() <= found.lower_bound
    stamping = Planner(team([((2, 2), 3)], [(2, 2, 0)], size=(2, 2), carrier=None)).shortest()
    assert stamping.lower_bound == 3
    assert stamping.proof.startswith("3 steps are needed at least: 2 line shifts")


def test_budgets_end_a_search_with_unknown_and_the_same_budget_always_at_the_same_place() -> None:
    def asked() -> Answer:
        planner = Planner(team([((1, 3), 1), ((1, 2), 3), ((1, 1), 2)], 5))
        return planner.answer(Question("lend", 22, 10), conflicts=500)

    first, second = asked(), asked()
    assert (first.verdict, first.plan) == ("unknown", None)
    assert first.conflicts == second.conflicts
    found = Planner(team([((1, 3), 1)], 4)).shortest(conflicts=300)
    assert (found.status, found.plan) == ("unknown", None)
    assert found.lower_bound >= 21


def test_a_budget_that_ends_before_the_proof_leaves_the_best_plan_so_far() -> None:
    whole: list[Answer] = []
    Planner(team([((1, 3), 1)], 4)).shortest(on_progress=whole.append)
    assert [answer.verdict for answer in whole] == ["yes", "no"]
    found = Planner(team([((1, 3), 1)], 4)).shortest(conflicts=whole[0].conflicts + 50)
    assert (found.status, found.lower_bound) == ("feasible", 21)
    assert found.plan == whole[0].plan
    assert found.proof.endswith("then the search ended")


def test_a_carrier_that_nobody_needs_stands_still() -> None:
    moved = [a for step in (Planner(team([((1, 3), 1)], 2)).shortest().plan or Plan(())).steps for a in step]
    assert moved
    assert not [action for action in moved if "c1" in action]


@pytest.mark.slow
def test_a_cancelled_search_is_unknown_and_can_be_asked_again() -> None:
    stop, beats = [True], [0]

    def beat() -> None:
        beats[0] += 1

    planner = Planner(team([((1, 3), 1), ((1, 2), 3), ((1, 1), 2)], 7), beat=beat, cancelled=lambda: stop[0])
    assert planner.answer(Question("lend", 25, 9)).verdict == "unknown"
    assert beats[0] >= 1
    stop[0] = False
    assert planner.answer(Question("alone", 45)).verdict == "yes"


def test_equal_questions_to_equal_planners_give_equal_plans() -> None:
    plans = [Planner(team([((1, 3), 1)], 2)).shortest().plan for _ in range(2)]
    assert plans[0] == plans[1]
