"""Where an agent thinks: at once in ``fast`` mode, in a thread of its own in ``realtime``.

Thinking is a pure function of values; what follows from its result is done by the main loop alone, so an agent needs
no locks. clingo releases the interpreter while it grounds and solves.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import Any, TypeVar

from bus.node import Node

T = TypeVar("T")
Cancelled = Callable[[], bool]


class Thinker:
    """Runs one piece of work at a time, in order. Use with `with`."""

    def __init__(self, node: Node, *, threaded: bool) -> None:
        self._node = node
        self._generation = 0
        self._work: queue.SimpleQueue[tuple[int, Callable[[Cancelled], Any], Callable[[Any], None]] | None] = (
            queue.SimpleQueue()
        )
        self._results: queue.SimpleQueue[tuple[int, Callable[[], None]]] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._loop, daemon=True, name="thinker") if threaded else None

    def __enter__(self) -> Thinker:
        if self._thread is not None:
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.cancel()
        if self._thread is not None:
            self._work.put(None)
            self._thread.join(timeout=2.0)

    def start(self, work: Callable[[Cancelled], T], then: Callable[[T], None]) -> None:
        """Have `work` done and call `then` with its result, unless `cancel` comes first.

        `work` gets a function that tells whether it has been cancelled. An exception in it is a bug and surfaces in
        the main loop.
        """
        mine = self._generation
        if self._thread is None:
            then(work(lambda: False))
        else:
            self._work.put((mine, work, then))

    def beat(self) -> None:
        """A sign of life from long work: needed only where the main loop itself is at work."""
        if self._thread is None:
            self._node.beat("thinking")

    def cancel(self) -> None:
        """Forget all work that is not finished; its results are not delivered."""
        self._generation += 1

    def deliver(self) -> None:
        """Act on the results that have come since. Called by the main loop at every turn."""
        while not self._results.empty():
            mine, act = self._results.get()
            if mine == self._generation:
                act()

    def _loop(self) -> None:
        while (item := self._work.get()) is not None:
            mine, work, then = item
            if mine != self._generation:
                continue
            self._results.put((mine, self._attempt(mine, work, then)))
            self._node.wake_soon()

    def _attempt(self, mine: int, work: Callable[[Cancelled], Any], then: Callable[[Any], None]) -> Callable[[], None]:
        try:
            result = work(lambda: mine != self._generation)
        except Exception as error:  # handed to the main loop, which dies of it in sight of the supervisor
            bug = error

            def fail() -> None:
                raise bug

            return fail
        return lambda: then(result)
