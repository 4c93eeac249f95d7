"""Who asks why: one budget of time for the teams' planners and for the search of clashes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

from bus.clock import wall_s
from ops.whysubjects import Subject
from reasoning.domain import Domain
from reasoning.planner import Planner
from reasoning.reasons import Make
from reasoning.values import Question
from reasoning.why import Clash, Possible, Unknown, explain

Progress = Callable[[str], None]


class EndedError(Exception):
    """The time was over before what the question needs was known."""


@dataclass(frozen=True)
class Part:
    """`claim` is what is explained, `result` why. `possible` is what to say if there is nothing to explain. `domain` is
    None for the coordinator's question. `first` is the plan's step that the program calls 0. `notes` say what the
    members do not."""

    claim: str
    result: Clash | Possible | Unknown
    possible: str
    domain: Domain | None
    notes: tuple[str, ...] = ()
    first: int = 0

    @property
    def answered(self) -> bool:
        return isinstance(self.result, Clash) and self.result.checked


@dataclass
class Asker:
    """Who asks: `seconds` from `began` are what all questions may take together."""

    subject: Subject
    seconds: float
    progress: Progress
    began: float
    planners: dict[str, Planner] = field(default_factory=dict)

    def left_s(self) -> float:
        return max(self.seconds - (wall_s() - self.began), 0.0)

    def part(
        self,
        claim: str,
        make: Make,
        possible: str,
        *notes: str,
        shared: bool = False,
        seconds: float | None = None,
        first: int = 0,
    ) -> Part:
        """Put one question, within `seconds` if these are fewer than are left. The rest is as `Part` has it."""
        self.progress(claim)
        left = self.left_s() if seconds is None else min(seconds, self.left_s())
        result = explain(make, seconds=left, clock=wall_s, on_progress=self.progress)
        return Part(claim, result, possible, None if shared else self.subject.domain, notes, first)

    def can(self, team: str, kind: Literal["alone", "lend", "borrow"], within: int, step: int = 0) -> bool:
        """A team's answer. Raises `EndedError`."""
        if team not in self.planners:
            self.planners[team] = Planner(self.subject.problem(team), clock=wall_s)
        self.progress(f"{team}: {kind} within {within} steps, step {step}")
        answer = self.planners[team].answer(Question(kind, within, step), seconds=self.left_s())
        if answer.verdict == "unknown":
            raise EndedError(f"{team} had not answered whether it can {kind} within {within} steps")
        return answer.verdict == "yes"
