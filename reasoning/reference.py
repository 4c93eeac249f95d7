"""The yardstick: the questions that `reasoning.planner` answers, answered in the plainest way.

Planning by a program written for clarity alone (``reference.lp``), in the solver's default configuration, length by
length from 0. Every speed of planning that is told is a ratio to it, and every optimum must be the one that it finds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Literal

from reasoning.domain import load
from reasoning.reading import facts as told
from reasoning.solver import Assumption, Atom, Model, Program, Solved
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
    program = _program(problem, kind, step)

    def ask(within: int, left: float | None) -> Answer:
        return _ask(program, Question(kind, within, step or 0), left)

    return _upwards(program, ask, longest, seconds, on_progress, clock)


def joint(
    problems: Mapping[str, Problem],
    *,
    longest: int = 100,
    seconds: float | None = None,
    on_progress: Callable[[Answer], None] = lambda _: None,
    clock: Callable[[], float] = lambda: 0.0,
) -> Found:
    """The least makespan of all teams, nobody exchanging more than one robot, by one program that knows all their
    models (``monolith.lp``): what questions and answers are compared with. Team names are constants of the solver, in
    lower case; there is at least one. Without the plan itself."""
    first = next(iter(problems.values()))
    facts = [f"static({key},{value})." for key, value in first.static.items()]
    for team, problem in problems.items():
        facts += [f"init({team},{fluent},{value})." for fluent, value in problem.state.items()]
        facts += [f"guest({team},{problem.guest})."] if problem.guest else []
    program = Program([load(first.domain).program("monolith")], facts)

    def ask(within: int, left: float | None) -> Answer:
        solved = program.solve(_ends(within), seconds=left)
        return Answer(Question("alone", within), _verdict(solved), None, solved.conflicts)

    return _upwards(program, ask, longest, seconds, on_progress, clock)


def _upwards(
    program: Program,
    ask: Callable[[int, float | None], Answer],
    longest: int,
    seconds: float | None,
    on_progress: Callable[[Answer], None],
    clock: Callable[[], float],
) -> Found:
    """Length by length from 0; `ask` is given the seconds that are left."""
    begun, used = clock(), 0
    for within in range(longest + 1):
        program.ground(_part(within))
        left = None if seconds is None else seconds - (clock() - begun)
        if left is not None and left <= 0:
            return Found("unknown", None, within, "the time was over", clock() - begun, used)
        asked = clock()
        answer = replace(ask(within, left), seconds=clock() - asked)
        on_progress(answer)
        used += answer.conflicts
        if answer.verdict == "yes":
            proof = f"{within - 1} steps were refuted" if within else "nothing is to be done"
            return Found("optimal", answer.plan, within, proof, clock() - begun, used)
        if answer.verdict == "unknown":
            return Found("unknown", None, within, "the time was over", clock() - begun, used)
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
    facts = told(problem)
    facts += [f"lend({'#sup' if step is None else step})."] if kind == "lend" else []
    facts += [f"borrow({0 if step is None else step})."] if kind == "borrow" else []
    return Program([load(problem.domain).program("reference")], facts)


def _part(within: int) -> tuple[str, tuple[int, ...]]:
    return ("step", (within,)) if within else ("base", ())


def _ask(program: Program, question: Question, seconds: float | None) -> Answer:
    solved = program.solve(_ends(question.within), seconds=seconds)
    plan = _plan(solved.model, question.within) if solved.model is not None else None
    return Answer(question, _verdict(solved), plan, solved.conflicts)


def _ends(within: int) -> list[Assumption]:
    return [("last", (t,), t == within) for t in range(within + 1)]


def _verdict(solved: Solved) -> Literal["yes", "no", "unknown"]:
    if solved.satisfiable is None:
        return "unknown"
    return "yes" if solved.satisfiable else "no"


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
