"""Whole systems as a user runs them: disturbed from a second terminal, interrupted, without a supervisor."""

from __future__ import annotations

import contextlib
import json
import os
import pty
import queue
import select
import signal
import socket
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest

from bus.messages import RunOver
from bus.node import NodeConfig
from bus.transport import TransportError
from bus.zenoh_transport import CLIENT, connect
from ops.children import environment
from ops.compile import compile_scenario
from ops.scenario import load as load_scenario
from ops.seat import Ears, Seat
from tests.ops.test_compose import TEAMS, services
from tests.system.whole import running

pytestmark = pytest.mark.slow

MUSTER = [sys.executable, "-m", "ops.cli"]


@pytest.fixture
def own(tmp_path: Path) -> dict[str, str]:
    """An environment with a registry of runs of its own."""
    return {**environment(), "XDG_RUNTIME_DIR": str(tmp_path / "runtime")}


def muster(own: dict[str, str], *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*MUSTER, *words], env=own, capture_output=True, text=True, timeout=120, check=False)


def test_a_recording_passes_the_checker(own: dict[str, str], tmp_path: Path) -> None:
    muster(own, "run", "factory/two_broken", "--headless", "--record", str(tmp_path / "run"))
    done = muster(own, "check", str(tmp_path / "run"), "--json")
    told = json.loads(done.stdout)
    assert (done.returncode, told["violations"], told["invariants"]) == (0, [], [])


def test_an_unreachable_goal_ends_with_the_reason(own: dict[str, str]) -> None:
    done = muster(own, "run", "factory/one_worker", "--json", "--set", "teams.T1.workers=[]")
    told = json.loads(done.stdout)
    assert done.returncode == 1
    assert told["reason"].startswith("no plan: T1 can never finish alone")


def test_a_given_plan_is_executed_first(own: dict[str, str], tmp_path: Path) -> None:
    plan = tmp_path / "plan.json"
    plan.write_text(muster(own, "plan", "factory/broken_worker", "--json").stdout)
    done = muster(
        own, "run", "factory/broken_worker", "--headless", "--plan", str(plan), "--set", "verdict.optimal=true"
    )
    assert done.returncode == 0, done.stdout
    assert "from step 0 on, given" in done.stdout


def test_a_running_system_is_disturbed_from_a_second_terminal(own: dict[str, str]) -> None:
    words = ["run", "factory/team_killed", "--headless", "--clock", "realtime:2", "--set", "fault=[]"]
    words += ["--set", 'verdict={eventually = [{event = "repair", team = "T1", robot = "w1"}]}']
    with subprocess.Popen([*MUSTER, *words], env=own, stdout=subprocess.PIPE, text=True) as run:
        assert run.stdout is not None
        lines = []
        for line in run.stdout:
            lines.append(line)
            if line.rstrip().endswith("step 1"):
                break
        refused = muster(own, "inject", "break", "T1.w9")
        taken = muster(own, "inject", "break", "T1.w1", "--json")
        lines += run.stdout.readlines()
    assert (refused.returncode, "there is no robot T1.w9" in refused.stderr) == (2, True)
    assert json.loads(taken.stdout)["accepted"]
    assert run.returncode == 0, "".join(lines)


@pytest.mark.parametrize("way_out", ["q", "ctrl-c", "sigterm"])
def test_leaving_the_dashboard_leaves_the_terminal_clean(own: dict[str, str], way_out: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of forks among threads: exec follows at once
        pid, terminal = pty.fork()
    if pid == 0:
        os.execve(sys.executable, [*MUSTER, "run", "factory/team_killed", "--clock", "realtime"], own)
    shown = read_until(terminal, b"\x1b[?1049h", 30)
    shown += read_until(terminal, b"T1", 30)
    if way_out == "sigterm":
        os.kill(pid, signal.SIGTERM)
    else:
        os.write(terminal, b"q" if way_out == "q" else b"\x03")
    shown += read_until(terminal, None, 30)
    _, status = os.waitpid(pid, 0)
    os.close(terminal)
    assert os.waitstatus_to_exitcode(status) == 130
    assert shown.rfind(b"\x1b[?1049l") > shown.rfind(b"\x1b[?1049h")
    assert shown.rfind(b"\x1b[?25h") > shown.rfind(b"\x1b[?25l")
    assert shown.rstrip().endswith(b"interrupted")


def read_until(terminal: int, mark: bytes | None, limit_s: float) -> bytes:
    """What the terminal shows until the mark comes, or (None) until the other side is gone."""
    seen, deadline = b"", time.monotonic() + limit_s
    while time.monotonic() < deadline and (mark is None or mark not in seen):
        ready, _, _ = select.select([terminal], [], [], 0.1)
        if ready:
            try:
                seen += os.read(terminal, 65536)
            except OSError:
                break
    return seen


SMALL = 'story = "Four small teams."\ndomain = "factory"\n' + "".join(
    f'[teams.{team}]\nboxes = 1\nworkers = [{{name = "w1", at = [1, 3], effector = 1}}]\n'
    f'carrier = {{name = "c1", at = [1, 1]}}\n'
    for team in TEAMS
)


def test_the_commands_of_docker_compose_reach_the_goal(tmp_path: Path) -> None:
    """As containers would: nobody starts anybody again, everybody is started at once."""
    scenario = tmp_path / "small.toml"
    scenario.write_text(SMALL)
    compile_scenario(load_scenario(str(scenario))).write(tmp_path)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    here = {
        "python": sys.executable,
        "tcp/0.0.0.0:7447": endpoint,
        "tcp/router:7447": endpoint,
        "realtime": "realtime:10",
    }
    over: queue.SimpleQueue[RunOver] = queue.SimpleQueue()
    ears = Ears(lambda _: None, lambda _fault, done: done(), over.put, lambda _: None, lambda _: None)
    with contextlib.ExitStack() as stack:
        for service, command in services().items():
            if service not in ("setup", "dashboard"):
                argv = [here.get(word, word.replace("/run/muster", str(tmp_path))) for word in command]
                stack.enter_context(started(argv, tmp_path / f"{service}.log"))
        stack.enter_context(Seat(NodeConfig("compose", "supervisor", endpoint, outsider=True), ears))
        last = over.get(timeout=90)
    assert last.goal, last.reason


@contextlib.contextmanager
def started(argv: list[str], log: Path) -> Iterator[None]:
    with log.open("wb") as out, subprocess.Popen(argv, env=environment(), stdout=out, stderr=out) as process:
        try:
            yield
        finally:
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()


def test_a_secure_run_shuts_strangers_out_and_leaves_no_keys_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with running("factory/team_killed", tmp_path, "--clock", "fast", "--secure") as live:
        assert live.connect.startswith("tls/")
        monkeypatch.setitem(CLIENT, "connect/timeout_ms", 1000)
        with pytest.raises(TransportError, match="identity"):
            connect(live.connect)
        over = live.wait()
    assert over.code == 0, over.told
    assert over.told["messages"]["refused"] == 0
    assert not list(tmp_path.rglob("*.pem"))
