"""Ctrl-C at any moment: the run ends with exit code 130 and leaves nobody behind."""

from __future__ import annotations

import os
import random
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from ops.children import environment
from tests.ops.test_running import children_of
from tests.system.whole import MUSTER, alive, until

pytestmark = [pytest.mark.slow, pytest.mark.timeout(120)]

PID = re.compile(r"(?:re)?started: pid (\d+)")


@pytest.mark.parametrize("seed", range(6))
def test_interrupted_after_a_drawn_line(seed: int, tmp_path: Path) -> None:
    """Three times early, while processes start, three times later; either clock."""
    draw = random.Random(seed)
    line_number = draw.randrange(10) if seed % 2 else draw.randrange(10, 40)
    clock, pause_s = draw.choice(["fast", "realtime:20"]), draw.choice([0.0, 0.02, 0.1])
    words = ["run", "factory/broken_worker", "--headless", "--clock", clock]
    own = {**environment(), "XDG_RUNTIME_DIR": str(tmp_path)}
    with subprocess.Popen([*MUSTER, *words], env=own, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        assert run.stdout is not None
        shown = ""
        for number, line in enumerate(run.stdout):
            shown += line
            if number == line_number:
                break
        threading.Event().wait(pause_s)
        pids = children_of(run.pid)
        run.send_signal(signal.SIGINT)
        rest, errors = run.communicate(timeout=60)
    pids += map(int, PID.findall(shown + rest))
    assert len(set(pids)) >= 2
    assert run.returncode == 130, shown + rest + errors
    assert "Traceback" not in errors
    until(lambda: not any(map(alive, pids)), f"the end of {[pid for pid in pids if alive(pid)]}")
    assert not list(tmp_path.glob("muster/*")), "neither a listed run nor a home that nobody asked for"


@pytest.mark.parametrize("pause_s", [0.15, 0.3, 0.6])
def test_interrupted_before_anything_is_shown(pause_s: float, tmp_path: Path) -> None:
    """While Python itself is still starting there is nobody to catch a signal; that ends the process all the same."""
    own = {**environment(), "XDG_RUNTIME_DIR": str(tmp_path)}
    command = [sys.executable, "-m", "ops.cli", "run", "factory/broken_worker", "--headless"]
    with subprocess.Popen(command, env=own, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        threading.Event().wait(pause_s)
        pids = children_of(run.pid)
        os.kill(run.pid, signal.SIGINT)
        run.communicate(timeout=60)
    assert run.returncode in (130, -signal.SIGINT)
    until(lambda: not any(map(alive, pids)), f"the end of {[pid for pid in pids if alive(pid)]}")
    assert not list(tmp_path.glob("muster/*"))
