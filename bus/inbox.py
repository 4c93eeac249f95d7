"""What arrives: a queue from the transport's thread to the owner's, and the check of every envelope at the door."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable
from queue import Empty, SimpleQueue

from bus.codec import MAX_BYTES, Refusal, decode
from bus.messages import Envelope
from bus.transport import Receive

Handler = Callable[[str, bytes], None]
FULL, FULL_BYTES = 50_000, 256 << 20
"""Messages waiting at most, and their bytes: a flood must not eat the memory."""


class Inbox:
    """Handlers run on the thread that calls `pump`, in the order of arrival."""

    def __init__(self, run: str) -> None:
        self.refused: Counter[str] = Counter()
        """How many messages were refused since the start, by reason."""
        self._run = run
        self._queue: SimpleQueue[tuple[Handler, str, bytes]] = SimpleQueue()
        self._waiting = 0
        """Bytes in the queue."""
        self._lock = threading.Lock()
        """For the counters, which threads of the transport change, too."""

    def into(self, handler: Handler) -> Receive:
        """A callback for the transport that only enqueues; `handler` gets the message later. What is larger than any
        message, or more than may wait, is refused."""

        def enqueue(key: str, payload: bytes) -> None:
            size = len(payload)
            if size > MAX_BYTES:
                self.refuse("oversized")
                return
            with self._lock:
                full = self._queue.qsize() >= FULL or self._waiting + size > FULL_BYTES
                self._waiting += 0 if full else size
            if full:
                self.refuse("overflow")
            else:
                self._queue.put((handler, key, payload))

        return enqueue

    def refuse(self, reason: str) -> None:
        """Count a message that is not taken; from any thread."""
        with self._lock:
            self.refused[reason] += 1

    def wake(self) -> None:
        """Make `pump` return; from any thread."""
        self._queue.put((_nothing, "", b""))

    def pump(self, timeout_s: float) -> bool:
        """Handle all that has arrived; wait up to `timeout_s` wall seconds for the first. False: nothing came.

        What arrives meanwhile waits for the next call: there may be no end to it.
        """
        try:
            first = self._queue.get(timeout_s > 0, timeout_s)
        except Empty:
            return False
        others = self._queue.qsize()
        self._handle(*first)
        for _ in range(others):
            self._handle(*self._queue.get_nowait())
        return True

    def _handle(self, handler: Handler, key: str, payload: bytes) -> None:
        with self._lock:
            self._waiting -= len(payload)
        handler(key, payload)

    def open(self, payload: bytes, *, source: str = "") -> Envelope | None:
        """The envelope, or None if it is refused: not understood, of another run, or not from `source`."""
        envelope = decode(payload)
        if isinstance(envelope, Refusal):
            self.refuse(envelope.reason)
            return None
        if envelope.run != self._run:
            self.refuse("wrong_run")
            return None
        if source and envelope.src != source:
            self.refuse("forged")
            return None
        return envelope


def _nothing(key: str, payload: bytes) -> None:
    pass
