"""The port: what the bus needs from whatever carries its bytes. `bus.zenoh_transport` and
`bus.memory_transport` implement it, and one test suite holds both to it.

Callbacks run on the transport's thread, or on the sender's. They must return at once and must not raise: put it
in a queue and go.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

Receive = Callable[[str, bytes], None]
"""Takes the key and the payload of a message."""
Notice = Callable[[str, bool], None]
"""Takes the key of a presence token and whether it is there."""


class TransportError(Exception):
    """The bus cannot be reached or used; the text says what to do."""


class Transport(Protocol):
    def put(self, key: str, payload: bytes, *, droppable: bool = False) -> None:
        """Hand a message over; messages of one sender arrive in order. A droppable one is thrown away where a
        receiver is too slow, which for the others would hold everybody up. After `close`: ignored."""

    def keep(self, key: str, payload: bytes) -> None:
        """`put` the latest value of `key`, and hold it for those who subscribe later, as long as this side lives."""

    def subscribe(self, keyexpr: str, callback: Receive, *, latest: bool = False, history: bool = False) -> None:
        """Receive what is put on `keyexpr` from now on. `latest`: when the callback is slower than the sender, skip
        to the newest message. `history`: first of all the values kept so far."""

    def present(self, key: str) -> None:
        """Show a presence token until this side closes or dies."""

    def watch(self, keyexpr: str, callback: Notice) -> None:
        """Follow the presence tokens on `keyexpr`, those that are there already included."""

    def close(self) -> None:
        """End everything. Afterwards no callback is called. Safe to repeat."""
