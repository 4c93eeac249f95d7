"""In ``fast`` mode the same seed gives the same events, in the same order at the same simulated times: with kills,
pauses and bad links too, for they happen while everybody waits for the world's word.
"""

from __future__ import annotations

from difflib import unified_diff
from pathlib import Path

import pytest

from ops.recording import event_stream
from ops.scenario import load
from reasoning.domain import load as load_domain
from tests.system.whole import SMALL, ended

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]


EVENTFUL = [
    *(
        name
        for name in SMALL
        if load_domain(load(name).domain).data.conducted or load(name).faults or len(load(name).teams) > 1
    ),
    "housekeeping/three_rooms",
]
"""The small ones, without those of a single team that acts for itself and meets with nothing; and three teams that act
for themselves and help one another."""


@pytest.mark.parametrize("name", EVENTFUL)
def test_the_same_seed_gives_the_same_events(name: str, tmp_path: Path) -> None:
    first, second = (lines(name, tmp_path / number) for number in ("first", "second"))
    assert len(first) > 30
    assert list(unified_diff(first, second, "first", "second", n=1, lineterm=""))[:20] == []


def lines(name: str, home: Path) -> list[str]:
    run = ended(name, home, "--clock", "fast", "--seed", "5")
    assert run.code == load(name).verdict.exit, run.told
    return [f"{at_s:.6f} {source} {kind} {data}" for at_s, source, kind, data in event_stream(run.recording)]
