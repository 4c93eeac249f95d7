"""A shared plan on its way to the teams: who is asked to adopt what, in which order, and what is exchanged then."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Literal

from agents.setups import GivenPlan
from bus import messages as m
from reasoning.sharing import Loan, Shared


class Adoption:
    """One plan from global step `start` on, found by the search or given. `bench` holds the robots there, with the
    global step of their giving."""

    def __init__(
        self, plan: Shared | GivenPlan, epoch: int, start: int, teams: Iterable[str], bench: Mapping[str, int]
    ) -> None:
        self.plan, self.start = plan, start
        self.adopted: dict[str, m.Adopted] = {}
        self._epoch, self._teams, self._bench = epoch, sorted(teams), bench

    @property
    def makespan(self) -> int:
        """Steps until the last team is done."""
        return max((a.makespan for a in self.adopted.values()), default=0)

    def missing(self) -> dict[str, m.Adopt]:
        """What to ask of whom next; nothing when all have adopted. Lenders come first: they say which robot they
        give, which their borrowers must know. A given plan says so itself."""
        if isinstance(self.plan, GivenPlan):
            return {team: self._given(self.plan, team) for team in self._teams if team not in self.adopted}
        givers = {loan.giver for loan in self.plan.loans}
        roles = sorted(self.plan.roles)
        for group in ([team for team in roles if team in givers], [team for team in roles if team not in givers]):
            if missing := [team for team in group if team not in self.adopted]:
                return {team: self._found(self.plan, team) for team in missing}
        return {}

    def exchanges(self) -> tuple[m.Exchange, ...]:
        """The exchanges of the plan as it was adopted."""
        if isinstance(self.plan, Shared):
            loans = self.plan.loans
        else:
            within_reach = {team for team, adopted in self.adopted.items() if adopted.at >= 0}
            loans = tuple(Loan(x.giver, x.taker) for x in self.plan.exchanges if x.taker in within_reach)
        return tuple(self._exchange(loan) for loan in loans)

    def _found(self, plan: Shared, team: str) -> m.Adopt:
        giver = next((loan.giver for loan in plan.loans if loan.taker == team), "")
        guest = self.adopted[giver].robot if giver in self.adopted else giver  # by the name it was built with
        return m.Adopt(self._epoch, self.start, m.Question(*plan.roles[team]), guest)

    def _given(self, plan: GivenPlan, team: str) -> m.Adopt:
        steps = plan.teams.get(team, ())
        took = next((x for x in plan.exchanges if x.taker == team), None)
        gave = any(x.giver == team for x in plan.exchanges)
        kind: Literal["alone", "lend", "borrow"] = "borrow" if took else "lend" if gave else "alone"
        return m.Adopt(self._epoch, self.start, m.Question(kind, len(steps)), took.robot if took else "", steps)

    def _exchange(self, loan: Loan) -> m.Exchange:
        """An exchange as it will happen. A robot from the bench was given before: its giver is part of its name."""
        taken = self.adopted[loan.taker]
        given = self.adopted.get(loan.giver)
        robot = given.robot if given else loan.giver
        giver, _, worker = robot.partition(".")
        return m.Exchange(
            given.worker if given else worker,
            robot,
            loan.giver if given else giver,
            given.at if given else self._bench.get(robot, -1),
            loan.taker,
            taken.at,
            taken.worker,
        )
