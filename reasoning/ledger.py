"""What is known of one team: its answers to the coordinator's questions, and what follows from them.

Answers are monotone: a team that can finish in k steps can in k + 1; who can lend by step s can by s + 1; who can
borrow from step s on can from s - 1 on. The same holds of each robot of a ``share`` question, and who can give more
robots or needs fewer can do what is asked of it too: sort the steps of a kind, let a robot that is not given or not
taken have step infinity, and one question is at least as hard as another iff its gives are nowhere later and its takes
nowhere earlier.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import Literal, NamedTuple

from reasoning.values import Answer, Promises, Question, promised, steps

Verdict = Literal["yes", "no", "unknown"]


class Known(NamedTuple):
    """One answer. For a `yes`, `finish` and `at` (step of the exchange) are those of the plan that was found, and so
    are `gave` and `took`, for a ``share`` question. `cost` is what the search for it took, in solver conflicts."""

    question: Question
    verdict: Verdict
    finish: int = 0
    at: int = 0
    cost: int = 0
    gave: Promises = ()
    took: Promises = ()


def learned(answer: Answer) -> Known:
    """A planner's answer as it is kept: a no is one to the easiest question of which it is proved."""
    plan = answer.plan
    if plan is None:
        return Known(answer.easiest or answer.question, answer.verdict, cost=answer.conflicts)
    at = plan.exchange[1] if plan.exchange else 0
    gave, took = promised(plan.gave), promised(plan.took)
    return Known(answer.question, answer.verdict, plan.makespan, at, answer.conflicts, gave, took)


@dataclass(frozen=True)
class Ledger:
    """What is known of one team: answers so far, an admissible bound on its makespan in any role, and whether it
    can ever finish alone or with borrowed robots. `stock` are the robots that it has, by kind; it can give those, and
    what it has taken before. `offer` is the answer that it follows already, if there is one: where sharing is general
    it is kept wherever it does what is asked."""

    lower_bound: int = 0
    answers: tuple[Known, ...] = ()
    can_alone: bool = True
    can_borrow: bool = True
    stock: Mapping[str, int] = field(default_factory=dict)
    offer: Known | None = None

    def learn(self, *known: Known) -> Ledger:
        return replace(self, answers=(*self.answers, *known))

    def cost(self, kind: Literal["lend", "borrow", "share"]) -> int:
        """The dearest answer so far to a question of this kind."""
        return max((a.cost for a in self.answers if a.question.kind == kind), default=0)

    def witness(self, question: Question) -> Known | None:
        """A known yes from which this question's yes follows; of several, the one with the best exchange step."""
        kind, within, *_ = question
        found = [
            a
            for a in self.answers
            if a.verdict == "yes" and a.question.kind == kind and a.finish <= within and _serves(a, question)
        ]
        if kind == "share":
            if self.offer in found:
                return self.offer
            return min(found, key=lambda a: (len(a.gave) + len(a.took), a.finish), default=None)
        return min(found, key=lambda a: (-a.at if kind == "borrow" else a.at, a.finish), default=None)

    def verdict(self, question: Question) -> Verdict | None:
        """What follows from the answers so far; None: nothing does."""
        if self.witness(question) is not None:
            return "yes"
        if question.within < self.lower_bound or self._out_of_question(question):
            return "no"
        for verdict in ("no", "unknown"):
            for a in self.answers:
                if a.verdict == verdict and harder(question, a.question):
                    return "no" if verdict == "no" else "unknown"
        return None

    def _out_of_question(self, q: Question) -> bool:
        if q.kind != "share":
            return q.step > q.within or not (self.can_borrow if q.kind == "borrow" else self.can_alone)
        return (
            any(_by(q.gives, kind, step) > self._has(kind, step, q) for kind, step in q.gives)
            or any(step < 0 for _, step in q.gives)
            or not (self.can_borrow if q.takes else self.can_alone)
        )

    def _has(self, kind: str, step: int, q: Question) -> int:
        """So many robots can be given in this step or earlier: who takes one has it from the next step on."""
        return self.stock.get(kind, 0) + _by(q.takes, kind, step - 1)


def harder(one: Question, other: Question) -> bool:
    """Is `one` at least as hard as `other`, so that the no to `other` is one to it, too?"""
    if one.kind != other.kind or one.within > other.within:
        return False
    if one.kind == "share":
        return _no_later(one.gives, other.gives) and _no_later(other.takes, one.takes)
    return one.step <= other.step if one.kind == "lend" else one.step >= other.step


def _by(promises: Promises, kind: str, step: int) -> int:
    return sum(by <= step for by in steps(promises, kind))


def _serves(known: Known, question: Question) -> bool:
    """Does the plan of this yes do what is asked?"""
    if question.kind == "share":
        return _no_later(known.gave, question.gives) and _no_later(question.takes, known.took)
    if question.kind == "alone":
        return True
    return known.at <= question.step if question.kind == "lend" else known.at >= question.step


def _no_later(these: Promises, those: Promises) -> bool:
    """For each kind and n, is the n-th step of these no later than that of those? One that is missing is infinitely
    late."""
    for kind in {kind for kind, _ in those}:
        mine: list[float] = [*steps(these, kind)]
        wanted = steps(those, kind)
        mine += [inf] * (len(wanted) - len(mine))
        if any(step > by for step, by in zip(mine, wanted, strict=False)):
            return False
    return True
