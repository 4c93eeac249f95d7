"""The coordinator's knowledge during one search: a ledger for each team, the bench, and how much was asked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from msgspec.structs import astuple

from bus import messages as m
from reasoning import exchanges
from reasoning.horizons import Trail
from reasoning.loans import Market, Waiting
from reasoning.sharing import Asking, Known, Ledger, Shared, advance
from reasoning.values import Question


class Search:
    """From the teams' standings at global step `start` to the shared plan; steps inside count from `start`."""

    def __init__(
        self, standings: Mapping[str, m.Standing], delay: int, start: int, market: Market | None = None
    ) -> None:
        self.asked = 0
        self.bound = self.best = -1
        waiting = _on_bench(standings)
        self.given = {robot: hand.step for robot, (_, hand) in waiting.items()}
        self._delay = delay
        self._bench = {robot: max(at + delay - start, 0) for robot, at in self.given.items()}
        bench = {robot: Waiting(hand.kind, team, hand.step - start) for robot, (team, hand) in waiting.items()}
        self._market = None if market is None else replace(market, bench=bench)
        self._trail: Trail | None = None
        lenders = len(standings) > 1 or bool(self._bench)
        self._ledgers = {team: _ledger(s, lenders) for team, s in standings.items()}
        self._hopeless = {team: s.hopeless for team, s in standings.items() if s.hopeless}

    def learn(self, team: str, answer: m.Answer) -> None:
        question = Question(*astuple(answer.easiest or answer.question))
        self._ledgers[team] = self._ledgers[team].learn(
            Known(question, answer.verdict, answer.finish, answer.at, answer.conflicts, answer.gave, answer.took)
        )

    def next(self) -> Asking | Shared:
        """What to ask next. A search under the published limits looks at everything anew; a general one goes on."""
        if self._market is None:
            result = advance(self._ledgers, self._delay, self._bench)
        else:
            result = exchanges.advance(self._ledgers, self._market, trail=self._trail)
            self._trail = result.trail if isinstance(result, Asking) else None
        # What was proved once stays so, even where the search now looks at a shorter horizon.
        self.bound = max(self.bound, result.low if isinstance(result, Asking) else result.lower_bound)
        self.best = (result.high or -1) if isinstance(result, Asking) else result.makespan
        return result

    def hopeless(self) -> list[str]:
        """Why teams can never finish alone, in words."""
        return [f"{team}: {why}" for team, why in sorted(self._hopeless.items())]


def _ledger(standing: m.Standing, lenders: bool) -> Ledger:
    can_borrow = lenders and not standing.hopeless_with_guest
    ledger = Ledger(standing.lower_bound, (), not standing.hopeless, can_borrow, standing.stock)
    offer = standing.offer
    if offer is None:
        return ledger
    q = Question(*astuple(offer.question))
    refuted = (Known(Question(*astuple(r)), "no") for r in offer.refuted)
    known = Known(q, "yes", q.within, q.step, 0, q.gives, q.takes)
    return replace(ledger.learn(known, *refuted), offer=known)


def _on_bench(standings: Mapping[str, m.Standing]) -> dict[str, tuple[str, m.Handover]]:
    """Robots that were given and not taken since, with the team that gave them last and when."""
    given: dict[str, tuple[str, m.Handover]] = {}
    taken: dict[str, int] = {}
    for team, standing in standings.items():
        for h in standing.gave:
            if h.robot not in given or h.step >= given[h.robot][1].step:
                given[h.robot] = team, h
        for h in standing.took:
            taken[h.robot] = max(h.step, taken.get(h.robot, -1))
    return {robot: hand for robot, hand in sorted(given.items()) if hand[1].step > taken.get(robot, -1)}
