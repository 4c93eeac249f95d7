"""Least makespans: found by asking, and what a plan that is found must be."""

from __future__ import annotations

from collections.abc import Callable

from reasoning.checker import Exchange, check
from reasoning.planner import predict
from reasoning.values import Answer, Problem, Question


def least(ask: Callable[[Question], bool], question: Question, longest: int) -> int | None:
    return next((k for k in range(longest + 1) if ask(question._replace(within=k))), None)


def approve(problem: Problem, answer: Answer) -> None:
    """A plan is what the dynamics predict of its own steps, and the independent checker finds nothing wrong with it."""
    plan = answer.plan
    assert plan is not None
    assert plan.makespan <= answer.question.within
    assert predict(problem, plan.steps, plan.details) == (plan, plan.makespan)
    kind, step = answer.question.kind, answer.question.step
    assert (plan.exchange is None) == (kind == "alone")
    exchanges = []
    if plan.exchange is not None:
        robot, at = plan.exchange
        assert at <= step if kind == "lend" else at >= step
        exchanges = [Exchange("w1", "T0", -9, "T", at, robot)] if kind == "borrow" else []
    states, steps, details = {"T": problem.state}, {"T": plan.steps}, {"T": plan.details}
    assert check(problem.domain, problem.static, states, steps, details=details, exchanges=exchanges) == []
