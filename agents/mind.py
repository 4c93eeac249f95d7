"""What the parts of a team's agent share: its place on the bus, its memory, and who waits for which reply."""

from __future__ import annotations

from collections.abc import Callable

from agents import memory
from agents.memory import Memory
from agents.setups import TeamSetup
from agents.thinker import Thinker
from bus import messages as m
from bus.messages import Envelope
from bus.node import Node
from reasoning import domain as domains


class Mind:
    """`memory` is what the team must not forget; it changes by `keep` alone."""

    def __init__(self, node: Node, setup: TeamSetup, thinker: Thinker) -> None:
        self.node, self.setup, self.thinker = node, setup, thinker
        self.team = setup.team
        self.domain = domains.load(setup.domain)
        self.memory = memory.load(node.journal)
        self._waiting: dict[str, Callable[[Envelope], None]] = {}

    def keep(self, changed: Memory) -> None:
        """Write down a new memory, in the transaction under way if there is one."""
        self.memory = changed
        memory.save(self.node.journal, changed)

    def request(self, to: str, body: m.Body, react: Callable[[Envelope], None], request_id: str = "") -> str:
        """Send a request whose reply goes to `react`; gives its id."""
        request = self.node.request(to, body, request_id=request_id)
        self._waiting[request] = react
        return request

    def forget(self, request: str) -> None:
        """Nobody waits for this reply any more."""
        self._waiting.pop(request, None)
        self.node.forget(request)

    def hear(self, reply: Envelope) -> None:
        """Give a reply to who waits for it."""
        react = self._waiting.pop(reply.re, None)
        if react is not None:
            react(reply)

    def show(self, doing: str) -> None:
        """Say what the team is doing, to people who watch."""
        plan = self.memory.course
        over = plan is not None and self.memory.step >= plan.start + plan.makespan
        status = m.Status(
            "team",
            doing,
            self.memory.step,
            plan.start if plan else 0,
            plan.steps if plan else (),
            epoch=self.memory.epoch,
            finished=over and self.memory.on_course,
        )
        self.node.status(status)
