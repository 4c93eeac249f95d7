"""Coordinator <-> team agent: how a plan is shared and carried out together."""

from __future__ import annotations

from typing import Literal

import msgspec

from bus.messages.basics import Body, Count, Name, Outcome, Seconds, Step, Steps, Text

Promises = tuple[tuple[Name, Step], ...]
"""Robots that a plan gives or takes: each the kind of robot and the step."""


class Question(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Can you finish within `within` steps from now: alone / if you lend a worker in step `step` or
    earlier / if you borrow one in step `step` or later? Steps count from 0 at the epoch's start.

    Or ``share``: if you give at least the robots of `gives`, each a kind of robot and the step in which it is given at
    the latest, and take at most those of `takes`, each a kind and the step in which it is taken at the earliest?"""

    kind: Literal["alone", "lend", "borrow", "share"]
    within: Step
    step: Step = 0
    gives: Promises = ()
    takes: Promises = ()


class Enquire(Body, frozen=True):
    """How do you stand? Asked when a search starts and when a coordinator comes back. Reply: `Standing`."""

    epoch: Count


class Offer(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The rest of a plan that is on course: it finishes in `question.within` steps from now in that role.

    `refuted` are questions known to be answered no, carried over from the plan's own proof.
    """

    question: Question
    refuted: tuple[Question, ...] = ()


class Handover(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A robot of this kind, under the name it was built with, that left or joined a team in global step `step`."""

    robot: Name
    step: Step
    kind: str = ""


class Standing(Body, frozen=True):
    """Where a team stands. `step` is the global step that it would execute next; `lower_bound` an
    admissible bound on the steps it still needs; `offer` the rest of its plan when that is on course;
    `inspect` robots that a diagnosis still suspects; `gave` and `took` its exchanges of the whole run.
    `hopeless` says why it can never finish alone, `hopeless_with_guest` why not even with one more robot, or where
    sharing is general with as many as it may borrow (empty: it may). `stock` are the robots that it could lend then, by
    kind."""

    epoch: Count
    team: Name
    step: Step
    finished: bool
    lower_bound: Count
    offer: Offer | None = None
    inspect: tuple[Name, ...] = ()
    gave: tuple[Handover, ...] = ()
    took: tuple[Handover, ...] = ()
    hopeless: Text = ""
    hopeless_with_guest: Text = ""
    stock: dict[str, Count] = {}


class Ask(Body, frozen=True):
    """One yes/no question of the search for a shared plan. Reply: `Answer`."""

    epoch: Count
    question: Question


class Answer(Body, frozen=True):
    """`yes` comes with a plan that the team keeps; `unknown` means the budget ran out.

    `finish` is the makespan of the plan found and `at` the step of its exchange, which may both be
    better than what was asked. Of a ``share`` question: `gave` and `took` are the plan's exchanges, and `easiest` is a
    question that asks less and is answered no as well.
    """

    epoch: Count
    question: Question
    verdict: Literal["yes", "no", "unknown"]
    finish: Count = 0
    at: Count = 0
    seconds: Seconds = 0.0
    conflicts: Count = 0
    gave: Promises = ()
    took: Promises = ()
    easiest: Question | None = None


class Exchange(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """`worker` leaves team `giver` in step `give_step` and joins `taker` as `known_as` in `take_step`.

    `robot` is the name it was built with (``T2.w3``), which never changes. Steps are global.
    """

    worker: Name
    robot: Name
    giver: Name
    give_step: int
    taker: Name
    take_step: Step
    known_as: Name


class Adopt(Body, frozen=True):
    """Make the plan that answered `question` yours; it starts at global step `start`. Reply: `Adopted`.

    `guest` is the robot that a borrower will take, `plan` a given plan that replaces the search.
    """

    epoch: Count
    start: Step
    question: Question
    guest: str = ""
    plan: Steps = ()


class Welcome(Body, frozen=True):
    """Which robots your plan takes: by your own names for them, the names they were built with. Asked where sharing is
    general, once everybody has said who is given. Reply: `Adopted`, once more."""

    epoch: Count
    robots: dict[Name, Name]


class Hand(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A robot that a plan gives or takes in step `step`: its kind, the team's own name for it, and the name it was
    built with (empty: not known yet)."""

    kind: Name
    step: Step
    name: Name
    robot: str = ""


class Adopted(Body, frozen=True):
    """The team has journalled the plan. `gave` and `took` are its exchanges, in global steps, sorted."""

    epoch: Count
    team: Name
    ok: bool
    makespan: Count = 0
    gave: tuple[Hand, ...] = ()
    took: tuple[Hand, ...] = ()
    reason: Text = ""


class Go(Body, frozen=True):
    """Execute global step `step` of the adopted plan, or, when `recover`, the inspections that the
    diagnosis asked for. Reply: `StepResult`."""

    epoch: Count
    step: Step
    recover: bool = False


class Diagnosis(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One minimal explanation: `causes` are terms such as ``broken(c1)`` or ``moved(w1)``; each has the
    steps at which it may have begun; `happened` are the actions that did happen, per step."""

    causes: tuple[str, ...]
    since: dict[str, tuple[int, ...]] = {}
    happened: Steps = ()


class StepResult(Body, frozen=True):
    epoch: Count
    team: Name
    step: Step
    outcome: Outcome
    differing: tuple[str, ...] = ()
    diagnoses: tuple[Diagnosis, ...] = ()
    inspect: tuple[Name, ...] = ()
    reason: Text = ""
