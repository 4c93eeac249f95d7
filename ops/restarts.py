"""When may a process that died be started again? Restart intensity as in Erlang's supervisors: so many in so long."""

from __future__ import annotations

from collections import deque


class Restarts:
    """One process's deaths. `budget` restarts within `window_s` are allowed, each later than the one before."""

    def __init__(self, budget: int, window_s: float = 60.0, first_s: float = 0.1, longest_s: float = 5.0) -> None:
        self._budget, self._window_s, self._first_s, self._longest_s = budget, window_s, first_s, longest_s
        self._deaths: deque[float] = deque()

    def died(self, now_s: float) -> float | None:
        """Seconds to wait before the next start (0 for the first in a while), or None: give up."""
        while self._deaths and now_s - self._deaths[0] > self._window_s:
            self._deaths.popleft()
        self._deaths.append(now_s)
        if len(self._deaths) > self._budget:
            return None
        if len(self._deaths) == 1:
            return 0.0
        return float(min(self._longest_s, self._first_s * 2.0 ** (len(self._deaths) - 2)))
