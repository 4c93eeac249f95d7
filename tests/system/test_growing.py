"""An order that grows while a shared plan is running: who is on course keeps its plan wherever this loses nothing."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest

from bus.messages import Event, Status
from ops.recorded import check_run, static_beside
from ops.recording import Recording
from tests.system.whole import Ended, ended

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]

SCENARIO = """
story = "T1 gets one more box while all are at work."
domain = "factory"
floor = {{width = 3, height = 2}}
exchange = {{delay = 1, sharing = "{sharing}"}}

[teams.T1]
boxes = 1
workers = [{{name = "w1", at = [1, 2], effector = 1}}]

[teams.T2]
boxes = 1
workers = [{{name = "w1", at = [1, 2], effector = 1}}, {{name = "w2", at = [1, 1], effector = 2}}]

[teams.T3]
boxes = 1
workers = [{{name = "w1", at = [1, 2], effector = 1}}]

[[fault]]
at_step = 8
kind = "order"
target = "T1"
add = 1

[verdict]
optimal = true
"""


class Adopted(NamedTuple):
    """A plan that a team has adopted, from a global step on."""

    epoch: int
    start: int
    steps: tuple[tuple[str, ...], ...]


def run(home: Path, sharing: str) -> Ended:
    file = home / "growing.toml"
    file.write_text(SCENARIO.format(sharing=sharing))
    over = ended(str(file), home / "run", "--clock", "fast")
    assert over.code == 0, over.told
    static = static_beside(home / "run" / "record")
    assert static is not None
    assert not check_run(over.recording, static).violations
    return over


def adopted(recording: Recording, team: str) -> list[Adopted]:
    told = [e.body for e in recording.statuses if e.src == team and isinstance(e.body, Status)]
    plans = {
        status.epoch: Adopted(status.epoch, status.start, status.plan) for status in told if status.doing == "ready"
    }
    return list(plans.values())


def kept(recording: Recording) -> set[str]:
    """The teams whose second plan is what was left of the first."""
    both = {team: adopted(recording, team) for team in ("T1", "T2", "T3")}
    assert all(len(plans) == 2 for plans in both.values()), both
    return {team for team, (old, new) in both.items() if new.steps == old.steps[new.start - old.start :]}


def exchanges(recording: Recording) -> list[tuple[str, str, str]]:
    told = [e.body.data for e in recording.events if isinstance(e.body, Event) and e.body.kind == "exchange"]
    return [(str(x["robot"]), str(x["giver"]), str(x["taker"])) for x in told]


@pytest.mark.parametrize("sharing", ["published", "general"])
def test_all_keep_their_plans_but_who_has_more_to_do_and_who_helps(sharing: str, tmp_path: Path) -> None:
    recording = run(tmp_path, sharing).recording
    ((_, helper, helped),) = exchanges(recording)
    assert helped == "T1"
    assert kept(recording) == {"T2", "T3"} - {helper}
