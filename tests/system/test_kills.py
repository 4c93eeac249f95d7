"""kill -9 at drawn moments: the goal is reached all the same, and the invariants hold on the recording."""

from __future__ import annotations

import pytest

from bench.recovery import VICTIMS, run


@pytest.mark.slow
@pytest.mark.timeout(240)
def test_a_run_survives_kills_at_drawn_moments() -> None:
    figures = run(kills=8)
    for victim in VICTIMS:
        row = figures[victim]
        assert row["kills"] == 2
        assert row["goal_and_invariants"] == row["kills"], row["failed"]
        assert row["hit"] > 0, "no kill was seen: it tested nothing"
