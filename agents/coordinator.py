"""The coordinator: ``python -m agents.coordinator``. It makes the teams share their robots and conducts the steps.

It knows the teams' names and their answers, never their models. Whenever something changes - a discrepancy, an order,
a team lost or back, its own return - a new *epoch* begins: everybody says how it stands, the search for the shared
plan starts from what is known (`reasoning.sharing`), plans are adopted, and steps go on. Between two steps nothing is
ever half done.
"""

from __future__ import annotations

import sys
from typing import Any, Literal

from msgspec.structs import asdict, replace

from agents import diary as diaries
from agents import telling
from agents.adoption import Adoption
from agents.agreement import Agreement, NoPlan, Progress, Refused, Waiting
from agents.autonomous.house import House
from agents.conducting import Conducting
from agents.membership import Membership
from agents.requests import Requests
from agents.setups import CoordinatorSetup, GivenPlan, read
from bus import keys
from bus import messages as m
from bus.messages import Envelope
from bus.node import Node, arguments, open_node

Phase = Literal["enquiring", "asking", "adopting", "stepping", "recovering", "over"]
REFUSALS = 3
"""After so many plans in a row that a team could not adopt, the search would only find them again."""


class Coordinator:
    """Reacts to one message at a time. What it has asked is in `requests`, where the run stands in `steps`, how
    far the present epoch has come to a plan in `agreement`."""

    def __init__(self, node: Node, setup: CoordinatorSetup) -> None:
        self.node, self.setup = node, setup
        self.diary = diaries.load(node.journal)
        self.members = Membership(setup.teams, self.diary.lost)
        self.cause = ""
        self.phase: Phase = "enquiring"
        self.requests = Requests(node)
        self.steps = Conducting(self.requests)
        self.agreement = Agreement(node, self.requests, 0, setup.delay, setup.market())
        self.exchanges: tuple[m.Exchange, ...] = ()
        self._reason, self._refusals = "", 0
        self._first_word = telling.FirstWord(node, "coordinator")
        if self.diary.over is not None:
            self._last_word(self.diary.over)
        else:
            self._begin("the coordinator is back" if self.diary.epoch else "start")

    # ------------------------------------------------------------ turns
    def turn(self, mail: tuple[Envelope, ...]) -> None:
        self._first_word.tell()
        for envelope in mail:
            if envelope.re:
                if self.requests.settle(envelope):
                    self._answered(envelope.src, envelope.body)
            elif envelope.src != keys.WORLD:
                self.node.refuse(envelope, "not_yours")
            else:
                self._told(envelope)

    def _told(self, envelope: Envelope) -> None:
        """News from the world: somebody was lost or is back, or an order changed."""
        body = envelope.body
        change = self.members.take_in(self.node, envelope, self._note)
        if self.phase == "over":
            return
        if isinstance(body, m.Contact) and change:
            if body.name in self.members.lost:
                self.requests.withdraw(body.name)
            self._changed(change)
        elif isinstance(body, m.Order):
            self._changed(f"the order of {body.team} changed")

    def _changed(self, reason: str) -> None:
        """Something is new: at the end of the step under way, or at once, a new epoch begins."""
        self._reason = self._reason or reason
        if self.phase in ("stepping", "recovering"):
            self._step_over()
        else:
            self._begin(reason)

    def _answered(self, team: str, body: m.Body) -> None:
        match body:
            case m.Standing() | m.Answer() | m.Adopted() if body.epoch != self.diary.epoch:
                # One of us has lost its memory: begin where nobody has been.
                self._note(epoch=max(body.epoch, self.diary.epoch))
                self._begin(f"{team} was in epoch {body.epoch}")
            case m.Standing() if self.phase == "enquiring":
                if self.agreement.stands(team, body):
                    self._take_stock()
            case m.Answer() if self.phase == "asking":
                self._agree(self.agreement.answered(team, body))
            case m.Adopted() if self.phase == "adopting":
                self._agree(self.agreement.adopted(team, body))
            case m.StepResult() if self.phase in ("stepping", "recovering"):
                self.steps.learn(team, body)
                self._step_over()
            case _:
                pass

    # ------------------------------------------------------------ an epoch begins
    def _begin(self, reason: str) -> None:
        self.requests.withdraw_all()
        self.steps.stop()
        self._reason = ""
        self._note(epoch=self.diary.epoch + 1)
        self.phase, self.cause = "enquiring", reason
        self.agreement = Agreement(self.node, self.requests, self.diary.epoch, self.setup.delay, self.setup.market())
        self.agreement.enquire(self.members.live)
        self._show("asking how everybody stands")

    def _take_stock(self) -> None:
        self.steps.take_stock(self.agreement.standings)
        if self.agreement.suspicious:
            self._inspect(self.agreement.suspicious)
        elif self.diary.plans and self.steps.finished == self.members.teams:
            self._next_step()
        else:
            self._agree(self.agreement.begin(self.steps.step, self.cause, self._given()))

    def _given(self) -> GivenPlan | None:
        """The given plan, as long as it has its chance."""
        return None if self.diary.tried else self.setup.plan

    def _agree(self, progress: Progress) -> None:
        self.phase = "adopting" if self.agreement.adoption else "asking"
        match progress:
            case Waiting(doing):
                self._show(doing)
            case Adoption():
                self._start(progress)
            case NoPlan() if self.members.lost:  # whoever is lost may have what the others need
                self._show("no plan without those who are lost; waiting for " + ", ".join(self.members.lost))
            case NoPlan(reason):
                self._no_plan(reason, "no_plan")
            case Refused(reason):
                self._refused(reason)

    def _refused(self, reason: str) -> None:
        """A plan cannot be adopted: search another one, unless that has led nowhere before."""
        if self._given() is not None:
            self._note(tried=True)
        else:
            self._refusals += 1
        if self._refusals < REFUSALS:
            self._begin(reason)
        else:
            self._no_plan(reason, "plan_refused")

    def _start(self, adoption: Adoption) -> None:
        """Everybody has adopted the plan."""
        self._refusals = 0
        self.exchanges = adoption.exchanges()
        with self.node.journal.transaction():
            self._note(plans=self.diary.plans + 1, tried=True)
            telling.adopted(self.node, self.diary.epoch, adoption, self.agreement.search.asked, self.exchanges)
        self.phase = "stepping"
        self.steps.start(adoption, self.agreement.standings)
        self._next_step()

    # ------------------------------------------------------------ conducting
    def _next_step(self) -> None:
        if self.steps.go(self.diary.epoch, self.members.live - self.steps.finished):
            self._show("conducting")
        elif self.members.lost:
            self._show("waiting for " + ", ".join(self.members.lost))
        else:
            self._finish(m.RunOver(True, "every team has reached its goal", self.steps.step, self.diary.replans))

    def _inspect(self, teams: set[str]) -> None:
        """One more step for those that must look at a suspect; the others wait."""
        self.phase = "recovering"
        self.steps.go(self.diary.epoch, teams & self.members.live, recover=True)
        self._show("waiting for inspections of " + ", ".join(sorted(teams)))

    def _step_over(self) -> None:
        """When everybody has reported: on with the next step, inspections, or a new epoch."""
        if self.requests:
            return
        self.steps.end()
        odd = ", ".join(self.steps.odd)
        if suspicious := self.steps.suspicious & self.members.live:
            self._reason = self._reason or f"{odd} met a discrepancy"
            self._inspect(suspicious)
        elif self.phase == "recovering" or odd or self._reason:
            self._begin(self._reason or f"{odd} left its course")
        else:
            self._next_step()

    # ------------------------------------------------------------ the end
    def _no_plan(self, why: str, cause: Literal["no_plan", "plan_refused"]) -> None:
        over = m.RunOver(False, f"no plan: {why}"[:2000], self.steps.step, self.diary.replans)
        with self.node.journal.transaction():
            telling.no_plan(self.node, why, cause)
            self._finish(over)

    def _finish(self, over: m.RunOver) -> None:
        with self.node.journal.transaction():
            self._note(over=over)
            self.node.emit("run_over", over.reason, **asdict(over))
            self.node.journal.afterwards(lambda: self._last_word(over))

    def _last_word(self, over: m.RunOver) -> None:
        self.phase = "over"
        self.node.request("supervisor", over)
        self._show("done" if over.goal else "no plan")

    # ------------------------------------------------------------ plumbing
    def _note(self, **changed: Any) -> None:
        self.diary = replace(self.diary, **changed)
        diaries.save(self.node.journal, self.diary)

    def _show(self, doing: str) -> None:
        over, step, epoch = self.phase == "over", self.steps.step, self.diary.epoch
        self.node.status(telling.status(doing, step, epoch, over, self.agreement.search, self.exchanges))


def main() -> int:
    config = arguments(sys.argv[1:])
    setup = read(config, CoordinatorSetup)
    with open_node(config) as node:
        coordinator = (Coordinator if setup.conducted else House)(node, setup)
        for turn in node.turns():
            coordinator.turn(turn.mail)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
