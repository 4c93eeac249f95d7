"""Every shipped scenario, as real processes: it ends with its verdict, and nobody is left behind. In ``fast`` mode the
same seed gives the same events, in the same order at the same simulated times: with kills, pauses and bad links too,
for they happen while everybody waits for the world's word.
"""

from __future__ import annotations

from difflib import unified_diff
from pathlib import Path

import pytest

from ops.places import runnable
from ops.recorded import check_run, static_beside
from ops.recording import event_stream
from ops.scenario import load
from reasoning.domain import load as load_domain
from tests.system.whole import LIMIT_S, SMALL, Ended, alive, ended

pytestmark = [pytest.mark.slow, pytest.mark.timeout(2 * LIMIT_S + 60)]

EVENTFUL = {
    *(
        name
        for name in SMALL
        if load_domain(load(name).domain).data.conducted or load(name).faults or len(load(name).teams) > 1
    ),
    "housekeeping/three_rooms",
}
"""The small ones, without those of a single team that acts for itself and meets with nothing; and three teams that act
for themselves and help one another. They are run twice."""


@pytest.mark.parametrize("name", sorted(runnable()))
def test_a_shipped_scenario_ends_with_its_verdict_and_again_in_the_same_way(name: str, tmp_path: Path) -> None:
    first = whole(name, tmp_path / "first")
    if name in EVENTFUL:
        second = whole(name, tmp_path / "second")
        assert len(lines(first)) > 30
        differing = unified_diff(lines(first), lines(second), "first", "second", n=1, lineterm="")
        assert list(differing)[:20] == []


def whole(name: str, home: Path) -> Ended:
    """A run that has ended as it should."""
    run = ended(name, home, "--clock", "fast")
    failed = [condition for condition in run.told["conditions"] if not condition["ok"]]
    assert (failed, run.told["invariants"]) == ([], []), run.told["reason"]
    assert run.code == load(name).verdict.exit
    assert run.told["pids"]
    assert not [pid for pid in run.told["pids"] if alive(pid)]
    static = static_beside(home / "record")
    assert run.recording.scene is not None
    assert static is not None
    if not run.recording.scene.conducted:
        assert check_run(run.recording, static).violations == []
    return run


def lines(run: Ended) -> list[str]:
    return [f"{at_s:.6f} {source} {kind} {data}" for at_s, source, kind, data in event_stream(run.recording)]
