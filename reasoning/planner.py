"""The planner of one team: the coordinator's questions, shortest plans with proof, and prediction.

Everything it knows of a domain is in three programs. ``plan.lp`` has the parts ``base`` and ``step(t)``, which leads
from state t - 1 to state t, and the atoms ``done(K)``: nothing is done from state K on; ``lent(T)``, ``borrowed(T)``: a
robot was given or taken before state T. A question is a set of assumptions about these, so all questions to one team
share one growing program, and what was learned while one was answered serves the next. ``predict.lp`` is the same
without the search, ``prospects.lp`` says what is certain before any search.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Literal

from reasoning import geometry
from reasoning.domain import load
from reasoning.solver import Assumption, Atom, Model, Program, Solved, models, parse
from reasoning.values import Answer, Found, Plan, Problem, Question, State, Step, Value

Kind = Literal["alone", "lend", "borrow"]
Details = Mapping[tuple[int, str], Mapping[str, Value]]
LONGEST = 400
"""`Planner.shortest` gives up at this makespan."""
ENDLESS = 1 << 30
LATER = 500
"""After a yes to borrowing, so many conflicts at a time are spent on a plan that borrows later."""


class Planner:
    """One team from one state. Answers are deterministic, given the questions before and budgets by conflicts.

    `beat` is called several times a second while a search runs, `cancelled` is asked as often: once it is true the
    search ends with ``unknown``. `clock` tells seconds, for the figures and for budgets in seconds; without one both
    are zero, and only a single search's budget holds.
    """

    def __init__(
        self,
        problem: Problem,
        *,
        seed: int = 0,
        beat: Callable[[], None] = lambda: None,
        cancelled: Callable[[], bool] = lambda: False,
        clock: Callable[[], float] = lambda: 0.0,
    ) -> None:
        self._problem, self._beat, self._cancelled, self._clock = problem, beat, cancelled, clock
        self._hopeless, (self._bound, self._bound_text), (self._longest, self._longest_text) = _prospects(problem)
        self._horizon = -1
        domain = load(problem.domain)
        self._program = Program([domain.program("plan")], _facts(problem), domain.data.solver, seed=seed)

    def hopeless(self) -> str:
        """Why the goal can never be reached, even with a guest if there may be one; "" if nothing speaks against it."""
        return self._hopeless

    def lower_bound(self) -> int:
        """Steps needed at least, in every role."""
        return self._bound

    def answer(self, question: Question, *, conflicts: int | None = None, seconds: float | None = None) -> Answer:
        """Answer within a budget of solver conflicts (deterministic) or wall seconds; None: however long it takes.

        Raises ValueError for a question about several robots: it plans for one exchange at most.
        """
        if question.kind == "share":
            raise ValueError("the planner answers questions about one exchange at most")
        begun = self._clock()
        kind, within, step, *_ = question
        no = self._hopeless or within < self._bound or (kind != "alone" and step < 0)
        if no or (kind == "borrow" and (step >= within or not self._problem.guest)):
            return Answer(question, "no")
        solved = self._ask(question, conflicts, seconds)
        used, plan = solved.conflicts, _plan(solved.model, within) if solved.model is not None else None
        while kind == "borrow" and plan is not None and plan.exchange is not None:
            # The later it borrows, the more questions the plan answers, and the solver is on the spot.
            left = LATER if conflicts is None else min(LATER, conflicts - used)
            left_s = None if seconds is None else seconds - (self._clock() - begun)
            if left <= 0 or (left_s is not None and left_s <= 0):
                break
            later = self._ask(question._replace(step=plan.exchange[1] + 1), left, left_s)
            used += later.conflicts
            if later.model is None:
                break
            plan = _plan(later.model, within)
        verdict: Literal["yes", "no", "unknown"] = "unknown"
        if solved.satisfiable is not None:
            verdict = "yes" if solved.satisfiable else "no"
        if verdict == "no" and kind == "alone" and not self._problem.guest and within >= self._longest:
            self._hopeless = f"{self._longest} steps were refuted by the solver; {self._longest_text}"
        return Answer(question, verdict, plan, used, self._clock() - begun)

    def _ask(self, question: Question, conflicts: int | None, seconds: float | None) -> Solved:
        kind, within, step, *_ = question
        self._reach(within)
        assumptions: list[Assumption] = [("done", (within,), True)]
        assumptions += [("lent", (within,), kind == "lend"), ("borrowed", (within,), kind == "borrow")]
        if kind == "lend":
            assumptions.append(("lent", (min(step + 1, within),), True))
        if kind == "borrow":
            assumptions.append(("borrowed", (step,), False))
        return self._program.solve(
            assumptions, conflicts=conflicts, seconds=seconds, beat=self._beat, cancelled=self._cancelled
        )

    def shortest(
        self,
        *,
        kind: Kind = "alone",
        conflicts: int | None = None,
        seconds: float | None = None,
        on_progress: Callable[[Answer], None] = lambda _: None,
    ) -> Found:
        """The shortest plan in this role, searched from the admissible bound upwards.

        The budgets are for the whole search. `on_progress` gets every answer.
        """
        begun, used = self._clock(), 0
        bound, proof = self._bound, self._bound_text

        def found(status: Literal["optimal", "infeasible", "unknown"], plan: Plan | None, why: str) -> Found:
            return Found(status, plan, bound, why, self._clock() - begun, used)

        if self._hopeless:
            return found("infeasible", None, self._hopeless)
        for within in range(bound, LONGEST + 1):
            left = None if conflicts is None else conflicts - used
            left_s = None if seconds is None else seconds - (self._clock() - begun)
            if (left is not None and left <= 0) or (left_s is not None and left_s <= 0):
                break
            step = within if kind == "lend" else 0
            answer = self.answer(Question(kind, within, step), conflicts=left, seconds=left_s)
            on_progress(answer)
            used += answer.conflicts
            if answer.verdict == "yes":
                return found("optimal", answer.plan, proof)
            if answer.verdict == "unknown":
                break
            if self._hopeless:
                return found("infeasible", None, self._hopeless)
            bound = within + 1
            proof = f"{within} steps were refuted by the solver, in {answer.conflicts} conflicts"
        return found("unknown", None, f"{proof}; then the search ended")

    def _reach(self, horizon: int) -> None:
        parts: list[tuple[str, Sequence[int]]] = [("base", ())] if self._horizon < 0 else []
        parts += [("step", (t,)) for t in range(max(self._horizon, 0) + 1, horizon + 1)]
        if parts:
            self._program.ground(*parts)
            self._horizon = max(self._horizon, horizon)


def predict(problem: Problem, steps: Sequence[Step], details: Details | None = None) -> tuple[Plan, int]:
    """What `steps` lead to, and how many of them are possible: the plan is cut before the first that is not.

    `details` are what the written actions leave out; without them, whatever is possible is assumed.
    """
    steps = tuple(steps)
    sound = next((t for t, step in enumerate(steps) if not all(map(_is_term, step))), len(steps))
    facts = [f"told({action},{t})." for t, step in enumerate(steps[:sound]) for action in step]
    facts += [
        f"told({action},{key},{value},{t})."
        for (t, action), detail in (details or {}).items()
        if t < sound and action in steps[t]
        for key, value in detail.items()
    ]
    program = Program([load(problem.domain).program("predict")], [*_facts(problem), *facts])
    program.ground(("base", ()), *(("step", (t,)) for t in range(1, sound + 1)))

    def reaches(length: int) -> Solved:
        return program.solve([("kept", (length,), True)])

    best, low, high = reaches(sound), 0, sound
    if best.model is None:  # possible prefixes are possible, so the longest is found by halving
        best, high = reaches(0), sound - 1
        while low < high:
            middle = (low + high + 1) // 2
            tried = reaches(middle)
            if tried.model is None:
                high = middle - 1
            else:
                best, low = tried, middle
    if best.model is None:  # not even waiting is possible from here
        return predict(problem, ())
    return _read(best.model, high), high


def rest(plan: Plan, done: int) -> Plan:
    """The remainder of a plan after `done` of its steps; the exchange is forgotten once it has happened."""
    exchange = plan.exchange
    if exchange is not None:
        exchange = (exchange[0], exchange[1] - done) if exchange[1] >= done else None
    details = {(t - done, action): detail for (t, action), detail in plan.details.items() if t >= done}
    return replace(plan, steps=plan.steps[done:], states=plan.states[done:], details=details, exchange=exchange)


def _facts(problem: Problem) -> list[str]:
    facts = [f"static({key},{value})." for key, value in problem.static.items()]
    facts += [f"init({fluent},{value})." for fluent, value in problem.state.items()]
    facts += geometry.facts(problem)
    return facts + ([f"guest({problem.guest})."] if problem.guest else [])


def _is_term(text: str) -> bool:
    try:
        return bool(parse(text)[0])
    except ValueError:
        return False


def _prospects(problem: Problem) -> tuple[str, tuple[int, str], tuple[int, str]]:
    """Why there is no hope, or ""; the best admissible bound, and how long a plan is at most, each with its reason."""
    (model,) = models([load(problem.domain).program("prospects")], _facts(problem))
    reasons, bounds, longest = [], [(0, "no step is needed at least")], [(ENDLESS, "")]
    for atom in model.atoms:
        match atom:
            case Atom("hopeless", (text, args)):
                reasons.append(_worded(str(text), str(args)))
            case Atom("longest", (int(steps), text, args)):
                longest.append((steps, _worded(str(text), str(args))))
            case Atom("bound", (int(steps), text, args)):
                bounds.append((steps, f"{steps} steps are needed at least: {_worded(str(text), str(args))}"))
    return "; ".join(reasons), max(bounds), min(longest)


def _worded(text: str, args: str) -> str:
    return text.format(*parse(args)[1])


def _plan(model: Model, within: int) -> Plan:
    """The plan in a model, without the idle steps at its end."""
    idle_from = 1 + max((int(a.args[1]) for a in model.atoms if a.name == "occurs"), default=-1)
    reached = [int(a.args[0]) for a in model.atoms if a.name == "goal"]
    return _read(model, min(t for t in (*reached, within) if t >= idle_from))


def _read(model: Model, makespan: int) -> Plan:
    steps: list[list[str]] = [[] for _ in range(makespan)]
    states: list[dict[str, Value]] = [{} for _ in range(makespan + 1)]
    details: dict[tuple[int, str], dict[str, Value]] = {}
    exchange = None
    for atom in model.atoms:
        match atom:
            case Atom("occurs", (action, int(t))) if t < makespan:
                steps[t].append(str(action))
            case Atom("holds", (fluent, value, int(t))) if t <= makespan:
                states[t][str(fluent)] = value
            case Atom("detail", (action, key, value, int(t))) if t < makespan:
                details.setdefault((t, str(action)), {})[str(key)] = value
            case Atom("exchanged", (robot, int(t))) if t < makespan:
                exchange = (str(robot), t)
    states_: tuple[State, ...] = tuple(states)
    return Plan(tuple(map(tuple, steps)), states_, details, exchange)
