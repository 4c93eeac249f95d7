"""What to ask a team about a profile that it is to have, so that little is asked and much follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from reasoning.ledger import Known, Ledger
from reasoning.loans import Take
from reasoning.values import Promises, Question, steps


def probe(ledger: Ledger, wanted: Question, first: Mapping[str, int]) -> Question:
    """A question no harder than `wanted`, whose answer does not follow from those so far.

    First whether the robots help if they are taken as early as can be, in step `first[kind]`, or, if fewer robots would
    do then, as early as the answer is open; then what halves the steps that are open.
    """
    low = wanted._replace(takes=tuple((kind, min(first[kind], step)) for kind, step in wanted.takes))
    if ledger.verdict(low) is None:
        return low
    if not any(_as_many(known, wanted) for known in ledger.answers):
        return _easiest(ledger, low.takes, wanted)
    while (middle := _between(low.takes, wanted.takes)) != wanted.takes:
        between = wanted._replace(takes=middle)
        if ledger.verdict(between) is None:
            return between
        low = between
    return wanted


def as_planned(plan: Known, takes: Sequence[Take], name: str) -> list[Take]:
    """Let the team take its robots when its plan does, which may be later: that is easier for those who give them."""
    late = list(takes)
    for kind in {take.kind for take in takes if take.taker == name}:
        mine = [number for number, take in enumerate(takes) if (take.taker, take.kind) == (name, kind)]
        for number, step in zip(mine, steps(plan.took, kind), strict=False):
            late[number] = takes[number]._replace(step=step)
    return late


def put_off(
    ledger: Ledger, takes: Sequence[Take], name: str, profile: Callable[[Sequence[Take]], Question]
) -> list[Take]:
    """Let the team take its robots as late as nothing known forbids: that is easier for those who give them."""
    late = list(takes)
    for number in reversed([i for i, take in enumerate(takes) if take.taker == name]):
        take = late[number]
        after = [other.step for other in late[number + 1 :] if (other.taker, other.kind) == (name, take.kind)]
        low, high = take.step, min([profile(late).within - 1, *after])
        while low < high:
            middle = (low + high + 1) // 2
            late[number] = take._replace(step=middle)
            refuted = ledger.verdict(profile(late)) in ("no", "unknown")
            low, high = (low, middle - 1) if refuted else (middle, high)
        late[number] = take._replace(step=low)
    return late


def _easiest(ledger: Ledger, first: Promises, wanted: Question) -> Question:
    """As early as possible, one robot after the other, without the answer's being known already."""
    takes = list(wanted.takes)
    for number, (kind, high) in enumerate(wanted.takes):
        low = max([first[number][1], *(step for other, step in takes[:number] if other == kind)])
        while low < high:
            middle = (low + high) // 2
            takes[number] = (kind, middle)
            is_open = ledger.verdict(wanted._replace(takes=tuple(takes))) is None
            low, high = (low, middle) if is_open else (middle + 1, high)
        takes[number] = (kind, high)
    return wanted._replace(takes=tuple(takes))


def _between(low: Promises, high: Promises) -> Promises:
    return tuple((kind, (step + late + 1) // 2) for (kind, step), (_, late) in zip(low, high, strict=True))


def _as_many(known: Known, wanted: Question) -> bool:
    """Is this a plan that takes as many robots?"""
    return known.verdict == "yes" and known.finish <= wanted.within and _kinds(known.took) == _kinds(wanted.takes)


def _kinds(promises: Promises) -> list[str]:
    return sorted(kind for kind, _ in promises)
