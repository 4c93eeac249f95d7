"""A question as assumptions about the planner's program, and what else an answer to it answers."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Literal, NamedTuple

from reasoning.solver import Assumption
from reasoning.values import Plan, Promises, Question, promised, steps


def exchanging_one(question: Question) -> list[Assumption]:
    """Of a question about one exchange at most."""
    kind, within, step, *_ = question
    assumptions: list[Assumption] = [("lent", (within,), kind == "lend"), ("borrowed", (within,), kind == "borrow")]
    if kind == "lend":
        assumptions.append(("lent", (min(step + 1, within),), True))
    if kind == "borrow":
        assumptions.append(("borrowed", (step,), False))
    return assumptions


def sharing(question: Question, guests: Mapping[str, int]) -> list[Assumption]:
    """Of a ``share`` question; so many robots of each kind might come."""
    kinds = sorted({kind for kind, _ in question.gives})
    assumptions = [_gave(question, kind, n) for kind in kinds for n in range(1, 1 + len(steps(question.gives, kind)))]
    for kind, most in guests.items():
        allowed = len(steps(question.takes, kind))
        assumptions += [_took(question, kind, n) for n in range(1, 1 + min(allowed + 1, most))]
    return assumptions


def easier(question: Question, core: Collection[Assumption], guests: Mapping[str, int]) -> Question:
    """The question that asks no more than what cannot be: the assumptions of `core`. What is not among them may be as
    easy as can be: robots that are given in no time or with the next one, taken at once or with the last one."""
    gives: list[tuple[str, int]] = []
    takes: list[tuple[str, int]] = []
    for kind in sorted({kind for kind, _ in question.gives}):
        by = steps(question.gives, kind)
        latest = None
        for n in range(len(by), 0, -1):
            latest = by[n - 1] if _gave(question, kind, n) in core else latest
            gives += [] if latest is None else [(kind, latest)]
    for kind, most in guests.items():
        since, earliest = steps(question.takes, kind), 0
        for n in range(1, most + 1):
            if _took(question, kind, n) in core:
                if n > len(since):
                    break
                earliest = since[n - 1]
            takes.append((kind, earliest))
    return question._replace(gives=tuple(sorted(gives)), takes=tuple(sorted(takes)))


class Easing(NamedTuple):
    """One robot of which a question may ask less: it is given later, or taken earlier. A robot that is not taken has
    the step `within` of its question."""

    way: Literal["gives", "takes"]
    kind: str
    step: int


def easings(question: Question, guests: Mapping[str, int]) -> list[Easing]:
    """What a question may ask less of; so many robots of each kind might come."""
    more = [kind for kind, most in guests.items() if len(steps(question.takes, kind)) < most]
    takes = [*question.takes, *((kind, question.within) for kind in more)]
    return [Easing("takes", *take) for take in takes if take[1]] + [Easing("gives", *give) for give in question.gives]


def room(question: Question, easing: Easing) -> int:
    """The steps by which less can be asked at most: a robot is taken at once, or not given."""
    return easing.step if easing.way == "takes" else max(question.within - easing.step, 0)


def eased(question: Question, easing: Easing, by: int, guests: Mapping[str, int]) -> Question | None:
    """The question that asks less of this robot by so many steps; None: it does not ask for that robot any more."""
    one = easing.kind, easing.step
    if easing.way == "gives":
        if one not in question.gives:
            return None
        gives = list(question.gives)
        gives.remove(one)
        gives += [(easing.kind, easing.step + by)] * (easing.step + by < question.within)
        return question._replace(gives=tuple(sorted(gives)))
    takes = list(question.takes)
    if one in takes:
        takes.remove(one)
    elif easing.step < question.within or len(steps(question.takes, easing.kind)) >= guests[easing.kind]:
        return None
    return question._replace(takes=tuple(sorted([*takes, (easing.kind, easing.step - by)])))


def later(question: Question, plan: Plan) -> list[Question]:
    """Questions that `plan`, which answers `question`, does not answer: they take a robot later, or give no robot that
    nobody asked for."""
    if question.kind == "borrow" and plan.exchange is not None:
        return [question._replace(step=plan.exchange[1] + 1)]
    if question.kind != "share":
        return []
    takes = promised(plan.took)
    changed = [(n, (kind, step + 1)) for n, (kind, step) in enumerate(takes) if step + 1 < plan.makespan]
    late: list[Promises] = [tuple(sorted((*takes[:n], one, *takes[n + 1 :]))) for n, one in changed]
    same = [takes] if len(plan.gave) > len(question.gives) else []
    return [question._replace(takes=takes) for takes in (*same, *late)]


def _gave(question: Question, kind: str, n: int) -> Assumption:
    """The n-th robot of a kind is given in time."""
    return "gave", (kind, n, min(steps(question.gives, kind)[n - 1] + 1, question.within)), True


def _took(question: Question, kind: str, n: int) -> Assumption:
    """The n-th robot of a kind is not taken too early; not at all, if there is no such promise."""
    since = steps(question.takes, kind)
    return "took", (kind, n, min(since[n - 1], question.within) if n <= len(since) else question.within), False
