"""Monitoring: does the state that is sensed differ from the one that was predicted, and where?

Pure and domain-neutral. A fluent is written as a term whose arguments name bodies, ``at(w1)``; bodies come and go: an
order may grow or be cancelled, a robot may be lent. Fluents that are not sensed (``broken(c1)``) are no business of it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from reasoning.values import State

UNSENSED = ("broken",)
_ARGUMENTS = re.compile(r"\w+")


def differing(predicted: State, observed: State) -> tuple[str, ...]:
    """The sensed fluents that have another value than predicted, or are in one of the two states only; sorted."""
    names = {fluent for fluent in (*predicted, *observed) if name(fluent) not in UNSENSED}
    return tuple(sorted(fluent for fluent in names if predicted.get(fluent) != observed.get(fluent)))


def appeared(predicted: State, observed: State, before: State | None = None) -> tuple[str, ...]:
    """The fluents of bodies that are seen although nothing was predicted of them.

    With the state `before` the step, bodies that were there already do not count: a robot that was to leave and did not
    is a discrepancy, nothing new.
    """
    known = bodies(predicted) | bodies(before or {})
    return tuple(sorted(f for f in observed if (about := set(arguments(f))) and not known & about))


def vanished(predicted: State, observed: State, before: State | None = None) -> tuple[str, ...]:
    """The fluents of bodies that were predicted and of which nothing is seen.

    With the state `before` the step, bodies that were to arrive in it do not count: one that did not is a discrepancy.
    """
    seen = bodies(observed)
    old = bodies(predicted) if before is None else bodies(before)
    return tuple(
        sorted(
            fluent
            for fluent in predicted
            if name(fluent) not in UNSENSED and any(body in old and body not in seen for body in arguments(fluent))
        )
    )


def bodies(state: State) -> set[str]:
    """The bodies that a state speaks of."""
    return {body for fluent in state if name(fluent) not in UNSENSED for body in arguments(fluent)}


def name(fluent: str) -> str:
    return fluent.partition("(")[0]


def arguments(fluent: str) -> Iterator[str]:
    return (found.group() for found in _ARGUMENTS.finditer(fluent.partition("(")[2]))
