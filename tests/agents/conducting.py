"""A coordinator among teams that the test speaks for."""

from __future__ import annotations

from typing import Any

from bus import messages as m
from bus.messages import Envelope
from tests.agents.conftest import MakeSystem
from tests.agents.rooms import ALONE
from tests.agents.together import System

T1, T2 = "T1", "T2"


class Stage:
    """A coordinator and two teams that the test speaks for."""

    def __init__(self, make_system: MakeSystem, **options: Any) -> None:
        self.system: System = make_system({T1: ALONE, T2: ALONE}, puppets=(T1, T2), **options)
        self.system.tick()

    @property
    def epoch(self) -> int:
        return self.system.coordinator.diary.epoch

    def hear(self, team: str, kind: type[m.Body]) -> Envelope:
        """The request of this kind in the present epoch; those of earlier ones are left unanswered."""
        puppet = self.system.puppet(team)
        self.system.until(lambda: any(isinstance(e.body, kind) and e.body.epoch == self.epoch for e in puppet.mail))
        puppet.mail = [e for e in puppet.mail if not isinstance(e.body, kind) or e.body.epoch == self.epoch]
        return puppet.take(kind)

    def reply(self, team: str, to: Envelope, body: m.Body) -> None:
        self.system.puppet(team).node.reply(to, body)
        self.system.tick()
        self.system.tick()

    def stands(self, team: str, **more: Any) -> None:
        asked = self.hear(team, m.Enquire)
        assert asked.body.epoch == self.epoch
        standing = {"step": 0, "finished": False, "lower_bound": 3, **more}
        self.reply(team, asked, m.Standing(self.epoch, team, **standing))

    def offers(self, team: str, **more: Any) -> None:
        self.stands(team, offer=m.Offer(m.Question("alone", 4), (m.Question("alone", 3),)), **more)

    def adopts(self, team: str, makespan: int = 4, ok: bool = True, reason: str = "") -> None:
        self.reply(team, self.hear(team, m.Adopt), m.Adopted(self.epoch, team, ok, makespan, reason=reason))

    def steps(self, team: str, outcome: Any = "as_planned", **more: Any) -> None:
        go = self.hear(team, m.Go)
        self.reply(team, go, m.StepResult(self.epoch, team, go.body.step, outcome, **more))

    def contact(self, team: str, state: Any) -> None:
        """The world tells, and the coordinator has heard it."""
        self.system.contact(team, state)
        self.system.until(lambda: (team in self.system.coordinator.members.live) is (state == "back"))

    def to(self, phase: str) -> None:
        """Both teams are on course; go on to this phase, in which they have been asked and nobody has answered."""
        if phase != "enquiring":
            self.stands(T1) if phase == "asking" else self.offers(T1)
            self.stands(T2) if phase == "asking" else self.offers(T2)
        if phase in ("stepping", "recovering"):
            self.adopts(T1)
            self.adopts(T2)
        if phase == "recovering":
            self.steps(T1, "discrepancy", inspect=("w1",))
            self.steps(T2)
        assert self.system.coordinator.phase == phase
