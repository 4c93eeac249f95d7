"""A team's side of the search for a shared plan: one planner an epoch, the plans it found, and which of them to
follow."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

from msgspec.structs import astuple, replace

from agents import course as courses
from agents.course import to_details
from agents.memory import Course
from bus import messages as m
from reasoning.checker import Exchange, check
from reasoning.ledger import Known, Ledger, learned
from reasoning.planner import Planner, predict
from reasoning.prospects import prospects
from reasoning.values import Handed, Plan, Problem, Question

Cancelled = Callable[[], bool]
NOW = Question("alone", 0)
ELSEWHERE = "another team"


class Prospects(NamedTuple):
    """What is certain before any search: an admissible bound on the steps needed, whether the goal is reached already,
    why it is out of reach alone and with guests (or ""), and the robots that could be lent where sharing is general."""

    lower_bound: int
    finished: bool
    hopeless: str
    hopeless_with_guest: str
    stock: Mapping[str, int]


class Planning:
    """What a team can promise in one epoch, from one state on. Nothing here needs to survive a restart, because every
    question can be searched again."""

    def __init__(
        self, epoch: int, problem: Problem, conflicts: int | None = None, beat: Callable[[], None] = lambda: None
    ) -> None:
        self.epoch = epoch
        self._problem, self._conflicts, self._beat = problem, conflicts, beat
        self._alone = Problem(problem.domain, problem.static, problem.state)
        self._planner: Planner | None = None
        self._cancelled: Cancelled = lambda: False
        self._ledger = Ledger(stock=prospects(self._alone).stock if problem.guests else {})
        self._plans: dict[Known, Course] = {}

    def keep(self, left: Course) -> None:
        """What remains of a plan that is still on course can be promised, and what it refutes cannot."""
        self._ledger = self._ledger.learn(*(Known(Question(*astuple(q)), "no") for q in left.refuted))
        q = Question(*astuple(courses.question(left)))
        known = Known(q, "yes", left.makespan, q.step, 0, q.gives, q.takes)
        self._remember(known, left)
        self._ledger = dataclasses.replace(self._ledger, offer=known)

    def prospects(self, cancelled: Cancelled) -> Prospects:
        planner, alone = self._search(cancelled), Planner(self._alone)
        finished = alone.answer(NOW).verdict == "yes"
        return Prospects(
            planner.lower_bound(), finished, alone.hopeless(), planner.hopeless(), dict(self._ledger.stock)
        )

    def leads_to_goal(self, course: Course) -> bool:
        """Is the goal reached where this plan ends?"""
        return Planner(Problem(self._alone.domain, self._alone.static, course.states[-1])).answer(NOW).verdict == "yes"

    def answer(self, question: m.Question, cancelled: Cancelled) -> m.Answer:
        """Answer one question, from what is known if it follows from that, else by search."""
        asked = Question(*astuple(question))
        known = self._ledger.witness(asked)
        if known is not None:
            at = max(known.at, 0)
            return m.Answer(self.epoch, question, "yes", known.finish, at, gave=known.gave, took=known.took)
        if self._ledger.verdict(asked) == "no":
            return m.Answer(self.epoch, question, "no")
        found = self._search(cancelled).answer(asked, conflicts=self._conflicts)
        known = learned(found)
        if found.plan is not None:
            self._remember(known, _course(found.plan, asked.kind))
        elif found.verdict == "no":
            self._ledger = self._ledger.learn(known)
        shared = question.kind == "share"
        return m.Answer(
            self.epoch,
            question,
            found.verdict,
            known.finish,
            known.at,
            conflicts=found.conflicts,
            gave=known.gave if shared else (),
            took=known.took if shared else (),
            easiest=m.Question(*known.question) if known.question != asked else None,
        )

    def course(self, adopt: m.Adopt, team: str, cancelled: Cancelled) -> Course | str:
        """The plan that `adopt` names, checked; or, in words, why there is none."""
        if adopt.plan:
            course = self._given(adopt)
        else:
            question = Question(*astuple(adopt.question))
            if self._ledger.witness(question) is None:  # restarted since the answer was given
                self.answer(adopt.question, cancelled)
            known = self._ledger.witness(question)
            if known is None:
                return "no plan is known that answers this question"
            course = self._plans[known]
            wrong = self._violations(team, course, adopt.guest)
            if wrong:
                return wrong
        return replace(
            course,
            start=adopt.start,
            took=tuple(replace(hand, robot=adopt.guest) for hand in course.took),
            refuted=tuple(m.Question(*a.question) for a in self._ledger.answers if a.verdict == "no"),
        )

    def _given(self, adopt: m.Adopt) -> Course:
        """A plan from outside, as far as it can be followed: the dynamics say what it leads to."""
        plan, _ = predict(self._problem, adopt.plan)
        exchanges = plan.gave or plan.took or adopt.question.kind == "share"
        return _course(plan, adopt.question.kind if exchanges else "alone")  # one beyond what is possible is none

    def _violations(self, team: str, course: Course, guest: str) -> str:
        """What the independent checker has against a plan, in words; every plan is checked before it is executed. That
        givers keep their word is the coordinator's business."""
        problem = self._problem
        wrong = check(
            problem.domain,
            problem.static,
            {team: problem.state},
            {team: course.steps},
            exchanges=[Exchange(h.name, guest or ELSEWHERE, -1_000, team, h.step, h.name) for h in course.took],
            details={team: {(k, a): d for k, by in course.details.items() for a, d in by.items()}},
            kinds={team: {h.name: h.kind for h in course.took}},
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


def _course(plan: Plan, role: Literal["alone", "lend", "borrow", "share"]) -> Course:
    def hands(handed: tuple[Handed, ...]) -> tuple[m.Hand, ...]:
        return tuple(m.Hand(*one) for one in handed)

    states = tuple(dict(s) for s in plan.states)
    return Course(0, plan.steps, states, to_details(plan.details), role, hands(plan.gave), hands(plan.took))
