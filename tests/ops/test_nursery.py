"""The nursery: what it forks is what a plain start would have made, and nothing depends on it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ops.children import environment
from ops.processes import nursery
from ops.supervisor import GaveUpError, Supervisor
from tests.system.whole import alive, until

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere all are started plainly")

TOY = """
import json, os, signal, sys
from pathlib import Path

def main():
    me = {
        "argv": sys.argv, "env": dict(os.environ), "folder": os.getcwd(), "parent": os.getppid(),
        "leads": [os.getsid(0) == os.getpid(), os.getpgrp() == os.getpid()],
        "files": [os.readlink(f"/proc/self/fd/{number}") for number in range(3)],
        "open": len(os.listdir("/proc/self/fd")),
        "ignored": sorted(n for n in signal.valid_signals() if signal.getsignal(n) == signal.SIG_IGN),
        "shown": Path("/proc/self/cmdline").read_text().replace(chr(0), " ").strip(),
    }
    print(json.dumps(me), flush=True)
    signal.pause()

if __name__ == "__main__":
    main()
"""
COMMAND = [sys.executable, "-m", "toy", "--name", "T1", "--setup", "some where.json"]


@pytest.fixture
def boss(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Supervisor]:
    """A supervisor whose children find the toy."""
    (tmp_path / "toy.py").write_text(TOY)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with Supervisor(time.monotonic, lambda *_: None) as boss:
        yield boss


def nurse(boss: Supervisor, home: Path, *more: str) -> int:
    """Have a nursery, and its process id when it has one."""
    boss.nurse([sys.executable, "-m", "agents.nursery", "toy", *more], home / "nursery.log")
    boss.launch("first", COMMAND, home / "first.log")
    keeper = said(home / "first.log")["parent"]
    children = Path(f"/proc/{keeper}/task/{keeper}/children").read_text().split()
    return next((int(pid) for pid in children if b"agents.nursery" in Path(f"/proc/{pid}/cmdline").read_bytes()), 0)


def said(log: Path) -> dict[str, Any]:
    """What the toy says of itself."""
    until(lambda: log.exists() and log.read_text().endswith("\n"), f"{log} is written", 20.0)
    me: dict[str, Any] = json.loads(log.read_text())
    return me


def test_a_nursed_process_is_what_a_plain_one_is(boss: Supervisor, tmp_path: Path) -> None:
    boss.launch("plain", COMMAND, tmp_path / "log")
    plain = said(tmp_path / "log")
    (tmp_path / "log").unlink()
    mother = nurse(boss, tmp_path)
    boss.launch("nursed", COMMAND, tmp_path / "log")
    assert said(tmp_path / "log") == plain
    assert plain["leads"] == [True, True]
    # It was forked indeed: a plain one has an interpreter's start behind it, and this one has our modules in memory.
    assert "zenoh" in Path(f"/proc/{boss.table['nursed'].pid}/maps").read_text()
    assert "zenoh" not in Path(f"/proc/{boss.table['plain'].pid}/maps").read_text()
    boss.stop()
    assert alive(mother)


def test_a_killed_nursery_takes_nobody_along_and_is_not_needed(boss: Supervisor, tmp_path: Path) -> None:
    mother = nurse(boss, tmp_path)
    os.kill(mother, signal.SIGKILL)
    until(lambda: not alive(mother), "it is gone")
    assert alive(boss.table["first"].pid)
    boss.disturb("kill", "first")
    boss.until(lambda: boss.table["first"].state == "running" and boss.table["first"].starts == 2, 20, "back")
    boss.launch("second", COMMAND, tmp_path / "second.log")
    assert "zenoh" not in Path(f"/proc/{boss.table['second'].pid}/maps").read_text()
    boss.stop()
    assert not any(map(alive, [*boss.table["first"].pids, boss.table["second"].pid]))


@pytest.mark.slow
def test_a_nursery_that_does_not_answer_is_given_up(boss: Supervisor, tmp_path: Path) -> None:
    mother = nurse(boss, tmp_path)
    os.kill(mother, signal.SIGSTOP)
    boss.launch("second", COMMAND, tmp_path / "second.log")
    assert said(tmp_path / "second.log")["argv"][1:] == COMMAND[3:]
    assert not alive(mother)


def test_nobody_is_left_behind(boss: Supervisor, tmp_path: Path) -> None:
    mother = nurse(boss, tmp_path)
    assert alive(mother)
    boss.__exit__(None, None, None)
    assert not alive(mother)
    assert not alive(boss.table["first"].pid)


def test_a_nursery_that_cannot_begin_is_not_needed(boss: Supervisor, tmp_path: Path) -> None:
    assert nurse(boss, tmp_path, "no_such_module") == 0
    assert "no_such_module" in (tmp_path / "nursery.log").read_text()


def test_what_cannot_be_started_is_said(boss: Supervisor, tmp_path: Path) -> None:
    nurse(boss, tmp_path)
    with pytest.raises(GaveUpError, match="second cannot be started"):
        boss.launch("second", COMMAND, tmp_path / "nowhere" / "second.log")


def test_the_agents_are_imported_without_a_thread_or_a_file() -> None:
    """Neither would survive the fork."""
    with subprocess.Popen(
        nursery(sys.executable), stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment(), text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "{}\n"
        assert len(os.listdir(f"/proc/{process.pid}/task")) == 1
        assert len(os.listdir(f"/proc/{process.pid}/fd")) == 4
        process.communicate("", timeout=20)
    assert process.returncode == 0
