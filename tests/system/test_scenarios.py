"""Every shipped scenario, as real processes: it ends with its verdict, and nobody is left behind."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from ops.children import environment
from ops.places import runnable
from ops.recorded import check_run, static_beside
from ops.recording import load as load_recording
from ops.scenario import load

LIMIT_S = 240.0

pytestmark = [pytest.mark.slow, pytest.mark.timeout(LIMIT_S + 60)]


def exists(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return "\nState:\tZ" not in Path(f"/proc/{pid}/status").read_text()


@pytest.mark.parametrize("name", sorted(runnable()))
def test_a_shipped_scenario_ends_with_its_verdict(name: str, tmp_path: Path) -> None:
    scenario = load(name)
    done = subprocess.run(
        [sys.executable, "-m", "ops.cli", "run", name, "--clock", "fast", "--json", "--record", str(tmp_path / "run")],
        env=environment(),
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    told = json.loads(done.stdout)
    failed = [condition for condition in told["conditions"] if not condition["ok"]]
    assert (failed, told["invariants"]) == ([], []), f"{told['reason']}\n{done.stderr}"
    assert done.returncode == scenario.verdict.exit
    assert told["pids"]
    assert not [pid for pid in told["pids"] if exists(pid)]
    recording, static = load_recording(tmp_path / "run"), static_beside(tmp_path / "run")
    assert recording.scene is not None
    assert static is not None
    if not recording.scene.conducted:
        assert check_run(recording, static).violations == []
