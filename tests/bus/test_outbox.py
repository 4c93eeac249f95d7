"""When requests that nobody answers are sent again."""

from __future__ import annotations

from math import inf

import pytest

from bus.memory_transport import MemoryRouter
from bus.messages import Observe
from bus.outbox import FAST_S, Outbox


@pytest.mark.parametrize(
    ("longest_s", "retry_s", "pauses"),
    [
        (inf, 1.0, [1.0, 2.0, 4.0, 8.0, 8.0, 8.0]),
        (FAST_S, 1.0, [1.0, 2.0, 2.0, 2.0, 2.0, 2.0]),
        (FAST_S, 0.25, [0.25, 0.5, 1.0, 2.0, 2.0, 2.0]),
        (FAST_S, 6.0, [6.0, 6.0, 6.0, 6.0, 6.0, 6.0]),
    ],
)
def test_repetitions_slow_down_to_a_limit(longest_s: float, retry_s: float, pauses: list[float]) -> None:
    now_s = 100.0
    outbox = Outbox("r", "T1", 1, MemoryRouter().connect())
    outbox.now, outbox.is_outsider, outbox.longest_s = lambda: now_s, lambda name: False, longest_s
    outbox.request("world", Observe("T1"), retry_s)
    found = []
    for _ in pauses:
        due_s = outbox.next_due_s()
        assert due_s is not None
        found.append(due_s - now_s)
        now_s = due_s
        outbox.send_due()
    assert found == pauses
    assert outbox.repeated == len(pauses)
    outbox.resend("world")
    assert outbox.next_due_s() == now_s + retry_s, "who came back is asked at short intervals again"
