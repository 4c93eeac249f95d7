"""The values that the core computes with. Immutable, no behaviour beyond their own consistency.

Fluents, values and actions are written as terms of the domain's language: ``"at(w1)"``, ``"(1,3)"``,
``"move(w1,right)"``; integers stay integers. Steps count from 0; action step t leads from state t to state t + 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

Value = int | str
State = Mapping[str, Value]
Step = tuple[str, ...]


@dataclass(frozen=True)
class Problem:
    """What one team wants to plan: from `state` to the domain's goal.

    `static` are the domain's constants (``width``, ``height``, ``line``, ``delay``). `state` holds the sensed fluents,
    and ``"broken(c1)": 1`` for robots *known* to be broken. `guest` is the name that a borrowed robot would get
    (empty: borrowing is not possible). With `guests`, the names and kinds of robots that may be borrowed, sharing is
    general: ``share`` questions can be asked then, and no others. Domain-neutral: everything else is in the domain's
    programs.
    """

    domain: str
    static: Mapping[str, Value]
    state: State
    guest: str = ""
    guests: tuple[tuple[str, str], ...] = ()


Promises = tuple[tuple[str, int], ...]
"""Robots that are given or taken: each the kind of robot and a step. Sorted."""


def steps(promises: Promises, kind: str) -> list[int]:
    """The steps of the robots of one kind, in order."""
    return sorted(step for other, step in promises if other == kind)


class Question(NamedTuple):
    """Can the team finish within `within` steps: alone / lending a robot in step `step` or earlier /
    borrowing one in step `step` or later?

    Or ``share``: if it gives at least the robots of `gives`, each in its step or earlier, and takes at most those of
    `takes`, each in its step or later?
    """

    kind: Literal["alone", "lend", "borrow", "share"]
    within: int
    step: int = 0
    gives: Promises = ()
    takes: Promises = ()


class Handed(NamedTuple):
    """A robot of this kind that is given or taken in this step."""

    kind: str
    step: int
    robot: str


@dataclass(frozen=True)
class Plan:
    """`steps[t]` are the actions of step t; `states[t]` the predicted sensed state before it, so there is one more.

    `details[(t, action)]` is what the written action leaves out (``{"effector": 3}`` of a taken robot).
    `exchange` is the robot that is lent or borrowed and the step in which that happens, of a plan that exchanges one at
    most; `gave` and `took` are all robots that are given and taken, sorted.
    """

    steps: tuple[Step, ...]
    states: tuple[State, ...] = ()
    details: Mapping[tuple[int, str], Mapping[str, Value]] = field(default_factory=dict)
    exchange: tuple[str, int] | None = None
    gave: tuple[Handed, ...] = ()
    took: tuple[Handed, ...] = ()

    @property
    def makespan(self) -> int:
        return len(self.steps)


def promised(handed: tuple[Handed, ...]) -> Promises:
    """Without the robots' names."""
    return tuple((kind, step) for kind, step, _ in handed)


@dataclass(frozen=True)
class Answer:
    """`yes` has a plan; `no` is proved; `unknown` means that the budget ran out or the search was cancelled. `easiest`
    is a question no harder than the one that was asked, of which the no is proved, too (None: no other one)."""

    question: Question
    verdict: Literal["yes", "no", "unknown"]
    plan: Plan | None = None
    conflicts: int = 0
    seconds: float = 0.0
    easiest: Question | None = None


@dataclass(frozen=True)
class Found:
    """The result of a search for the shortest plan. `proof` says in words how lengths below were refuted."""

    status: Literal["optimal", "feasible", "infeasible", "unknown"]
    plan: Plan | None
    lower_bound: int
    proof: str
    seconds: float = 0.0
    conflicts: int = 0


@dataclass(frozen=True)
class Violation:
    """One broken rule, found by the independent checker."""

    team: str
    step: int
    action: str
    rule: str
    text: str


@dataclass(frozen=True)
class Diagnosis:
    """One minimal explanation of an observed state: `causes` are terms (``broken(c1)``, ``moved(w1)``); `since[cause]`
    the steps at which it may have begun; `happened[t]` the actions that did take place in step t of the case."""

    causes: tuple[str, ...]
    since: Mapping[str, tuple[int, ...]]
    happened: tuple[Step, ...]


@dataclass(frozen=True)
class Case:
    """What a diagnosis starts from: the sensed state before, the actions commanded since, the state sensed now, and
    at most how many robots may be broken. `guests` are the robots that came meanwhile, each with its kind."""

    domain: str
    static: Mapping[str, Value]
    before: State
    actions: tuple[Step, ...]
    observed: State
    bound: int = 2
    details: Mapping[tuple[int, str], Mapping[str, Value]] = field(default_factory=dict)
    guests: tuple[tuple[str, str], ...] = ()
