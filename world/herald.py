"""Tells the coordinator who is out of contact and who is back, one piece of news about somebody after the other.

Two requests under way could overtake one another on a bad link, and somebody who is back would be lost for good.
"""

from __future__ import annotations

from bus.clock import ContactState
from bus.messages import Contact
from bus.node import Node


class Herald:
    """`told` takes the answers to what `tell` has sent."""

    def __init__(self, node: Node, to: str) -> None:
        self._node, self._to = node, to
        self._latest: dict[str, ContactState] = {}
        self._under_way: dict[str, tuple[str, ContactState]] = {}

    def tell(self, name: str, state: ContactState) -> None:
        """Tell now, or when what was told before has been confirmed."""
        self._latest[name] = state
        if name not in self._under_way:
            self._under_way[name] = self._node.request(self._to, Contact(name, state)), state

    def told(self, request: str) -> None:
        """A request was answered."""
        for name, (known, state) in list(self._under_way.items()):
            if known == request:
                del self._under_way[name]
                if self._latest[name] != state:
                    self.tell(name, self._latest[name])
