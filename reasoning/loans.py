"""Who lends robots to whom, as far as anything is known of the teams: the choice at the heart of sharing without limits
(program ``core/share.lp``)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import NamedTuple

from reasoning.domain import core_program
from reasoning.ledger import Ledger, Verdict, harder
from reasoning.solver import models
from reasoning.values import Question, steps


class Waiting(NamedTuple):
    """A robot on the bench: its kind, the team that gave it, and in which step. What was given before the plan's start
    has a negative step."""

    kind: str
    giver: str
    given: int


@dataclass(frozen=True)
class Market:
    """How robots come from team to team: the steps of transport between all teams or for each pair (giver, taker),
    where a pair without them cannot exchange; the robots on the bench, by built name; how many robots of each kind,
    or of that kind, a team takes at most; and the steps after which a team can have a robot back from the bench that
    it gave itself (None: never)."""

    delay: int | Mapping[tuple[str, str], int]
    bench: Mapping[str, Waiting] = field(default_factory=dict)
    most: int | Mapping[str, int] = 2
    back: int | None = None

    def steps(self, giver: str, taker: str) -> int | None:
        """The steps from giving to taking at the least; None: never."""
        if giver == taker:
            return None
        return self.delay if isinstance(self.delay, int) else self.delay.get((giver, taker))

    def limit(self, kind: str) -> int:
        """So many robots of a kind does a team take at most."""
        return self.most if isinstance(self.most, int) else self.most.get(kind, 0)

    def ready(self, robot: str, taker: str) -> int | None:
        """The first step in which a team can take a robot from the bench."""
        waiting = self.bench[robot]
        travel = self.back if waiting.giver == taker else self.steps(waiting.giver, taker)
        return None if travel is None else max(waiting.given + travel, 0)

    def first(self, taker: str, kind: str, givers: Iterable[str]) -> int:
        """No robot of the kind can be taken before this step."""
        ways = [self.steps(giver, taker) for giver in givers]
        ways += [self.ready(robot, taker) for robot, waiting in self.bench.items() if waiting.kind == kind]
        return min((step for step in ways if step is not None), default=0)


class Take(NamedTuple):
    """`taker` takes a robot in step `step` or later; it comes from a team or is a robot on the bench."""

    taker: str
    kind: str
    step: int
    giver: str


def choose(
    teams: Mapping[str, Ledger],
    market: Market,
    k: int,
    *,
    most: int | None = None,
    against: Sequence[Verdict] = ("no",),
    keep: bool = False,
) -> tuple[Take, ...] | None:
    """Exchanges with which nothing known keeps all teams from finishing in k steps; None: there are none.

    If what is known suffices for some exchanges, then such; else as few as possible, of teams of which the most is
    known. `most` limits the robots that a team gives and takes in all; `against` are the verdicts that count as a no.
    With `keep`, above all as many teams as possible go on with what they offer. Deterministic.
    """
    program = _Facts(teams, market, k, most, keep)
    for name, ledger in sorted(teams.items()):
        program.team(name, ledger, against)
    program.ports()
    found = models([core_program("share")], program.facts, optimum=True)
    return None if not found else program.read(found[0].atoms)


class _Facts:
    def __init__(self, teams: Mapping[str, Ledger], market: Market, k: int, most: int | None, keep: bool) -> None:
        self.facts = [] if most is None else [f"most({most})."]
        self._teams, self._market, self._k, self._keep = teams, market, k, keep
        kinds = {*chain.from_iterable(ledger.stock for ledger in teams.values())}
        self._kinds = sorted({*kinds, *(waiting.kind for waiting in market.bench.values())})
        names = sorted({*teams, *market.bench})
        self._names = {name: f"x{number}" for number, name in enumerate(names)}
        self._numbers = {kind: number for number, kind in enumerate(self._kinds)}
        self._questions = 0
        self._when: dict[tuple[str, str], set[int]] = {}
        for robot, waiting in sorted(market.bench.items()):
            self._add("bench", self._names[robot], self._numbers[waiting.kind])

    def team(self, name: str, ledger: Ledger, against: Sequence[Verdict]) -> None:
        team, k, market = self._names[name], self._k, self._market
        nos = [a.question for a in ledger.answers if a.verdict in against and a.question.within >= k]
        nos += [] if ledger.can_alone else [Question("share", k)]
        refuted = _easiest(q._replace(within=k) for q in nos if q.kind == "share")
        yeses = [a for a in ledger.answers if a.verdict == "yes" and a.finish <= k]
        known = _hardest(Question("share", k, 0, a.gave, a.took) for a in yeses if a.question.kind == "share")
        kept = ledger.offer if self._keep and ledger.offer in yeses else None
        offered = [] if kept is None else [Question("share", k, 0, kept.gave, kept.took)]
        known += [q for q in offered if q not in known]
        self._add("weight", team, 1 + _dear(ledger))
        for other in sorted(self._teams):
            if (travel := market.steps(other, name)) is not None:
                self._add("delay", self._names[other], team, travel)
        for robot in sorted(market.bench):
            if (step := market.ready(robot, name)) is not None:
                self._add("ready", self._names[robot], team, step)
        for kind in self._kinds:
            number = self._numbers[kind]
            self._add("stock", team, number, ledger.stock.get(kind, 0))
            taken = {s - 1 for q in refuted for s in steps(q.takes, kind)}
            taken |= {s for q in known for s in steps(q.takes, kind)}
            borrows = ledger.can_borrow and market.limit(kind) > 0
            self._when[name, kind] = {step for step in {k - 1, *taken} if 0 <= step < k} if borrows else set()
            given = {min(s, k) for q in refuted for s in steps(q.gives, kind)}
            given |= {s - 1 for q in known for s in steps(q.gives, kind) if 0 < s <= k}
            for step in sorted({k, *given}):
                self._add("matters", team, number, step)
            for nth in range(1, max((len(steps(q.gives, kind)) for q in (*refuted, *known)), default=0) + 2):
                self._add("counts", team, number, nth)
        for verdict, questions in (("no", refuted), ("yes", known)):
            for question in questions:
                self._question(verdict, team, question)
                if verdict == "yes" and question in offered:
                    self._add("offer", self._questions)

    def ports(self) -> None:
        """Who can take robots, and when. Beside the steps that matter by themselves there are those in which a robot
        must be taken at the latest to be passed on in time."""
        open_ = list(self._when)
        while open_:
            taker, kind = open_.pop()
            for giver in self._teams:
                travel, mine = self._market.steps(giver, taker), self._when[giver, kind]
                before = (
                    {step - travel - 1 for step in self._when[taker, kind]} if travel is not None and mine else set()
                )
                if before := {step for step in before - mine if step >= 0}:
                    mine |= before
                    open_.append((giver, kind))
        for (name, kind), when in self._when.items():
            for nth in range(1, self._market.limit(kind) + 1 if when else 1):
                self._add("port", self._names[name], self._numbers[kind], nth)
            for step in sorted(when):
                self._add("when", self._names[name], self._numbers[kind], step)

    def _question(self, verdict: str, team: str, question: Question) -> None:
        self._questions += 1
        self._add(verdict, self._questions, team)
        for way, promises in (("gives", question.gives), ("takes", question.takes)):
            for kind in self._kinds:
                for nth, step in enumerate(steps(promises, kind), 1):
                    shown = min(step, self._k) if way == "gives" else step
                    self._add(way, self._questions, self._numbers[kind], nth, shown)

    def _add(self, name: str, *args: str | int) -> None:
        self.facts.append(f"{name}({','.join(map(str, args))}).")

    def read(self, atoms: Iterable[tuple[str, tuple[int | str, ...]]]) -> tuple[Take, ...]:
        named = {short: name for name, short in self._names.items()}
        when: dict[tuple[int | str, ...], int] = {}
        whence: dict[tuple[int | str, ...], str] = {}
        for name, (*port, value) in atoms:
            if name == "take":
                when[tuple(port)] = int(value)
            else:
                whence[tuple(port)] = named[str(value)]
        takes = [
            Take(named[str(team)], self._kinds[int(kind)], step, whence[team, kind, nth])
            for (team, kind, nth), step in when.items()
        ]
        return tuple(sorted(takes))


def _easiest(questions: Iterable[Question]) -> list[Question]:
    """Those from whose no all the others' follow."""
    kept: list[Question] = []
    for question in sorted(set(questions)):
        if not any(harder(question, other) for other in kept):
            kept = [other for other in kept if not harder(other, question)] + [question]
    return kept


def _hardest(questions: Iterable[Question]) -> list[Question]:
    """Those from whose yes all the others' follow."""
    kept: list[Question] = []
    for question in sorted(set(questions)):
        if not any(harder(other, question) for other in kept):
            kept = [other for other in kept if not harder(question, other)] + [question]
    return kept


def _dear(ledger: Ledger) -> int:
    """What a question to a team costs, roughly: its dearest answer so far, on a scale of powers of four."""
    return max((a.cost for a in ledger.answers), default=0).bit_length() // 2
