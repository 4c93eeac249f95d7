"""What arrives: a queue from the transport's thread to the owner's, and the check of every envelope at the door."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from queue import Empty, SimpleQueue

from bus.codec import Refusal, decode
from bus.messages import Envelope
from bus.transport import Receive

Handler = Callable[[str, bytes], None]
FULL = 50_000
"""Messages waiting at most: a flood must not eat the memory."""


class Inbox:
    """Handlers run on the thread that calls `pump`, in the order of arrival."""

    def __init__(self, run: str) -> None:
        self.refused: Counter[str] = Counter()
        """How many messages were refused since the start, by reason."""
        self._run = run
        self._queue: SimpleQueue[tuple[Handler, str, bytes]] = SimpleQueue()

    def into(self, handler: Handler) -> Receive:
        """A callback for the transport that only enqueues; `handler` gets the message later."""
        queue = self._queue

        def enqueue(key: str, payload: bytes) -> None:
            if queue.qsize() < FULL:
                queue.put((handler, key, payload))
            else:
                self.refused["overflow"] += 1

        return enqueue

    def wake(self) -> None:
        """Make `pump` return; from any thread."""
        self._queue.put((_nothing, "", b""))

    def pump(self, timeout_s: float) -> bool:
        """Handle all that has arrived; wait up to `timeout_s` wall seconds for the first. False: nothing came."""
        try:
            handler, key, payload = self._queue.get(timeout_s > 0, timeout_s)
        except Empty:
            return False
        handler(key, payload)
        while not self._queue.empty():
            handler, key, payload = self._queue.get_nowait()
            handler(key, payload)
        return True

    def open(self, key: str, payload: bytes, *, source: str = "") -> Envelope | None:
        """The envelope, or None if it is refused: not understood, of another run, or not from `source`."""
        envelope = decode(payload)
        if isinstance(envelope, Refusal):
            self.refused[envelope.reason] += 1
            return None
        if envelope.run != self._run:
            self.refused["wrong_run"] += 1
            return None
        if source and envelope.src != source:
            self.refused["forged"] += 1
            return None
        return envelope


def _nothing(key: str, payload: bytes) -> None:
    pass
