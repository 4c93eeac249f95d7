"""Costs: of the shortest plans, one that costs least, with proof.

A domain whose ``domain.toml`` has a section ``[costs]`` names there the constants that say which fluent adds up a cost
(`least`) and how large a fluent may be at the end (`most`), for the room that a fluent tells (`room`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from reasoning.domain import load
from reasoning.planner import Planner
from reasoning.values import Plan, Problem, Question


def cost(problem: Problem) -> str:
    """The fluent that is to be as small as can be at the end of a plan; "" if there is none."""
    names = load(problem.domain).data.costs
    return str(problem.static.get(f"{names['least']}({problem.state.get(names['room'])})", "")) if names else ""


def bounded(problem: Problem, fluent: str, most: int) -> Problem:
    """The same problem, in which the fluent is at most so large at the end."""
    names = load(problem.domain).data.costs
    key = f"{names['most']}({problem.state[names['room']]},{fluent})"
    return replace(problem, static={**problem.static, key: most})


def cheapest(
    problem: Problem,
    plan: Plan,
    within: int,
    *,
    seconds: Callable[[], float | None] = lambda: None,
    cancelled: Callable[[], bool] = lambda: False,
    clock: Callable[[], float] = lambda: 0.0,
) -> tuple[Plan, str]:
    """A plan of at most `within` steps that costs least, and the proof in words; `plan` is one of that length.

    The cost is lowered until the solver refutes the next lower one. `seconds` tells what is left of the budget; when it
    is spent the best plan so far is the result, and the proof says so. Without a cost, `plan` itself is the result.
    """
    fluent = cost(problem)
    if not fluent:
        return plan, ""
    while True:
        spent = int(plan.states[-1][fluent])
        if spent == int(plan.states[0][fluent]):
            return plan, f"{fluent} {spent} is least: nothing is added to it"
        planner = Planner(bounded(problem, fluent, spent - 1), cancelled=cancelled, clock=clock)
        answer = planner.answer(Question("alone", within), seconds=seconds())
        if answer.plan is None:
            break
        plan = answer.plan
    if answer.verdict == "no":
        return plan, f"{fluent} {spent} is least: {spent - 1} is refuted for {within} steps"
    return plan, f"{fluent} {spent}, perhaps not the least: the search ended"
