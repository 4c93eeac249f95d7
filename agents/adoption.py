"""A shared plan on its way to the teams: who is asked to adopt what, in which order, and what is exchanged then."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Literal, NamedTuple

from agents.setups import GivenPlan
from bus import messages as m
from reasoning.sharing import Loan, Shared


class _Exchange(NamedTuple):
    """One robot's way by the teams' words: `gives` is None if it waits on the bench, under its built name `giver`."""

    giver: str
    gives: m.Hand | None
    taker: str
    takes: m.Hand


class Adoption:
    """One plan from global step `start` on, found by the search or given. `bench` holds the robots there, with the
    global step of their giving; `general`: sharing is not under the published limits."""

    def __init__(
        self,
        plan: Shared | GivenPlan,
        epoch: int,
        start: int,
        teams: Iterable[str],
        bench: Mapping[str, int],
        *,
        general: bool = False,
    ) -> None:
        self.plan, self.start = plan, start
        self.adopted: dict[str, m.Adopted] = {}
        self._epoch, self._teams, self._bench, self._general = epoch, sorted(teams), bench, general

    @property
    def makespan(self) -> int:
        """Steps until the last team is done."""
        return max((a.makespan for a in self.adopted.values()), default=0)

    def missing(self) -> dict[str, m.Body]:
        """What to ask of whom next; nothing when all have adopted. Under the published limits lenders come first: they
        say which robot they give, which their borrowers must know. In general a robot may be passed on, so all adopt
        first and are told then which robots come. A given plan says so itself."""
        if isinstance(self.plan, GivenPlan):
            first = {team: self._given(self.plan, team) for team in self._teams if team not in self.adopted}
        elif self._general:
            first = {team: self._found(self.plan, team) for team in sorted(self.plan.roles) if team not in self.adopted}
        else:
            first = self._lenders_first(self.plan)
        return {**first} if first or not self._general else {**self._welcomes()}

    def counted_on(self, team: str, answer: m.Adopted) -> bool:
        """Does the plan that a team has adopted exchange all that other teams count on? One that was found anew, after
        the team was killed, may exchange less than the one that answered the question."""
        loans = self.plan.loans if isinstance(self.plan, Shared) else ()
        takes = all(loan.takes < len(_of_kind(answer.took, loan.kind)) for loan in loans if loan.taker == team)
        return takes and all(loan.gives < len(_of_kind(answer.gave, loan.kind)) for loan in loans if loan.giver == team)

    def exchanges(self) -> tuple[m.Exchange, ...]:
        """The exchanges of the plan as it was adopted."""
        return tuple(self._told(exchange) for exchange in self._exchanges())

    # ------------------------------------------------------------ who is asked what
    def _lenders_first(self, plan: Shared) -> dict[str, m.Adopt]:
        givers = {loan.giver for loan in plan.loans}
        roles = sorted(plan.roles)
        for group in ([team for team in roles if team in givers], [team for team in roles if team not in givers]):
            if missing := [team for team in group if team not in self.adopted]:
                return {team: self._found(plan, team) for team in missing}
        return {}

    def _found(self, plan: Shared, team: str) -> m.Adopt:
        question = m.Question(*plan.roles[team])
        if self._general:
            return m.Adopt(self._epoch, self.start, question)
        giver = next((loan.giver for loan in plan.loans if loan.taker == team), "")
        gave = self.adopted[giver].gave if giver in self.adopted else ()
        return m.Adopt(self._epoch, self.start, question, gave[0].robot if gave else giver)  # or one on the bench

    def _given(self, plan: GivenPlan, team: str) -> m.Adopt:
        steps = plan.teams.get(team, ())
        if self._general:
            return m.Adopt(self._epoch, self.start, m.Question("share", len(steps)), "", steps)
        took = next((x for x in plan.exchanges if x.taker == team), None)
        gave = any(x.giver == team for x in plan.exchanges)
        kind: Literal["alone", "lend", "borrow"] = "borrow" if took else "lend" if gave else "alone"
        return m.Adopt(self._epoch, self.start, m.Question(kind, len(steps)), took.robot if took else "", steps)

    def _welcomes(self) -> dict[str, m.Welcome]:
        """For each team that does not know yet which robots it takes."""
        coming: dict[str, dict[str, str]] = {}
        for exchange in self._exchanges():
            if not exchange.takes.robot:
                coming.setdefault(exchange.taker, {})[exchange.takes.name] = self._robot(exchange)
        return {team: m.Welcome(self._epoch, robots) for team, robots in sorted(coming.items())}

    # ------------------------------------------------------------ what is exchanged
    def _exchanges(self) -> list[_Exchange]:
        if isinstance(self.plan, Shared):
            return [self._of_loan(loan) for loan in self.plan.loans]
        found = []
        for x in self.plan.exchanges:  # as far as the plan can be followed
            takes = _named(self.adopted[x.taker].took if x.taker in self.adopted else (), x.known_as)
            gives = _named(self.adopted[x.giver].gave if x.giver in self.adopted else (), x.worker)
            if takes is not None:
                found.append(_Exchange(x.giver if gives else x.robot, gives, x.taker, takes))
        return found

    def _of_loan(self, loan: Loan) -> _Exchange:
        takes = _nth(self.adopted[loan.taker].took, loan.kind, loan.takes)
        gives = _nth(self.adopted[loan.giver].gave, loan.kind, loan.gives) if loan.giver in self.adopted else None
        return _Exchange(loan.giver, gives, loan.taker, takes)

    def _robot(self, exchange: _Exchange) -> str:
        """The name that it was built with. One that is passed on came with an exchange before."""
        if exchange.gives is None:
            return exchange.giver
        if exchange.gives.robot:
            return exchange.gives.robot
        name = exchange.gives.name
        return self._robot(next(x for x in self._exchanges() if x.taker == exchange.giver and x.takes.name == name))

    def _told(self, x: _Exchange) -> m.Exchange:
        """An exchange as it will happen. A robot from the bench was given before: its giver is part of its name."""
        robot, takes = self._robot(x), x.takes
        if x.gives is None:
            giver, _, worker = robot.partition(".")
            given = self._bench.get(robot, -1)
        else:
            giver, worker, given = x.giver, x.gives.name, x.gives.step
        return m.Exchange(worker, robot, giver, given, x.taker, takes.step, takes.name)


def _nth(hands: tuple[m.Hand, ...], kind: str, number: int) -> m.Hand:
    """That robot of the kind in the order of time."""
    return _of_kind(hands, kind)[number]


def _of_kind(hands: tuple[m.Hand, ...], kind: str) -> list[m.Hand]:
    """The published scheme names no kind."""
    return [hand for hand in hands if kind in ("", hand.kind)]


def _named(hands: tuple[m.Hand, ...], name: str) -> m.Hand | None:
    return next((hand for hand in hands if hand.name == name), None)
