"""Questions why about a scenario, a plan or a recorded run, put to the solver (`reasoning.why`).

A question may have several parts: each is a claim with the clash that refutes the opposite.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from bus.clock import wall_s
from ops.compile import DELAY
from reasoning.domain import Domain
from reasoning.planner import Planner
from reasoning.reasons import Exchange, Make, Role, never, no_plan, no_sharing
from reasoning.solver import parse
from reasoning.values import Problem, Question, State, Step, Value
from reasoning.why import Clash, Possible, Unknown, explain

Progress = Callable[[str], None]
Kind = Literal["alone", "lend", "borrow"]
BEYOND = 12
"""A length that suffices is looked for up to so many steps beyond the one that is asked about."""


@dataclass(frozen=True)
class Subject:
    """What is asked about. `teams` are the plan's steps, empty if there is none; `guests` the names that borrowed
    robots would get."""

    name: str
    domain: Domain
    static: Mapping[str, Value]
    states: Mapping[str, State]
    guests: Mapping[str, str]
    teams: Mapping[str, tuple[Step, ...]] = field(default_factory=dict)

    def problem(self, team: str, *, guest: bool = True) -> Problem:
        return Problem(self.domain.name, self.static, self.states[team], self.guests.get(team, "") if guest else "")

    @property
    def makespan(self) -> int:
        return max(map(len, self.teams.values()), default=0)


def guests(domain: Domain, states: Mapping[str, State]) -> dict[str, str]:
    """What a borrowed robot would be called in each team; none if there is nobody to borrow from."""
    if not domain.data.exchanged or len(states) < 2:
        return {}
    prefix = str(domain.data.kinds[domain.data.exchanged]["prefix"])
    named = {team: re.findall(rf"\({re.escape(prefix)}(\d+)\)", " ".join(state)) for team, state in states.items()}
    return {team: f"{prefix}{max(map(int, numbers), default=0) + 1}" for team, numbers in named.items()}


@dataclass(frozen=True)
class Part:
    """`claim` is what is explained, `result` why. `possible` is what to say if there is nothing to explain. `domain` is
    None for the coordinator's question. `notes` say where the coordinator's facts come from."""

    claim: str
    result: Clash | Possible | Unknown
    possible: str
    domain: Domain | None
    notes: tuple[str, ...] = ()

    @property
    def answered(self) -> bool:
        return isinstance(self.result, Clash) and not self.result.open and self.result.checked


@dataclass
class Asker:
    """Who asks: `seconds` are what all questions may take together."""

    subject: Subject
    seconds: float
    progress: Progress
    began: float
    planners: dict[str, Planner] = field(default_factory=dict)

    def left_s(self) -> float:
        return max(self.seconds - (wall_s() - self.began), 0.0)

    def part(self, claim: str, make: Make, possible: str, domain: Domain | None, notes: tuple[str, ...] = ()) -> Part:
        self.progress(claim)
        result = explain(make, seconds=self.left_s(), clock=wall_s, on_progress=self.progress)
        return Part(claim, result, possible, domain, notes)

    def planner(self, team: str) -> Planner:
        if team not in self.planners:
            self.planners[team] = Planner(self.subject.problem(team), clock=wall_s)
        return self.planners[team]

    def can(self, team: str, question: Question) -> bool | None:
        """A team's answer; None if it took too long."""
        self.progress(f"{team}: {question.kind} within {question.within} steps, step {question.step}")
        verdict = self.planner(team).answer(question, seconds=self.left_s()).verdict
        return None if verdict == "unknown" else verdict == "yes"


class EndedError(Exception):
    """The time was over before the teams had answered what the question needs."""


# ---------------------------------------------------------------- no plan, or none that is shorter
def no_plan_at_all(asker: Asker) -> list[Part]:
    """Why is there no plan, however long?"""
    subject = asker.subject
    teams = [team for team in subject.states if asker.planner(team).hopeless()] or list(subject.states)
    return [
        asker.part(
            f"{team} has no plan, however long",
            never(subject.problem(team)),
            f"{team}: nothing speaks against a plan as long as time and room are left out: ask --within STEPS",
            subject.domain,
        )
        for team in teams
    ]


