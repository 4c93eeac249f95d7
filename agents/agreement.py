"""One epoch's way to a shared plan: an enquiry, questions until the search is over, then everybody adopts its part."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from agents import telling
from agents.adoption import Adoption
from agents.requests import Requests
from agents.search import Search
from agents.setups import GivenPlan
from bus import messages as m
from bus.node import Node
from reasoning.loans import Market
from reasoning.sharing import Asking, Shared
from reasoning.words import count


class Waiting(NamedTuple):
    """Somebody has to answer before it goes on; `doing` says what about."""

    doing: str


class NoPlan(NamedTuple):
    """The search has ended without a plan."""

    reason: str


class Refused(NamedTuple):
    """A team cannot adopt its part of the plan."""

    reason: str


Progress = Adoption | Waiting | NoPlan | Refused
"""How far it has come; an `Adoption` is complete."""


class Agreement:
    """From how the teams stand to a plan that all of them have adopted. `standings` are the answers to the enquiry;
    `adoption` is there once a plan is found or given. With a `market` sharing is general."""

    def __init__(self, node: Node, requests: Requests, epoch: int, delay: int, market: Market | None = None) -> None:
        self.standings: dict[str, m.Standing] = {}
        self.search = Search({}, delay, 0)
        self.adoption: Adoption | None = None
        self._node, self._requests = node, requests
        self._epoch, self._delay, self._market, self._step = epoch, delay, market, 0

    def enquire(self, teams: Iterable[str]) -> None:
        for team in sorted(teams):
            self._requests.send(team, m.Enquire(self._epoch))

    def stands(self, team: str, standing: m.Standing) -> bool:
        """Has everybody answered the enquiry now?"""
        self.standings[team] = standing
        return not self._requests

    @property
    def suspicious(self) -> set[str]:
        """Teams that must look at a robot first."""
        return {team for team, standing in self.standings.items() if standing.inspect}

    def begin(self, step: int, cause: str, given: GivenPlan | None) -> Progress:
        """Search a plan from global step `step` on, or take the given one."""
        text = f"searching a shared plan from step {step} on: {cause}"
        self._node.emit("search_started", text, epoch=self._epoch, step=step, reason=cause)
        self._step = step
        self.search = Search(self.standings, self._delay, step, self._market)
        return self._search_on() if given is None else self._adopt(given)

    def answered(self, team: str, answer: m.Answer) -> Progress:
        self.search.learn(team, answer)
        telling.answered(self._node, team, answer)
        return self._search_on()

    def _search_on(self) -> Progress:
        """Ask what the search wants to know next, at most one question a team at a time."""
        before = (self.search.bound, self.search.best)
        result = self.search.next()
        if (self.search.bound, self.search.best) != before:
            telling.bounds(self._node, self._epoch, self.search)
        if isinstance(result, Asking):
            for team, q in sorted(result.questions.items()):
                if team not in self._requests:
                    self.search.asked += 1
                    self._requests.send(team, m.Ask(self._epoch, m.Question(*q)))
            return Waiting(f"asking about {count(result.within, 'step')}")
        if result.status in ("optimal", "feasible"):
            return self._adopt(result)
        return NoPlan("; ".join(filter(None, [result.proof, *self.search.hopeless()])))

    def _adopt(self, plan: Shared | GivenPlan) -> Progress:
        """Have a plan adopted that the search has found, or that is given instead."""
        self._requests.withdraw_all()  # questions whose answers are not needed any more
        general = self._market is not None
        self.adoption = Adoption(plan, self._epoch, self._step, self.standings, self.search.given, general=general)
        return self._adopt_more(self.adoption)

    def adopted(self, team: str, answer: m.Adopted) -> Progress:
        assert self.adoption is not None, "nobody was asked to adopt anything"
        if not answer.ok:
            return Refused(f"{team} cannot adopt its plan: {answer.reason}")
        if not self.adoption.counted_on(team, answer):
            return Refused(f"{team} cannot adopt its plan: it exchanges fewer robots than promised")
        self.adoption.adopted[team] = answer
        return self._adopt_more(self.adoption)

    def _adopt_more(self, adoption: Adoption) -> Progress:
        missing = {} if self._requests else adoption.missing()
        for team, body in missing.items():
            self._requests.send(team, body)
        return Waiting("having its plan adopted") if self._requests else adoption
