"""How long a search may go on, and calls that nobody has to wait for."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import Future
from threading import Thread
from typing import Any, TypeVar

from bus.clock import wall_s

T = TypeVar("T")


class Patience:
    """How long the search may go on: `search_s` wall seconds from `began` (0: for ever), or until `stop` says so."""

    def __init__(self, began: float, search_s: float, stop: Callable[[], bool]) -> None:
        self._stop, self._search_s = stop, search_s
        # A little early, so that the result is out in time on a busy machine, too.
        self._end = began + 0.95 * search_s if search_s else math.inf

    def left_s(self) -> float | None:
        return self._end - wall_s() if self._end < math.inf else None

    def over(self) -> str:
        """Why the search is over, in words; "" if it is not."""
        if self._stop():
            return "the search was interrupted"
        late = wall_s() >= self._end
        return f"the search was stopped after {self._search_s:g} s, by --budget or limits.search_s" if late else ""


def begun(function: Callable[..., T], *args: Any, **options: Any) -> Future[T]:
    """A call in a thread that nobody has to wait for, not even the end of the process."""
    future: Future[T] = Future()

    def call() -> None:
        try:
            future.set_result(function(*args, **options))
        except BaseException as error:  # raised where the result is asked for
            future.set_exception(error)

    Thread(target=call, name="search", daemon=True).start()
    return future
