"""The coordinator's knowledge during one search: a ledger for each team, the bench, and how much was asked."""

from __future__ import annotations

from collections.abc import Mapping

from bus import messages as m
from reasoning.sharing import Asking, Known, Ledger, Shared, advance
from reasoning.values import Question


class Search:
    """From the teams' standings at global step `start` to the shared plan; steps inside count from `start`."""

    def __init__(self, standings: Mapping[str, m.Standing], delay: int, start: int) -> None:
        self.asked = 0
        self.bound = self.best = -1
        self.given = _on_bench(standings)
        self._delay = delay
        self._bench = {robot: max(at + delay - start, 0) for robot, at in self.given.items()}
        lenders = len(standings) > 1 or bool(self._bench)
        self._ledgers = {team: _ledger(s, lenders) for team, s in standings.items()}
        self._hopeless = {team: s.hopeless for team, s in standings.items() if s.hopeless}

    def learn(self, team: str, answer: m.Answer) -> None:
        question = Question(answer.question.kind, answer.question.within, answer.question.step)
        self._ledgers[team] = self._ledgers[team].learn(
            Known(question, answer.verdict, answer.finish, answer.at, answer.conflicts)
        )

    def next(self) -> Asking | Shared:
        result = advance(self._ledgers, self._delay, self._bench)
        # What was proved once stays so, even where the search now looks at a shorter horizon.
        self.bound = max(self.bound, result.low if isinstance(result, Asking) else result.lower_bound)
        self.best = (result.high or -1) if isinstance(result, Asking) else result.makespan
        return result

    def hopeless(self) -> list[str]:
        """Why teams can never finish alone, in words."""
        return [f"{team}: {why}" for team, why in sorted(self._hopeless.items())]


def _ledger(standing: m.Standing, lenders: bool) -> Ledger:
    can_borrow = lenders and not standing.hopeless_with_guest
    ledger = Ledger(standing.lower_bound, (), not standing.hopeless, can_borrow)
    offer = standing.offer
    if offer is None:
        return ledger
    q = Question(offer.question.kind, offer.question.within, offer.question.step)
    refuted = (Known(Question(r.kind, r.within, r.step), "no") for r in offer.refuted)
    return ledger.learn(Known(q, "yes", q.within, q.step), *refuted)


def _on_bench(standings: Mapping[str, m.Standing]) -> dict[str, int]:
    """Robots that were given and not taken since, with the global step of their giving."""
    given: dict[str, int] = {}
    taken: dict[str, int] = {}
    for standing in standings.values():
        for h in standing.gave:
            given[h.robot] = max(h.step, given.get(h.robot, -1))
        for h in standing.took:
            taken[h.robot] = max(h.step, taken.get(h.robot, -1))
    return {robot: step for robot, step in sorted(given.items()) if step > taken.get(robot, -1)}
