"""The yardstick: the questions that `reasoning.planner` answers, answered in the plainest way.

Planning by a program written for clarity alone (``reference.lp``), in the solver's default configuration, length by
length from 0. Every speed of planning that is told is a ratio to it, and every optimum must be the one that it finds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

from reasoning.domain import load
from reasoning.solver import Atom, Model, Program
from reasoning.values import Answer, Found, Plan, Problem, Question, Value

Kind = Literal["alone", "lend", "borrow"]


def shortest(
    problem: Problem,
    kind: Kind = "alone",
    step: int | None = None,
    *,
    longest: int = 100,
    seconds: float | None = None,
    on_progress: Callable[[Answer], None] = lambda _: None,
    clock: Callable[[], float] = lambda: 0.0,
) -> Found:
    """The least makespan alone, lending in step `step` or earlier (None: whenever), or borrowing in `step` or later.

    The search gives up after `longest` steps or so many seconds of the clock, with status ``unknown``.
    """
    begun, used = clock(), 0
    program = _program(problem, kind, step)
    for within in range(longest + 1):
        left = None if seconds is None else seconds - (clock() - begun)
        if left is not None and left <= 0:
            return Found("unknown", None, within, "the time was over", clock() - begun, used)
        program.ground(_part(within))
        asked = clock()
        answer = _ask(program, Question(kind, within, step or 0), left)
        answer = replace(answer, seconds=clock() - asked)
        on_progress(answer)
        used += answer.conflicts
        if answer.verdict == "yes":
            proof = f"{within - 1} steps were refuted" if within else "nothing is to be done"
            return Found("optimal", answer.plan, within, proof, clock() - begun, used)
    return Found("unknown", None, longest + 1, f"{longest} steps were refuted", clock() - begun, used)


def answer(problem: Problem, question: Question, *, seconds: float | None = None) -> Answer:
    """One question, from scratch.

    Raises ValueError for a question about several robots, which it does not know.
    """
    if question.kind == "share":
        raise ValueError("the reference planner answers questions about one exchange at most")
    program = _program(problem, question.kind, question.step)
    program.ground(*map(_part, range(question.within + 1)))
    return _ask(program, question, seconds)


def _program(problem: Problem, kind: Kind, step: int | None) -> Program:
    facts = [f"static({key},{value})." for key, value in problem.static.items()]
    facts += [f"init({fluent},{value})." for fluent, value in problem.state.items()]
    facts += [f"guest({problem.guest})."] if problem.guest else []
    facts += [f"lend({'#sup' if step is None else step})."] if kind == "lend" else []
    facts += [f"borrow({0 if step is None else step})."] if kind == "borrow" else []
    return Program([load(problem.domain).program("reference")], facts)


def _part(within: int) -> tuple[str, tuple[int, ...]]:
    return ("step", (within,)) if within else ("base", ())


def _ask(program: Program, question: Question, seconds: float | None) -> Answer:
    within = question.within
    ends = [("last", (t,), t == within) for t in range(within + 1)]
    solved = program.solve(ends, seconds=seconds)
    verdict: Literal["yes", "no", "unknown"] = "unknown"
    if solved.satisfiable is not None:
        verdict = "yes" if solved.satisfiable else "no"
    plan = _plan(solved.model, within) if solved.model is not None else None
    return Answer(question, verdict, plan, solved.conflicts)


def _plan(model: Model, makespan: int) -> Plan:
    steps: list[list[str]] = [[] for _ in range(makespan)]
    details: dict[tuple[int, str], dict[str, Value]] = {}
    exchange = None
    for atom in model.atoms:
        match atom:
            case Atom("occurs", (action, int(t))):
                steps[t].append(str(action))
            case Atom("detail", (action, key, value, int(t))):
                details.setdefault((t, str(action)), {})[str(key)] = value
            case Atom("exchanged", (robot, int(t))):
                exchange = (str(robot), t)
    return Plan(tuple(map(tuple, steps)), (), details, exchange)
