"""The command line: help, exit codes, JSON, and words that help when the input is wrong."""

from __future__ import annotations

import json
import re
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from bus.keys import NAME
from ops.children import environment
from ops.cli import main
from ops.commands import COMMANDS
from ops.commands.common import has_screen
from ops.registry import Running, find, listing, new_name, registered
from ops.tables import InputError


@pytest.fixture(autouse=True)
def _own_registry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs of the machine that tests run on are none of their business."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "runtime"))


def run(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    try:
        code = main(words)
    except SystemExit as end:
        code = int(end.code or 0)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(capsys: pytest.CaptureFixture[str], command: str) -> None:
    code, out, _ = run(capsys, command, "--help")
    assert code == 0
    assert out.startswith(f"usage: muster {command}")
    for line in out.splitlines():
        assert "None" not in line


def test_the_help_names_every_command_and_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "--help")
    assert code == 0
    for command in COMMANDS:
        assert re.search(rf"^    {command}\b", out, re.MULTILINE), command
    assert "2 wrong input; 3 an invariant" in out


def test_without_a_command_help_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys)
    assert code == 2
    assert "COMMAND" in out


def test_an_unknown_command_is_wrong_input(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = run(capsys, "fly")
    assert code == 2
    assert "invalid choice: 'fly'" in err


def test_the_module_can_be_run_from_anywhere(tmp_path: Path) -> None:
    (tmp_path / "bus.py").write_text("raise SystemExit('the user has a bus.py too')")
    done = subprocess.run(
        [sys.executable, "-m", "ops.cli", "list"], cwd=tmp_path, env=environment(), capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "factory/one_worker" in done.stdout


def test_list_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "list", "--json")
    assert code == 0
    told = json.loads(out)
    assert told["scenarios"]["factory/four_teams"].startswith("The published set-up")
    assert told["running"] == []


def test_validate(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "validate", "factory/broken_worker")
    assert code == 0
    assert "2 teams, 6 bodies, 1 fault\n" in out
    code, out, _ = run(capsys, "validate", "factory/broken_worker", "--json", "--set", "teams.T2.boxes=3")
    assert code == 0
    assert json.loads(out)["bodies"] == 8


def test_validate_says_what_is_wrong(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, out, err = run(capsys, "validate", "factory/broken_worker", "--set", "teams.T1.boxes=many", "--json")
    assert code == 2
    assert "teams.T1.boxes: expected an integer" in err
    assert "teams.T1.boxes" in json.loads(out)["error"]
    (tmp_path / "bad.toml").write_text("story = 'x'\ndomain = 'factory'\nteems = 1\n")
    code, _, err = run(capsys, "validate", str(tmp_path / "bad.toml"))
    assert code == 2
    assert "bad.toml" in err


def test_compile_writes_the_files(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, out, _ = run(capsys, "compile", "factory/team_killed", "-o", str(tmp_path), "--json")
    assert code == 0
    names = {Path(file).name for file in json.loads(out)["files"]}
    assert (
        names
        == {"world.json", "coordinator.json", "T1.json", "T2.json"}
        == {file.name for file in tmp_path.glob("*.json")}
    )
    code, _, err = run(capsys, "compile", "factory/team_killed", "-o", str(tmp_path), "--teams", "T1")
    assert code == 2
    assert "expected exactly the teams T1" in err


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["run", "factory/none"], "neither a file nor a shipped scenario"),
        (["run", "factory/one_worker", "--clock", "slow"], "expected fast, realtime, or realtime:FACTOR"),
        (["run", "factory/one_worker", "--clock", "realtime:-1"], "expected fast, realtime, or realtime:FACTOR"),
        (["run", "factory/one_worker", "--port", "70000"], "expected a number from 0 to 65535"),
        (["run", "factory/one_worker", "--host", "192.0.2.1"], "expected an address of this machine"),
        (["run", "factory/one_worker", "--plan", "/no/such/plan.json"], "/no/such/plan.json: cannot be read"),
        (["run", "factory/one_worker", "--record", "/dev/null"], "expected a directory, this is a file"),
        (["run", "factory/one_worker", "--record", str(Path(__file__).parent)], "there is something else in this"),
        (["plan", "factory/one_worker", "--set", "teams.T1.boxes=x"], "found 'x' (--set teams.T1.boxes=x)"),
        (["plan", "factory/one_worker", "--set", "seed=2", "--set", "teams.T1.boxs=1"], "(--set teams.T1.boxs=1)"),
        (["run", "factory/one_worker", "--record", "/dev/null/x"], "cannot be made: Not a directory"),
        (["compile", "factory/one_worker", "-o", "/dev/null/x"], "cannot be made: Not a directory"),
        (["reference", "-o", "/dev/null/x"], "cannot be made: Not a directory"),
        (
            ["check", "factory/one_worker"],
            "a recording nor a shipped plan. Shipped is factory/published;",
        ),
        (["diagnose", "factory/robot_mvd"], "Did you mean factory/robot_moved? muster list"),
        (["diagnose", "factory/x"], "neither a file nor a shipped case. muster list"),
        (["inject", "brake", "T1.w1"], "unknown kind 'brake'. Supported: break ROBOT; move BODY"),
        (["inject", "pause", "T1"], "pause needs it"),
        (["inject", "drop", "T1", "share=2"], "share: expected a number from 0 to 1"),
        (["inject", "deadline", "kitchen", "units=soon"], "units: expected units of time, 0 for no deadline"),
        (["inject", "deadline", "kitchen"], "units: deadline needs it"),
        (["inject", "move", "T1.w1", "x=1"], "expected either x and y"),
        (["inject", "break", "T1.w1", "x=1"], "break does not take it"),
        (["inject", "break", "T1.w1", "x"], "expected NAME=VALUE"),
        (["inject", "break", "T1.w1"], "nothing is running here"),
        (["watch"], "nothing is running here"),
        (["watch", "--connect", "tcp/127.0.0.1:1"], "say which run"),
        (["replay", "/no/such", "--speed", "0"], "expected a number, more than 0"),
        (["replay", "/no/such", "--speed", "nan"], "expected a number, more than 0"),
        (["run", "factory/one_worker", "--clock", "realtime:inf"], "clock.factor: expected a number <= 1000000.0"),
        (["run", "factory/one_worker", "--seed", "-1"], "seed: expected a whole number >= 0"),
        (["run", "factory/one_worker", "--seed", str(10**20)], "seed: "),
        (["bench", "nothing"], "no benchmark 'nothing'"),
    ],
)
def test_wrong_input_is_said_and_exits_with_two(
    capsys: pytest.CaptureFixture[str], words: list[str], expected: str
) -> None:
    code, out, err = run(capsys, *words)
    assert code == 2
    assert expected in err
    assert out == ""


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["inject", "break"], "arguments are required: TARGET\n"),
        (["bench"], "arguments are required: NAME\n"),
        (["plan", "factory/one_worker", "--budget", "soon"], "expected seconds, 0 or more, not soon"),
        (["watch", "--json"], "usage: muster watch [-h] [--run NAME]"),
        (["list", "there"], "muster list: error: unrecognized arguments: there\n"),
    ],
)
def test_what_is_missing_or_no_number_is_told(
    capsys: pytest.CaptureFixture[str], words: list[str], expected: str
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(words)
    assert expected in capsys.readouterr().err


@pytest.mark.parametrize("scenario", ["one_worker", "mine one", "größer", "a" * 60, "-", ".hidden", "日本"])
def test_a_run_gets_a_name_that_the_bus_takes_whatever_the_file_is_called(scenario: str) -> None:
    assert NAME.fullmatch(new_name(scenario))


def test_where_no_runs_can_be_listed_the_way_out_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", "/dev/null")
    code, out, err = run(capsys, "list")
    assert (code, out) == (2, "")
    assert "set XDG_RUNTIME_DIR to a directory of your own" in err


@pytest.mark.parametrize(("terminal", "drawn"), [("xterm-256color", True), ("dumb", False), ("", False)])
def test_a_terminal_that_cannot_draw_is_no_screen(monkeypatch: pytest.MonkeyPatch, terminal: str, drawn: bool) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("TERM", terminal)
    assert has_screen() is drawn


def test_a_port_in_use_is_said_with_the_way_out(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as user:
        user.bind(("127.0.0.1", 0))
        user.listen()
        code, _, err = run(capsys, "run", "factory/one_worker", "--port", str(user.getsockname()[1]))
    assert code == 2
    assert "cannot be used" in err
    assert "leave --port out" in err


def test_running_systems_are_found_by_name() -> None:
    one = Running("one", "tcp/127.0.0.1:1", "/tmp/one", 1, "a.toml")
    two = Running("two", "tcp/127.0.0.1:2", "/tmp/two", 1, "b.toml")
    with registered(one):
        assert find() == one
        with registered(two):
            assert {running.run for running in listing()} == {"one", "two"}
            with pytest.raises(InputError, match="several systems are running"):
                find()
            assert find("two") == two
            assert find(None, "tcp/127.0.0.1:2").run == "two"
            assert find("far", "tcp/10.0.0.1:7447").connect == "tcp/10.0.0.1:7447"
            with pytest.raises(InputError, match="no run 'three'"):
                find("three")
    assert listing() == []


def test_files_of_dead_runs_are_removed() -> None:
    gone = subprocess.Popen([sys.executable, "-S", "-c", ""])
    gone.wait()
    with registered(Running("dead", "tcp/127.0.0.1:1", "/tmp", gone.pid, "")):
        assert listing() == []


def test_a_benchmark_tells_what_it_measures_without_measuring(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "world", "--help"]) == 0
    assert capsys.readouterr().out.startswith("How fast is the world?")
