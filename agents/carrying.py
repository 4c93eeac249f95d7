"""What is carried over from the search that found a plan: what was refuted where the plan starts, as it is known after
some of its steps.

A question refuted where the plan began is refuted, shortened by the steps gone, wherever the plan has led since: a
faster way on from here would have been a faster way from there.
"""

from __future__ import annotations

from collections.abc import Iterable

from agents.memory import Course
from bus.messages import Question
from reasoning.values import Promises, steps


def shortened(course: Course, gone: int) -> tuple[Question, ...]:
    """What is refuted after `gone` steps of the plan, as questions about now."""
    far = [q for q in course.refuted if q.within >= gone]
    known = [_share(course, gone, q) if q.kind == "share" else _published(course, gone, q) for q in far]
    return tuple(dict.fromkeys(q for q in known if q is not None))


def waited(course: Course, gone: int, steps_waited: int | None) -> tuple[Question, ...]:
    """What is still refuted where the plan starts when, after `gone` of its steps, other steps passed without an action
    and something changed by itself: the time that they took was given for nothing. None: nothing is known any more."""
    if steps_waited is None:
        return ()
    late = {True: _share_late, False: _late}
    far = [q for q in course.refuted if q.within >= steps_waited]
    known = [late[q.kind == "share"](course, gone, q, steps_waited) for q in far]
    return tuple(q for q in known if q is not None)


# ---------------------------------------------------------------- one exchange at most
def _published(course: Course, gone: int, q: Question) -> Question | None:
    """An exchange that has happened turns questions about that role into questions about finishing alone."""
    at = _exchanged(course, gone)
    if at is None:
        far = q.kind != "lend" or q.step >= gone
        return Question(q.kind, q.within - gone, max(q.step - gone, 0)) if far else None
    # Was the exchange that took place one of those that the question asked about?
    covered = at <= q.step if q.kind == "lend" else at >= q.step
    return Question("alone", q.within - gone) if q.kind == course.role and covered else None


def _late(course: Course, gone: int, q: Question, waited: int) -> Question | None:
    if _exchanged(course, gone) is not None:  # then the steps of questions are about the past
        return Question(q.kind, q.within - waited, q.step)
    far = q.kind != "lend" or q.step >= waited
    return Question(q.kind, q.within - waited, max(q.step - waited, 0)) if far else None


def _exchanged(course: Course, gone: int) -> int | None:
    """The step of the exchange that has taken place in the first `gone` steps; None: not yet, or there is none."""
    return next((hand.step for hand in (*course.gave, *course.took) if hand.step < gone), None)


# ---------------------------------------------------------------- any number of them
def _share(course: Course, gone: int, q: Question) -> Question | None:
    """The easiest question about now that, together with what was given and taken so far, is as hard as `q`."""
    gives: list[tuple[str, int]] = []
    for kind in _kinds(q.gives):
        by, past = steps(q.gives, kind), _past(course, gone, kind)[0]
        if any(step > limit for step, limit in zip(past, by, strict=False)) or any(s < gone for s in by[len(past) :]):
            return None
        gives += [(kind, step - gone) for step in by[len(past) :]]
    takes: list[tuple[str, int]] = []
    for kind in {*_kinds(q.takes), *(hand.kind for hand in course.took)}:
        since, past = steps(q.takes, kind), _past(course, gone, kind)[1]
        if len(past) > len(since) or any(step < first for step, first in zip(past, since, strict=False)):
            return None
        takes += [(kind, max(step - gone, 0)) for step in since[len(past) :]]
    return Question("share", q.within - gone, 0, tuple(sorted(gives)), tuple(sorted(takes)))


def _share_late(course: Course, gone: int, q: Question, waited: int) -> Question | None:
    """What is still to be given and taken is so later; what was, is a matter of the past."""
    gives: list[tuple[str, int]] = []
    takes: list[tuple[str, int]] = []
    for kind in _kinds(q.gives):
        by, past = steps(q.gives, kind), len(_past(course, gone, kind)[0])
        if any(step < gone + waited for step in by[past:]):
            return None
        gives += [(kind, step - (waited if n >= past else 0)) for n, step in enumerate(by)]
    for kind in _kinds(q.takes):
        since, past = steps(q.takes, kind), len(_past(course, gone, kind)[1])
        takes += [(kind, max(step - waited, gone) if n >= past else step) for n, step in enumerate(since)]
    return Question("share", q.within - waited, 0, tuple(sorted(gives)), tuple(sorted(takes)))


def _kinds(promises: Promises) -> set[str]:
    return {kind for kind, _ in promises}


def _past(course: Course, gone: int, kind: str) -> tuple[list[int], list[int]]:
    """The steps in which robots of this kind were given, and taken, in the first `gone` steps."""

    def before(hands: Iterable[tuple[str, int]]) -> list[int]:
        return [step for step in steps(tuple(hands), kind) if step < gone]

    return before((h.kind, h.step) for h in course.gave), before((h.kind, h.step) for h in course.took)
