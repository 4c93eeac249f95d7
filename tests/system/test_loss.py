"""What lost messages cost: some time, never much, and nothing else."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from bus.messages import Event
from tests.system.whole import ended

PERIOD_S, LONGEST_S = 2.0, 10.0

pytestmark = [pytest.mark.slow, pytest.mark.timeout(150)]


def test_a_lost_reply_costs_a_few_seconds_and_not_more_each_time(tmp_path: Path) -> None:
    """With this seed one step loses several messages in a row; with pauses that go on doubling it took 21 s."""
    run = ended("factory/lossy_bus", tmp_path, "--seed", "33", "--clock", "fast")
    assert run.code == 0, run.told
    begun: dict[object, float] = {}
    for envelope in run.recording.events:
        if isinstance(envelope.body, Event) and envelope.body.kind == "step_started":
            begun.setdefault(envelope.body.data["step"], envelope.at_s)
    times = sorted(begun.values())
    steps = [after - before for before, after in pairwise(times)]
    assert min(steps) >= PERIOD_S
    assert max(steps) <= LONGEST_S