def not_within(asker: Asker, within: int, team: str = "") -> list[Part]:
    """Why is there no plan of at most `within` steps? For several teams, which of them, and which exchanges, stand in
    the way; then, with `team`, why that one cannot."""
    subject = asker.subject
    if len(subject.states) == 1:
        (only,) = subject.states
        return [_alone(asker, only, within)]
    shared = _shared(asker, f"no shared plan of {within} steps", within, {}, {})
    return [shared, *(_members(asker, shared, within, team) if team else ())]


def _alone(asker: Asker, team: str, within: int, exchange: Exchange | None = None, claim: str = "") -> Part:
    kind, step = exchange or ("alone", 0)
    lengths = range(within + 1, within + BEYOND)
    enough = next((k for k in lengths if asker.can(team, Question(kind, k, step))), within + BEYOND)
    return asker.part(
        claim or f"{team} has no plan of {within} steps",
        no_plan(asker.subject.problem(team), within, enough, exchange),
        f"{team} has a plan of {within} steps",
        asker.subject.domain,
        (f"without the limit on steps a plan of {enough} steps was looked for",),
    )


def _members(asker: Asker, shared: Part, within: int, team: str) -> list[Part]:
    """Why the team cannot what the shared clash says of it."""
    if not isinstance(shared.result, Clash):
        return []
    parts = []
    for member in shared.result.members:
        name, args = parse(member)
        if args[0] != team or name not in ("alone", "early", "late"):
            continue
        exchange: Exchange | None = None
        if name == "early":
            exchange = ("lend", int(args[1]) - 1)
        elif name == "late":
            exchange = ("borrow", int(args[1]) + 1)
        words = {"alone": "without borrowing", "early": "lending before step {1}", "late": "borrowing after step {1}"}
        parts.append(
            _alone(asker, team, within, exchange, f"{team} cannot finish in {within} steps {words[name]}".format(*args))
        )
    return parts


# ---------------------------------------------------------------- who lends, who borrows
def _shared(asker: Asker, claim: str, within: int, must: Mapping[str, Role], may_not: Mapping[str, Role]) -> Part:
    """The coordinator's question, from what the teams answer."""
    teams = sorted(asker.subject.states)
    delay = int(asker.subject.static.get(DELAY, 0))
    alone = [team for team in teams if not _answer(asker, team, Question("alone", within))]
    borrowers = {*alone, *(team for team, role in must.items() if role == "borrow")}
    early = {team: _earliest(asker, team, within) for team in teams if team not in alone}
    late = {team: _latest(asker, team, within) for team in sorted(borrowers)}
    early = {team: step for team, step in early.items() if step > 0}
    make = no_sharing(within, delay, teams, alone=alone, early=early, late=late, must=must, may_not=may_not)
    notes = (
        "nobody lends or borrows more than one robot, and nobody does both",
        "what a team cannot was refuted by its own planner",
    )
    return asker.part(claim, make, f"{within} steps are possible with these roles", None, notes)


def _earliest(asker: Asker, team: str, within: int) -> int:
    """The earliest step by which the team can lend; `within` if it cannot at all."""
    low, high = 0, within
    while low < high:
        middle = (low + high) // 2
        if _answer(asker, team, Question("lend", within, middle)):
            high = middle
        else:
            low = middle + 1
    return low


def _latest(asker: Asker, team: str, within: int) -> int:
    """The latest step from which the team can borrow; -1 if that does not help at all."""
    low, high = -1, within - 1
    while low < high:
        middle = (low + high + 1) // 2
        if _answer(asker, team, Question("borrow", within, middle)):
            low = middle
        else:
            high = middle - 1
    return low


def _answer(asker: Asker, team: str, question: Question) -> bool:
    verdict = asker.can(team, question)
    if verdict is None:
        raise EndedError(f"{team} had not answered whether it can {question.kind} within {question.within} steps")
    return verdict
