"""A team's side of the search for a shared plan: one planner an epoch, the plans it found, and which of them to
follow."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from agents.course import rest, to_details
from agents.memory import Course
from bus import messages as m
from reasoning.checker import Exchange, check
from reasoning.planner import Planner, predict
from reasoning.sharing import Known, Ledger
from reasoning.values import Plan, Problem, Question, State, Value

Cancelled = Callable[[], bool]
NOW = Question("alone", 0)


class Prospects(NamedTuple):
    """What is certain before any search: an admissible bound on the steps needed, whether the goal is reached already,
    and why it is out of reach alone and with a guest (or "")."""

    lower_bound: int
    finished: bool
    hopeless: str
    hopeless_with_guest: str


class Planning:
    """What a team can promise from one state on. `begin` starts afresh; nothing here needs to survive a restart,
    because every question can be searched again."""

    def __init__(
        self, domain: str, static: Mapping[str, Value], conflicts: int | None, beat: Callable[[], None]
    ) -> None:
        self.epoch = -1
        self._domain, self._static, self._conflicts, self._beat = domain, static, conflicts, beat
        self._problem = Problem(domain, static, {})
        self._planner: Planner | None = None
        self._cancelled: Cancelled = lambda: False
        self._ledger = Ledger()
        self._plans: dict[Known, Course] = {}

    def begin(self, epoch: int, state: State, guest: str, course: Course | None, gone: int) -> None:
        """A new epoch from `state`; `course` is the plan, if one is still on course, `gone` its steps gone."""
        self.epoch, self._planner = epoch, None
        self._problem = Problem(self._domain, self._static, state, guest)
        self._ledger, self._plans = Ledger(), {}
        if course is not None:
            left = rest(course, gone)
            self._ledger = self._ledger.learn(*(Known(_value(q), "no") for q in left.refuted))
            self._remember(
                Known(Question(left.role, left.makespan, max(left.at, 0)), "yes", left.makespan, left.at), left
            )

    def prospects(self, cancelled: Cancelled) -> Prospects:
        planner, alone = self._search(cancelled), Planner(self._problem_of(self._problem.state))
        return Prospects(
            planner.lower_bound(), alone.answer(NOW).verdict == "yes", alone.hopeless(), planner.hopeless()
        )

    def leads_to_goal(self, course: Course) -> bool:
        """Is the goal reached where this plan ends?"""
        return Planner(self._problem_of(course.states[-1])).answer(NOW).verdict == "yes"

    def _problem_of(self, state: State) -> Problem:
        return Problem(self._domain, self._static, state)

    def answer(self, question: m.Question, cancelled: Cancelled) -> m.Answer:
        """Answer one question, from what is known if it follows from that, else by search."""
        asked = _value(question)
        known = self._ledger.witness(asked)
        if known is not None:
            return m.Answer(self.epoch, question, "yes", known.finish, max(known.at, 0))
        if self._ledger.verdict(asked) == "no":
            return m.Answer(self.epoch, question, "no")
        found = self._search(cancelled).answer(asked, conflicts=self._conflicts)
        finish, at = 0, 0
        if found.plan is not None:
            finish, at = found.plan.makespan, found.plan.exchange[1] if found.plan.exchange else 0
            self._remember(Known(asked, "yes", finish, at), _course(found.plan, asked))
        elif found.verdict == "no":
            self._ledger = self._ledger.learn(Known(asked, "no"))
        return m.Answer(self.epoch, question, found.verdict, finish, at, conflicts=found.conflicts)

    def course(self, adopt: m.Adopt, team: str, cancelled: Cancelled) -> Course | str:
        """The plan that `adopt` names, checked; or, in words, why there is none."""
        if adopt.plan:
            course = self._given(adopt)
        else:
            question = _value(adopt.question)
            if self._ledger.witness(question) is None:  # restarted since the answer was given
                self.answer(adopt.question, cancelled)
            known = self._ledger.witness(question)
            if known is None:
                return "no plan is known that answers this question"
            course = self._plans[known]
            wrong = self._violations(team, course, adopt.guest)
            if wrong:
                return wrong
        refuted = tuple(m.Question(*a.question) for a in self._ledger.answers if a.verdict == "no")
        return Course(
            adopt.start,
            course.steps,
            course.states,
            course.details,
            course.role,
            course.worker,
            course.at,
            adopt.guest,
            refuted,
        )

    def _given(self, adopt: m.Adopt) -> Course:
        """A plan from outside, as far as it can be followed: the dynamics say what it leads to."""
        plan, possible = predict(self._problem, adopt.plan)
        kind = adopt.question.kind if plan.exchange else "alone"  # an exchange beyond what is possible is none
        return _course(plan, Question(kind, possible, adopt.question.step))

    def _violations(self, team: str, course: Course, guest: str) -> str:
        """What the independent checker has against a plan, in words; every plan is checked before it is executed."""
        exchanges = None
        if course.role == "borrow":  # that the giver keeps its word is the coordinator's business
            exchanges = [Exchange(course.worker, guest, -1_000, team, course.at, course.worker)]
        details = {(k, a): d for k, by in course.details.items() for a, d in by.items()}
        problem = self._problem
        wrong = check(
            self._domain,
            self._static,
            {team: problem.state},
            {team: course.steps},
            exchanges=exchanges,
            details={team: details},
        )
        return "; ".join(f"step {v.step}: {v.action} {v.text}" for v in wrong[:3])

    def _remember(self, known: Known, course: Course) -> None:
        self._ledger = self._ledger.learn(known)
        self._plans[known] = course

    def _search(self, cancelled: Cancelled) -> Planner:
        self._cancelled = cancelled  # the planner outlives the piece of work that it was made for
        if self._planner is None:
            self._planner = Planner(self._problem, beat=self._beat, cancelled=lambda: self._cancelled())
        return self._planner


def _value(question: m.Question) -> Question:
    return Question(question.kind, question.within, question.step)


def _course(plan: Plan, question: Question) -> Course:
    worker, at = plan.exchange or ("", -1)
    states = tuple(dict(s) for s in plan.states)
    return Course(0, plan.steps, states, to_details(plan.details), question.kind, worker, at)
