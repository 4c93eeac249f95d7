"""A team's mind: ``python -m agents.team``. A thin loop that joins the pure core to the bus.

It observes, answers the coordinator's questions and adopts plans (`agents.answering`), executes them step by step,
compares what it senses with what the plan predicts, and finds out why they differ (`agents.executing`). Whatever it
must not forget is in `agents.memory`, written before it is told to anybody. It knows its domain's encodings, its own
sensors, and messages; nothing else.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from agents import telling
from agents.answering import Answering
from agents.executing import Executing
from agents.mind import Mind
from agents.setups import TeamSetup, read
from agents.thinker import Thinker
from bus import messages as m
from bus.messages import Envelope
from bus.node import Node, arguments, open_node
from reasoning.domain import load

if TYPE_CHECKING:
    from agents.autonomous.team import Autonomous

COORDINATOR = "coordinator"


class Team:
    """Reacts to one message at a time. Every request that it answers may come again; every answer is journalled."""

    def __init__(self, node: Node, setup: TeamSetup, thinker: Thinker) -> None:
        self.mind = Mind(node, setup, thinker)
        self.answering = Answering(self.mind)
        self.executing = Executing(self.mind, self.answering.attend)
        self._first_word = telling.FirstWord(node, "team")
        self.mind.show("observing" if self.mind.memory.course is None else "back at work")
        self.executing.resume()

    def turn(self, mail: tuple[Envelope, ...]) -> None:
        node = self.mind.node
        self._first_word.tell()
        for envelope in mail:
            if envelope.re:
                self.mind.hear(envelope)
                continue
            match envelope.body:
                case m.Enquire() | m.Ask() | m.Adopt() | m.Welcome() | m.Go() if envelope.src != COORDINATOR:
                    node.refuse(envelope, "not_yours")
                case m.Enquire() as enquire:
                    self.answering.enquire(envelope, enquire)
                case m.Ask() as ask:
                    self.answering.ask(envelope, ask)
                case m.Adopt() as adopt:
                    self.answering.adopt(envelope, adopt)
                case m.Welcome() as welcome:
                    self.answering.welcome(envelope, welcome)
                case m.Go() as go:
                    self.executing.go_on(envelope, go)
                case _:
                    node.reply(envelope, m.Ok())
        self.mind.thinker.deliver()


def _mind(setup: TeamSetup) -> type[Team] | type[Autonomous]:
    """The kind of mind that the domain asks for."""
    if load(setup.domain).data.conducted:
        return Team
    from agents.autonomous.team import Autonomous  # only now: geometry is slow to import, and most domains do without

    return Autonomous


def main() -> int:
    config = arguments(sys.argv[1:])
    setup = read(config, TeamSetup)
    with open_node(config) as node, Thinker(node, threaded=config.mode == "realtime") as thinker:
        team = _mind(setup)(node, setup, thinker)
        for turn in node.turns():
            team.turn(turn.mail)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
