"""The supervisor with trivial children: restart, giving up, stopping, and nobody left behind on any way out."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from ops.children import environment
from ops.restarts import Restarts
from ops.supervisor import GaveUpError, Supervisor, TooLongError
from tests.system.whole import alive, until

SLEEPER = [sys.executable, "-S", "-c", "import signal; signal.pause()"]
FAILING = [sys.executable, "-S", "-c", "raise SystemExit(3)"]
STUBBORN = [
    sys.executable,
    "-S",
    "-c",
    "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN); print('deaf', flush=True); signal.pause()",
]
FAMILY = [
    sys.executable,
    "-S",
    "-c",
    "import signal, subprocess, sys;"
    "child = subprocess.Popen([sys.executable, '-S', '-c', 'import signal; signal.pause()']);"
    "print(child.pid, flush=True); signal.pause()",
]


class Told(list[tuple[str, str, str]]):
    def __call__(self, name: str, state: str, cause: str) -> None:
        self.append((name, state, cause))

    def states(self, name: str) -> list[str]:
        return [state for who, state, _ in self if who == name]


def supervisor(told: Told, budget: int = 5) -> Supervisor:
    return Supervisor(time.monotonic, told, budget)


def test_a_killed_child_is_started_again(tmp_path: Path) -> None:
    told = Told()
    with supervisor(told) as boss:
        boss.launch("one", SLEEPER, tmp_path / "one.log")
        first = boss.table["one"].pid
        os.kill(first, signal.SIGKILL)
        boss.until(lambda: told.states("one") == ["started", "died", "restarted"], 10, "restart")
        assert boss.table["one"].pid != first
        assert told[1] == ("one", "died", "killed by SIGKILL")
    assert not any(alive(pid) for pid in boss.table["one"].pids)


def test_a_child_that_keeps_dying_is_given_up(tmp_path: Path) -> None:
    told = Told()
    reason = r"bad died 3 times, last: ended by itself with exit code 3; see .*bad\.log"
    with supervisor(told, budget=2) as boss:
        boss.launch("bad", FAILING, tmp_path / "bad.log")
        with pytest.raises(GaveUpError, match=reason):
            boss.until(lambda: False, 10, "giving up")
    assert told.states("bad") == ["started", "died", "restarted", "died", "restarted", "died", "gave_up"]


def test_what_cannot_be_started_is_said(tmp_path: Path) -> None:
    with supervisor(Told()) as boss, pytest.raises(GaveUpError, match="ghost cannot be started"):
        boss.launch("ghost", ["/no/such/program"], tmp_path / "ghost.log")


def test_stop_ends_children_in_reverse_and_kills_the_deaf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ops.supervisor.TERMINATE_S", 0.3)
    told = Told()
    with supervisor(told) as boss:
        boss.launch("first", SLEEPER, tmp_path / "first.log")
        boss.launch("deaf", STUBBORN, tmp_path / "deaf.log")
        boss.launch("last", SLEEPER, tmp_path / "last.log")
        until(lambda: "deaf" in (tmp_path / "deaf.log").read_text(), "it is deaf", 10.0)
        boss.stop()
    assert [name for name, state, _ in told if state == "stopped"] == ["last", "deaf", "first"]


def test_a_paused_child_can_be_stopped(tmp_path: Path) -> None:
    with supervisor(Told()) as boss:
        boss.launch("one", SLEEPER, tmp_path / "one.log")
        assert boss.disturb("pause", "one") == ""
        boss.stop()
        assert boss.table["one"].state == "ended"


def test_disturbing_somebody_unknown_is_refused(tmp_path: Path) -> None:
    with supervisor(Told()) as boss:
        boss.launch("one", SLEEPER, tmp_path / "one.log")
        assert boss.disturb("kill", "two") == "no process 'two'; there are one"


def test_kill_and_restart_on_purpose_have_a_cause(tmp_path: Path) -> None:
    told = Told()
    with supervisor(told) as boss:
        boss.launch("one", SLEEPER, tmp_path / "one.log")
        boss.disturb("kill", "one")
        boss.until(lambda: told.states("one").count("restarted") == 1, 10, "first restart")
        boss.disturb("restart", "one")
        boss.until(lambda: told.states("one").count("restarted") == 2, 10, "second restart")
    assert [cause for _, state, cause in told if state == "died"] == ["killed on purpose", "restarted on purpose"]


def test_who_is_stopped_on_purpose_is_not_started_again(tmp_path: Path) -> None:
    told, done = Told(), []
    with supervisor(told) as boss:
        boss.launch("one", SLEEPER, tmp_path / "one.log")
        boss.disturb("stop", "one", lambda: done.append(True))
        boss.until(lambda: bool(done) and boss.table["one"].state == "ended", 10, "its end")
    assert told[1:] == [("one", "died", "stopped on purpose")]


def test_helpers_of_a_child_end_with_it(tmp_path: Path) -> None:
    log = tmp_path / "family.log"
    with supervisor(Told()) as boss:
        boss.launch("family", FAMILY, log)
        until(lambda: log.read_text().endswith("\n"), "its child is there", 10.0)
        helper = int(log.read_text())
        assert alive(helper)
        boss.stop()
        until(lambda: not alive(helper), "the child is gone", 10.0)


def test_a_condition_that_does_not_come_true_is_named() -> None:
    with supervisor(Told()) as boss, pytest.raises(TooLongError, match=r"waited 0\.05 s for: rain"):
        boss.until(lambda: False, 0.05, "rain")


def test_an_exception_leaves_nobody_behind(tmp_path: Path) -> None:
    boss = supervisor(Told())
    with pytest.raises(GaveUpError), boss:  # noqa: PT012
        boss.launch("one", SLEEPER, tmp_path / "one.log")
        boss.launch("ghost", ["/no/such/program"], tmp_path / "ghost.log")
    assert not alive(boss.table["one"].pid)


SCRIPT = """
import sys, time
from pathlib import Path
from ops.supervisor import Supervisor
with Supervisor(time.monotonic, lambda *said: None) as boss:
    for name in ("one", "two"):
        boss.launch(name, [sys.executable, "-S", "-c", "import signal; signal.pause()"], Path(sys.argv[1]))
    keeper = boss._children.pid
    print(keeper, *(child.pid for child in boss.table.values()), flush=True)
    boss.until(lambda: False, 600, "the end")
"""


@pytest.mark.parametrize("victim", ["supervisor", "keeper"])
def test_kill_minus_nine_leaves_nobody_behind(tmp_path: Path, victim: str) -> None:
    boss = subprocess.Popen(
        [sys.executable, "-c", SCRIPT, str(tmp_path / "log")],
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    with boss:
        assert boss.stdout is not None
        pids = [int(word) for word in boss.stdout.readline().split()]
        assert len(pids) == 3
        assert all(alive(pid) for pid in pids)
        os.kill(boss.pid if victim == "supervisor" else pids[0], signal.SIGKILL)
        until(lambda: not any(alive(pid) for pid in pids), "all are gone", 10.0)
        if victim == "keeper":
            assert boss.wait(10) == 1  # GaveUpError


def test_restarts_back_off_and_run_out() -> None:
    deaths = Restarts(3, window_s=60, first_s=0.1, longest_s=5)
    assert [deaths.died(now) for now in (0.0, 1.0, 2.0, 3.0)] == [0.0, 0.1, 0.2, None]


def test_restarts_are_forgiven_after_a_while() -> None:
    deaths = Restarts(1, window_s=60)
    assert [deaths.died(now) for now in (0.0, 100.0, 200.0)] == [0.0, 0.0, 0.0]
