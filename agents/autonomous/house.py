"""The coordinator of teams that act for themselves. It allocates nothing: it has them begin, tells them who is in
contact, passes on changed orders, and ends the run when everybody is at rest.
"""

from __future__ import annotations

from typing import Any

import msgspec
from msgspec.structs import asdict, replace

from agents import telling
from agents.membership import Membership
from agents.requests import Requests
from agents.setups import CoordinatorSetup
from bus import keys
from bus import messages as m
from bus.messages import Envelope
from bus.node import Node

_KEY = "house"


class Ledger(msgspec.Struct, frozen=True):
    """What must not be forgotten. `orders` are changes that their teams have not heard of, by their numbers; `ordered`
    counts all of them, `told` the news of who is in contact, `epoch` the enquiries; `lost` are teams out of contact,
    `stopped` those that will never come back, `rests` the latest reports; `over` is the last word, once it is said."""

    orders: dict[int, m.Order] = {}
    ordered: int = 0
    told: int = 0
    epoch: int = 0
    lost: tuple[str, ...] = ()
    stopped: tuple[str, ...] = ()
    rests: dict[str, m.AtRest] = {}
    over: m.RunOver | None = None


class House:
    """Reacts to one message at a time."""

    def __init__(self, node: Node, setup: CoordinatorSetup) -> None:
        self.node, self.setup = node, setup
        kept = node.journal.get(_KEY)
        self.ledger = Ledger() if kept is None else msgspec.msgpack.decode(kept, type=Ledger)
        self.members = Membership(setup.teams, self.ledger.lost)
        self.enquiry = Requests(node)
        self._standings: dict[str, m.Standing] = {}
        self._ordering: dict[str, str] = {}
        self._first_word = telling.FirstWord(node, "coordinator")
        if self.ledger.over is not None:
            self._last_word(self.ledger.over)

    def turn(self, mail: tuple[Envelope, ...]) -> None:
        if self._first_word.tell() and self.ledger.over is None:
            self._tell_all()
            self._pass_on()
            self._take_stock()
        for envelope in mail:
            if envelope.re:
                if self._ordering.get(envelope.src) == envelope.re:
                    self._ordered(envelope.src)
                elif self.enquiry.settle(envelope) and isinstance(envelope.body, m.Standing):
                    self._stands(envelope.body)
            elif isinstance(envelope.body, m.AtRest) and envelope.src in self.members.teams:
                self._rests(envelope, envelope.body)
            elif envelope.src != keys.WORLD:
                self.node.refuse(envelope, "not_yours")
            else:
                self._told(envelope)

    # ------------------------------------------------------------ who is there
    def _told(self, envelope: Envelope) -> None:
        """News from the world: somebody was lost or is back, or an order changed."""
        with self.node.journal.transaction():
            change = self._take_in(envelope)
        body = envelope.body
        if self.ledger.over is not None:
            return
        if isinstance(body, m.Contact) and change:
            if body.name in self.members.lost:
                self.enquiry.withdraw(body.name)
            self._tell_all()
            self._take_stock()
        elif isinstance(body, m.Order):
            self._pass_on()

    def _take_in(self, envelope: Envelope) -> bool:
        """Note news together with the reply to it; has contact with a team changed?"""
        body, number = envelope.body, self.ledger.ordered + 1
        if isinstance(body, m.Order) and body.team in self.members.teams:
            self._note(orders={**self.ledger.orders, number: body}, ordered=number)
        gone = isinstance(body, m.Contact) and body.state == "stopped" and body.name in self.members.teams
        if isinstance(body, m.Contact) and (gone or body.state != "lost_contact"):
            others = {*self.ledger.stopped} - {body.name}
            self._note(stopped=tuple(sorted(others | {body.name} if gone else others)))
        return bool(self.members.take_in(self.node, envelope, self._note)) or gone

    def _pass_on(self) -> None:
        """Tell each team of the first change that it has not heard of: one after the other, since the latest counts.
        The ids are the orders' own, so that each is taken in once whatever dies meanwhile."""
        for number, order in self.ledger.orders.items():
            if order.team not in self._ordering:
                name = f"{self.node.name}.order.{number}"
                self._ordering[order.team] = self.node.request(order.team, order, request_id=name)

    def _ordered(self, team: str) -> None:
        """A team knows of the change."""
        del self._ordering[team]
        heard = next(number for number, order in self.ledger.orders.items() if order.team == team)
        self._note(orders={number: order for number, order in self.ledger.orders.items() if number != heard})
        self._pass_on()
        if self.ledger.over is None:
            self._take_stock()

    def _tell_all(self) -> None:
        """Have everybody begin who has not, and know who is in contact."""
        self._note(told=self.ledger.told + 1)
        for team in sorted(self.members.live):
            self.node.request(team, m.Present(self.ledger.told, tuple(sorted(self.members.live)), self.ledger.stopped))
        self._show("waiting for the teams to come to rest")

    # ------------------------------------------------------------ who has come to rest
    def _rests(self, envelope: Envelope, report: m.AtRest) -> None:
        known = self.ledger.rests.get(envelope.src)
        with self.node.journal.transaction():
            if known is None or known.number < report.number:
                self._note(rests={**self.ledger.rests, envelope.src: report})
            self.node.reply(envelope, m.Ok())
        if self.ledger.over is None:
            self._take_stock()

    def _take_stock(self) -> None:
        """When all have reported but those that will never come back: are they all still at rest, and nobody's robot
        elsewhere?"""
        live = self.members.live
        awaited = self._ordering.keys() & live or set(self.members.lost) - {*self.ledger.stopped}
        if self.enquiry or awaited or not live <= set(self.ledger.rests):
            return
        self._note(epoch=self.ledger.epoch + 1)
        self._standings = {}
        for team in sorted(live):
            self.enquiry.send(team, m.Enquire(self.ledger.epoch))
        if not live:
            self._finish()

    def _stands(self, standing: m.Standing) -> None:
        self._standings[standing.team] = standing
        live = self.members.live
        if self.enquiry or self._ordering.keys() & live or not live <= set(self._standings):
            return
        if all(each.finished for each in self._standings.values()):
            self._finish()

    def _finish(self) -> None:
        """The last word: the goal is reached if nothing is left untidy, no deadline was missed, and nobody has gone."""
        rests, gone = self.ledger.rests, self.ledger.stopped
        left = [
            f"{team} leaves {n} as it is: {why}" for team, r in sorted(rests.items()) for n, why in r.untidy.items()
        ]
        late = [f"{team} missed its deadline" for team, r in sorted(rests.items()) if r.late]
        stopped = [f"{team} was stopped, and nobody knows how its room is" for team in gone]
        reason = "; ".join([*stopped, *left, *late]) or "every team has reached its goal"
        makespan = max((rest.steps for rest in rests.values()), default=0)
        replans = sum(max(rest.plans - 1, 0) for rest in rests.values())
        over = m.RunOver(not (stopped or left or late), reason[:2000], makespan, replans)
        with self.node.journal.transaction():
            self._note(over=over)
            self.node.emit("run_over", over.reason, **asdict(over))
            self.node.journal.afterwards(lambda: self._last_word(over))

    def _last_word(self, over: m.RunOver) -> None:
        self.node.request("supervisor", over)
        self._show("done" if over.goal else "not everything is tidy")

    # ------------------------------------------------------------ plumbing
    def _note(self, **changed: Any) -> None:
        self.ledger = replace(self.ledger, **changed)
        self.node.journal.put(_KEY, msgspec.msgpack.encode(self.ledger))

    def _show(self, doing: str) -> None:
        steps = max((rest.steps for rest in self.ledger.rests.values()), default=0)
        self.node.status(m.Status("coordinator", doing, steps, finished=self.ledger.over is not None))
