"""What the coordinator has asked of the teams and not been told yet, at most one request a team."""

from __future__ import annotations

from bus.messages import Body, Envelope
from bus.node import Node


class Requests:
    """True while somebody has not answered; a team is in it while it has not."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._open: dict[str, str] = {}

    def __bool__(self) -> bool:
        return bool(self._open)

    def __contains__(self, team: str) -> bool:
        return team in self._open

    def send(self, team: str, body: Body) -> None:
        self._open[team] = self._node.request(team, body)

    def settle(self, reply: Envelope) -> bool:
        """Is this the reply to the request that is open? Then it is open no more."""
        if self._open.get(reply.src) != reply.re:
            return False
        del self._open[reply.src]
        return True

    def withdraw(self, team: str) -> None:
        """The team's answer is not needed any more."""
        if team in self._open:
            self._node.forget(self._open.pop(team))

    def withdraw_all(self) -> None:
        for team in tuple(self._open):
            self.withdraw(team)
