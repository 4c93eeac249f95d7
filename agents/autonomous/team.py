"""The mind of a team that acts for itself: a thin loop that joins the pure core to the bus.

It observes, plans, acts, finds out why the room is not as planned, recovers, helps other teams and asks them for help.
The coordinator tells it to begin, and hears when it is at rest.
"""

from __future__ import annotations

from agents import telling
from agents.autonomous.acting import Acting
from agents.autonomous.mind import COORDINATOR, Mind
from agents.setups import TeamSetup
from agents.thinker import Thinker
from bus import messages as m
from bus.messages import Envelope
from bus.node import Node


class Autonomous:
    """Reacts to one message at a time. Every request that it answers may come again; every answer is journalled."""

    def __init__(self, node: Node, setup: TeamSetup, thinker: Thinker) -> None:
        self.mind = Mind(node, setup, thinker)
        self.acting = Acting(self.mind)
        self._first_word = telling.FirstWord(node, "team")
        self.mind.show("waiting to begin" if self.mind.memory.peers is None else "back at work")

    def turn(self, mail: tuple[Envelope, ...]) -> None:
        if self._first_word.tell():
            self.acting.resume()
        for envelope in mail:
            if envelope.re:
                self.mind.hear(envelope)
            else:
                self._asked(envelope)
        self.mind.thinker.deliver()
        self.acting.go_on()

    def _asked(self, envelope: Envelope) -> None:
        node, acting = self.mind.node, self.acting
        match envelope.body:
            case m.Present() | m.Order() | m.Enquire() if envelope.src != COORDINATOR:
                node.refuse(envelope, "not_yours")
            case m.Present() as present:
                acting.helpers.present(present)
                node.reply(envelope, m.Ok())
            case m.Order() as order:
                with node.journal.transaction():
                    acting.ordered(order)
                    node.reply(envelope, m.Ok())
                acting.go_on()
            case m.Enquire(epoch):
                now = self.mind.memory
                node.reply(envelope, m.Standing(epoch, self.mind.team, now.step, acting.finished, 0))
            case m.HelpCall() as call:
                acting.helpers.called(envelope, call)
            case m.HelpSettled() as settled:
                acting.helpers.settled(envelope, settled)
            case m.RobotSent() as sent:
                acting.helpers.sent(envelope, sent)
            case _:
                node.reply(envelope, m.Ok())
