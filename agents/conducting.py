"""Conducting the steps: which one comes next, who has reported it, and who has no more to do."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from agents.adoption import Adoption
from agents.requests import Requests
from bus.messages import Go, Standing, StepResult


class Conducting:
    """`step` is the global step that comes next, or is under way; `finished` are the teams that have reached their
    goal."""

    def __init__(self, requests: Requests) -> None:
        self._requests = requests
        self.step = 0
        self.finished: set[str] = set()
        self._results: dict[str, StepResult] = {}

    def take_stock(self, standings: Mapping[str, Standing]) -> None:
        """Go on from where the teams stand."""
        self.step = max(standing.step for standing in standings.values())
        self.finished = {team for team, standing in standings.items() if standing.finished}

    def start(self, adoption: Adoption, standings: Mapping[str, Standing]) -> None:
        """A plan was adopted: who has none left to do, and has reached its goal, is done."""
        self.finished = {t for t, a in adoption.adopted.items() if not a.makespan and standings[t].finished}

    def go(self, epoch: int, teams: Iterable[str], *, recover: bool = False) -> bool:
        """Have these teams take the step, or their inspections; was there any team?"""
        self._results = {}
        for team in sorted(teams):
            self._requests.send(team, Go(epoch, self.step, recover))
        return bool(self._requests)

    def stop(self) -> None:
        """The step under way is of no interest any more."""
        self._results = {}

    def learn(self, team: str, result: StepResult) -> None:
        self._results[team] = result
        if result.outcome == "finished":
            self.finished.add(team)

    def end(self) -> None:
        """Everybody who was asked has reported: a step that anybody took is over."""
        if self._results:
            self.step += 1

    @property
    def suspicious(self) -> set[str]:
        """Teams that must look at a robot."""
        return {team for team, result in self._results.items() if result.inspect}

    @property
    def odd(self) -> list[str]:
        """Teams that have left their course."""
        return sorted(t for t, result in self._results.items() if result.outcome not in ("as_planned", "finished"))
