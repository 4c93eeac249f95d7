"""The planner of one team: the coordinator's questions, shortest plans with proof, and prediction.

Everything it knows of a domain is in three programs. ``plan.lp`` has the parts ``base`` and ``step(t)``, which leads
from state t - 1 to state t, and the atoms ``done(K)``: nothing is done from state K on; ``lent(T)``, ``borrowed(T)``: a
robot was given or taken before state T; and, of a problem with guests, ``gave(Kind,N,T)``, ``took(Kind,N,T)``: N robots
of a kind were. A question is a set of assumptions about these, so all questions to one team share one growing program,
and what was learned while one was answered serves the next. ``predict.lp`` is the same without the search,
``prospects.lp`` says what is certain before any search.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Literal

from reasoning.asking import eased, easier, easings, exchanging_one, later, room, sharing
from reasoning.domain import load
from reasoning.prospects import prospects
from reasoning.reading import facts, plan_in, read
from reasoning.solver import Program, Solved, parse
from reasoning.values import Answer, Found, Plan, Problem, Question, Step, Value, steps

Kind = Literal["alone", "lend", "borrow"]
Details = Mapping[tuple[int, str], Mapping[str, Value]]
LONGEST = 400
"""`Planner.shortest` gives up at this makespan."""
LATER = 500
"""After an answer, so many conflicts at a time are spent on one that says more: a plan that borrows later, or an easier
question that is refuted as well."""


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
        found = prospects(problem)
        self._hopeless, self._bound, self._bound_text = found.hopeless, found.bound, found.why_bound
        self._likely = found.likely
        self._longest, self._longest_text = found.longest, found.why_longest
        self._horizon, self._stock = -1, found.stock
        self._numbers = Counter(kind for _, kind in problem.guests)
        domain = load(problem.domain)
        self._program = Program([domain.program("plan")], facts(problem), domain.data.solver, seed=seed)
        if domain.data.geometry:
            from reasoning import geometry  # only now: slow to import, and most domains do without

            geometry.interleave(problem, self._program)

    def hopeless(self) -> str:
        """Why the goal can never be reached, even with a guest if there may be one; "" if nothing speaks against it."""
        return self._hopeless

    def lower_bound(self) -> int:
        """Steps needed at least, in every role."""
        return self._bound

    def answer(self, question: Question, *, conflicts: int | None = None, seconds: float | None = None) -> Answer:
        """Answer within a budget of solver conflicts (deterministic) or wall seconds; None: however long it takes."""
        begun = self._clock()
        kind, within, step, *_ = question
        no = self._hopeless or within < self._bound or (kind != "alone" and step < 0)
        no = no or any(by < 0 for _, by in question.gives)
        if no or (kind == "borrow" and (step >= within or not self._problem.guest)):
            return Answer(question, "no")
        solved = self._ask(question, conflicts, seconds)
        used, plan = solved.conflicts, plan_in(solved.model, within) if solved.model is not None else None
        # The later it borrows, the more questions the plan answers, and the solver is on the spot. Robots that nobody
        # asked for stay.
        tried = later(question, plan) if plan is not None else []
        while tried:
            left = LATER if conflicts is None else min(LATER, conflicts - used)
            left_s = None if seconds is None else seconds - (self._clock() - begun)
            if left <= 0 or (left_s is not None and left_s <= 0):
                break
            better = self._ask(tried.pop(0), left, left_s, exactly=True)
            used += better.conflicts
            if better.model is not None:
                plan = plan_in(better.model, within)
                tried = later(question, plan)
        verdict: Literal["yes", "no", "unknown"] = "yes" if solved.satisfiable else "no"
        verdict = "unknown" if solved.satisfiable is None else verdict
        if verdict == "no" and kind == "alone" and not self._problem.guest and within >= self._longest:
            self._hopeless = f"{self._longest} steps were refuted by the solver; {self._longest_text}"
        easiest = None
        if kind == "share" and verdict == "no":
            left_s = None if seconds is None else seconds - (self._clock() - begun)
            easiest = easier(question, solved.core, self._numbers)
            easiest, more = self._ease(easiest, None if conflicts is None else conflicts - used, left_s)
            used += more
        return Answer(question, verdict, plan, used, self._clock() - begun, easiest)

    def _ease(self, refuted: Question, conflicts: int | None, seconds: float | None) -> tuple[Question, int]:
        """A question that asks as little as can be and is refuted as well, and what the search for it took."""
        begun, used = self._clock(), 0
        for easing in easings(refuted, self._numbers):
            start, low, high = refuted, 0, room(refuted, easing)
            by = high  # first of all, whether the robot matters
            while low < high and (tried := eased(start, easing, by, self._numbers)) is not None:
                left = LATER if conflicts is None else min(LATER, conflicts - used)
                left_s = None if seconds is None else seconds - (self._clock() - begun)
                if left <= 0 or (left_s is not None and left_s <= 0):
                    return refuted, used
                solved = self._ask(tried, left, left_s, told=False)
                used += solved.conflicts
                if solved.satisfiable is False:
                    low, refuted = by, easier(tried, solved.core, self._numbers)
                else:
                    high = by - 1
                by = (low + high + 1) // 2
        return refuted, used

    def _ask(
        self,
        question: Question,
        conflicts: int | None,
        seconds: float | None,
        *,
        exactly: bool = False,
        told: bool = True,
    ) -> Solved:
        begun = self._clock()
        self._beat()  # a search that is over at once gives no sign of life, and there may be many of them
        self._reach(question.within)
        if seconds is not None:
            seconds -= self._clock() - begun
            if seconds <= 0:  # a search takes a while to begin, and only then can it be stopped
                return Solved(None, None, 0)
        assumptions = sharing(question, self._numbers) if question.kind == "share" else exchanging_one(question)
        if exactly:
            numbers = {kind: len(steps(question.gives, kind)) for kind in sorted({*self._numbers, *self._stock})}
            assumptions += [("gave", (kind, n + 1, question.within), False) for kind, n in numbers.items()]
        assumptions.append(("done", (question.within,), True))
        return self._program.solve(
            assumptions, conflicts=conflicts, seconds=seconds, beat=self._beat, cancelled=self._cancelled, told=told
        )

    def shortest(
        self,
        *,
        kind: Kind = "alone",
        conflicts: int | None = None,
        seconds: float | None = None,
        on_progress: Callable[[Answer], None] = lambda _: None,
    ) -> Found:
        """The shortest plan in this role. The search begins where the shortest plan may well be and leaps ahead, in
        strides that double, until there is a plan; then it goes down until a length is refuted. Refutations are what
        costs, so the fewest are asked for, and they are easier after a plan was found.

        The budgets are for the whole search; when they end it, the best plan so far is ``feasible``. `on_progress` gets
        every answer.
        """
        begun, used = self._clock(), 0
        best: Plan | None = None
        low, proof, within, stride = self._bound, self._bound_text, self._likely, 1

        def found(status: Literal["optimal", "feasible", "infeasible", "unknown"], why: str) -> Found:
            return Found(status, best, low, why, self._clock() - begun, used)

        if self._hopeless:
            return found("infeasible", self._hopeless)
        while best is None or low < best.makespan:
            within = max(low, min(within, self._longest) if best is None else best.makespan - stride)
            left = None if conflicts is None else conflicts - used
            left_s = None if seconds is None else seconds - (self._clock() - begun)
            if within > LONGEST or (left is not None and left <= 0) or (left_s is not None and left_s <= 0):
                break
            answer = self.answer(
                Question(kind, within, within if kind == "lend" else 0), conflicts=left, seconds=left_s
            )
            on_progress(answer)
            used += answer.conflicts
            if answer.verdict == "unknown":
                break
            if answer.plan is not None:
                stride = 1 if best is None else 2 * stride
                best = answer.plan
                continue
            if self._hopeless:
                return found("infeasible", self._hopeless)
            low, within, stride = within + 1, within + stride, 2 * stride if best is None else 1
            proof = f"{low - 1} steps were refuted by the solver, in {answer.conflicts} conflicts"
        else:
            return found("optimal", proof)
        return found("unknown" if best is None else "feasible", f"{proof}; then the search ended")

    def _reach(self, horizon: int) -> None:
        # All parts in one call: step by step it takes twice as long.
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
    given = [f"told({action},{t})." for t, step in enumerate(steps[:sound]) for action in step]
    given += [
        f"told({action},{key},{value},{t})."
        for (t, action), detail in (details or {}).items()
        if t < sound and action in steps[t]
        for key, value in detail.items()
    ]
    program = Program([load(problem.domain).program("predict")], [*facts(problem), *given])
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
    return read(best.model, high), high


def _is_term(text: str) -> bool:
    try:
        return bool(parse(text)[0])
    except ValueError:
        return False
