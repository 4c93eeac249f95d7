"""Whole runs for the tests of the system: started as a user starts them, found and watched from outside."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from bus.clock import wall_s
from ops.children import environment
from ops.places import runnable
from ops.recording import Recording, load
from ops.scenario import load as load_scenario

MUSTER = [sys.executable, "-m", "ops.cli"]
LIMIT_S = 120.0
SMALL = sorted(name for name in runnable() if len(load_scenario(name).teams) <= 2)
"""Scenarios that take seconds."""


class Ended(NamedTuple):
    """A run that is over: its exit code, what ``--json`` told of it, and its recording."""

    code: int
    told: dict[str, Any]
    recording: Recording


class Live(NamedTuple):
    """A run that goes on; `connect` is its router's endpoint. `wait` for its end."""

    run: str
    connect: str
    wait: Callable[[], Ended]


@contextmanager
def running(scenario: str, home: Path, *words: str) -> Iterator[Live]:
    """Start a run and go on when it is listed; whatever happens, it is over at the end."""
    own = {**environment(), "XDG_RUNTIME_DIR": str(home)}
    home.mkdir(parents=True, exist_ok=True)
    command = [*MUSTER, "run", scenario, "--json", "--record", str(home / "record"), *words]
    with subprocess.Popen(command, env=own, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:

        def wait() -> Ended:
            out, err = process.communicate(timeout=LIMIT_S)
            assert out, err
            return Ended(process.returncode, json.loads(out), load(home / "record"))

        try:
            until(lambda: process.poll() is not None or list((home / "muster").glob("*.run")), "the run is listed")
            listed = [json.loads(file.read_text()) for file in (home / "muster").glob("*.run")]
            yield Live(listed[0]["run"], listed[0]["connect"], wait)
        finally:
            if process.poll() is None:
                process.terminate()
                process.communicate(timeout=LIMIT_S)


def ended(scenario: str, home: Path, *words: str) -> Ended:
    """A whole run."""
    with running(scenario, home, *words) as live:
        return live.wait()


def until(condition: Callable[[], Any], what: str, limit_s: float = 30.0) -> None:
    """Wait for a condition; it comes true, or the test fails."""
    end_s = wall_s() + limit_s
    while not condition():
        assert wall_s() < end_s, f"not within {limit_s:g} s: {what}"
        threading.Event().wait(0.01)


def alive(pid: int) -> bool:
    """Whether there is such a process; one that is dead and not yet collected does not count."""
    try:
        os.kill(pid, 0)
        return "\nState:\tZ" not in Path(f"/proc/{pid}/status").read_text()
    except (ProcessLookupError, FileNotFoundError):
        return False
