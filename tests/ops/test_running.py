"""A whole run around stand-ins for the minds and the world: start, faults, the last word, the ways out."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from bus.messages import Event
from ops import running
from ops.children import environment
from ops.processes import Layout, commands
from ops.recording import load as load_recording
from ops.registry import listing
from ops.running import Options
from ops.scenario import load
from ops.shows import Lines, Silence
from tests.system.whole import until

STAND_IN = """
import sys
from bus.messages import ProcessFault, RunOver
from bus.node import arguments, open_node
config = arguments(sys.argv[1:])._replace(outsider=True)
with open_node(config) as node:
    node.emit("started", f"{node.name} is up", incarnation=node.incarnation, role="team", recovered=False)
    if node.name == "world" and node.journal.get("done") is None:
        node.journal.put("done", b"1")
        node.ask("supervisor", ProcessFault("kill", "T1"), 20.0)
    if node.name == "coordinator":
        LAST
    for turn in node.turns():
        pass
"""
LATE = """
import threading
from ops.recorder import main
threading.Event().wait(2.0)
main()
"""
OVER = 'node.ask("supervisor", RunOver(True, "all is done", 5, 0), 20.0)'
OVER_AFTER_THE_RESTART = f"""
        from bus.messages import EventsFrom, Ping
        node.ask("recorder", Ping(), 20.0)
        while b"T1 restarted" not in b"".join(node.ask("supervisor", EventsFrom(1, 1), 20.0).packed):
            node.post.wait(0.05)
        {OVER}
"""


def stand_ins(monkeypatch: pytest.MonkeyPatch, last: str) -> None:
    """Replace world, coordinator and teams by processes that only say that they are there."""

    def replaced(layout: Layout) -> dict[str, list[str]]:
        result = commands(layout)
        for name in ("world", "coordinator", *layout.teams):
            result[name] = [sys.executable, "-c", STAND_IN.replace("LAST", last), *result[name][3:]]
        return result

    monkeypatch.setattr(running, "commands", replaced)


@pytest.fixture(autouse=True)
def _own_registry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "runtime"))


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def needs_person(recording: Path) -> list[dict[str, object]]:
    events = [envelope.body for envelope in load_recording(recording).events]
    return [event.data for event in events if isinstance(event, Event) and event.kind == "needs_person"]


def test_a_run_from_start_to_verdict(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stand_ins(monkeypatch, OVER)
    outcome = running.execute(load("factory/team_killed"), Options(record=tmp_path / "kept"), Silence())
    assert (outcome.report.goal, outcome.report.makespan, outcome.report.reason) == (True, 5, "all is done")
    assert outcome.home == tmp_path / "kept"
    assert (tmp_path / "kept" / "logs" / "T1.log").exists()
    assert not any(alive(pid) for pid in outcome.pids)
    assert listing() == []


@pytest.mark.slow
def test_a_run_that_is_over_before_its_recorder_has_opened_is_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stand_ins(monkeypatch, OVER)
    swift = running.commands

    def late(layout: Layout) -> dict[str, list[str]]:
        result = swift(layout)
        result["recorder"] = [sys.executable, "-c", LATE, *result["recorder"][3:]]
        return result

    monkeypatch.setattr(running, "commands", late)
    outcome = running.execute(load("factory/team_killed"), Options(record=tmp_path / "kept"), Silence())
    assert outcome.report.reason == "all is done"
    recording = load_recording(tmp_path / "kept")
    assert recording.complete
    assert {event.src for event in recording.events} >= {"world", "coordinator", "supervisor"}


@pytest.mark.slow
def test_a_fault_on_a_process_is_carried_out_and_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # The world asks for T1 to be killed; the coordinator waits for that, and for a recorder, before it ends the run.
    stand_ins(monkeypatch, OVER_AFTER_THE_RESTART)
    outcome = running.execute(load("factory/team_killed"), Options(record=tmp_path / "kept"), Silence())
    restarted = next(c for c in outcome.report.conditions if c.text.startswith("eventually process"))
    assert restarted.ok
    assert len(outcome.pids) == 1 + 1 + 1 + 1 + 2 + 1


@pytest.mark.slow
def test_a_coordinator_that_never_ends_meets_the_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stand_ins(monkeypatch, "pass")
    scenario = load("factory/team_killed", ["limits.wall_s=2"])
    outcome = running.execute(scenario, Options(record=tmp_path / "kept"), Silence())
    assert [needed["cause"] for needed in needs_person(tmp_path / "kept")] == ["too_long"]
    assert outcome.report.reason == "waited 2 s for: the coordinator's last word (limits.wall_s)"
    assert not outcome.report.goal
    assert not any(alive(pid) for pid in outcome.pids)


@pytest.mark.slow
@pytest.mark.parametrize(("limit_s", "reached"), [(3.0, False), (1000.0, True)])
def test_what_is_done_after_the_limit_of_simulated_time_does_not_count(
    tmp_path: Path, limit_s: float, reached: bool
) -> None:
    scenario = load("factory/two_loans", [f"limits.simulated_s={limit_s}"])
    report = running.execute(scenario, Options(record=tmp_path / "kept"), Silence()).report
    assert report.goal is reached
    assert reached or report.reason == "not over after 3 simulated seconds (limits.simulated_s)"


@pytest.mark.slow
def test_a_process_that_keeps_dying_ends_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stand_ins(monkeypatch, "raise SystemExit(7)")
    scenario = load("factory/team_killed", ["limits.restarts=1"])
    outcome = running.execute(scenario, Options(record=tmp_path / "kept"), Lines())
    assert "coordinator died 2 times, last: ended by itself with exit code 7" in outcome.report.reason
    (needed,) = needs_person(tmp_path / "kept")
    assert needed == {"cause": "gave_up", "text": f"a person is needed: {outcome.report.reason}"}
    assert needed["text"] in capsys.readouterr().out
    assert outcome.report.exit_code in (1, 3)
    assert not any(alive(pid) for pid in outcome.pids)


RUN = """
import sys
from ops import running
from ops.cli import main
from ops.processes import commands
def replaced(layout):
    result = commands(layout)
    for name in ("world", "coordinator", *layout.teams):
        result[name] = [sys.executable, "-c", {code!r}, *result[name][3:]]
    return result
running.commands = replaced
sys.exit(main(["run", "factory/team_killed", "--headless", "--record", sys.argv[1]]))
"""


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_interrupting_leaves_nobody_behind(tmp_path: Path, number: signal.Signals) -> None:
    script = RUN.format(code=STAND_IN.replace("LAST", "pass"))
    user = subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path / "kept")],
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with user:
        assert user.stdout is not None
        for line in user.stdout:  # until both teams were started and one killed and restarted
            if "T1 restarted" in line:
                break
        pids = children_of(user.pid)
        assert len(pids) >= 6
        os.kill(user.pid, number)
        user.wait(30)
    assert user.returncode == (-9 if number == signal.SIGKILL else 130)
    until(lambda: not any(map(alive, pids)), "all are gone", 10.0)


def children_of(pid: int) -> list[int]:
    """All descendants, by /proc."""
    parents: dict[int, list[int]] = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            try:
                stat = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            parents.setdefault(int(stat[1]), []).append(int(entry.name))
    found, open_ = [], [pid]
    while open_:
        below = parents.get(open_.pop(), [])
        found += below
        open_ += below
    return found
