"""What a team that acts for itself tells its planner: things that are left as they are, robots that come later or act
in the last steps only."""

from __future__ import annotations

from dataclasses import replace

from reasoning.checker import check
from reasoning.planner import Planner
from reasoning.values import Plan, Problem
from tests.encodings.housekeeping.rooms import DOMAIN, problem, robot, thing

TWO = problem([robot("r1", 0, 0), robot("r2", 0, 2)], [thing("a", 1, 0), thing("b", 1, 2)])


def planned(start: Problem, **static: str) -> Plan:
    """A shortest plan that the checker approves of."""
    told = replace(start, static={**start.static, **{f"{key}(living_room,0)": value for key, value in static.items()}})
    plan = Planner(told).shortest().plan
    assert plan is not None
    assert not check(DOMAIN, told.static, {"T1": told.state}, {"T1": plan.steps}, details={"T1": plan.details})
    return plan


def acting(plan: Plan, body: str) -> list[int]:
    """The steps in which a robot acts."""
    return [t for t, step in enumerate(plan.steps) for action in step if f"({body}" in action]


def test_what_is_left_lies_where_it_lies() -> None:
    plan = planned(TWO, leave="a")
    assert plan.states[-1]["at(a)"] == "(1,0)"
    assert plan.makespan == 4


def test_a_robot_that_comes_later_does_nothing_before() -> None:
    both = planned(TWO)
    assert both.makespan == 4
    plan = planned(TWO, away="(r2,4)")
    assert all(int(plan.states[t]["elapsed"]) >= 4 for t in acting(plan, "r2"))
    assert planned(TWO, away="(r2,0)").makespan == 4


def test_a_robot_acts_in_the_last_steps_only() -> None:
    plan = planned(TWO, late="(r2,3)")
    assert all(step >= plan.makespan - 3 for step in acting(plan, "r2"))
    assert plan.makespan == 8
