from __future__ import annotations

import re
from pathlib import Path

import pytest

from bus.options import NodeConfig, arguments


def test_all_options(tmp_path: Path) -> None:
    setup = tmp_path / "T1.json"
    setup.write_text("{}")
    line = f"--run r1 --name T1 --connect tcp/h:1 --home {tmp_path} --setup {setup} --clock realtime:2.5 --seed 7"
    assert arguments(line.split()) == NodeConfig("r1", "T1", "tcp/h:1", tmp_path, setup, "realtime", 2.5, 7)


def test_defaults() -> None:
    assert arguments(["--run", "r1"], name="world") == NodeConfig(
        "r1", "world", "tcp/127.0.0.1:7447", mode="fast", seed=0
    )


def test_the_environment_says_what_the_line_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUSTER_RUN", "from_env")
    monkeypatch.setenv("MUSTER_NAME", "from_env")
    monkeypatch.setenv("MUSTER_CLOCK", "realtime")
    monkeypatch.setenv("MUSTER_SEED", "4")
    config = arguments(["--name", "T1"])
    assert (config.run, config.name, config.mode, config.seed) == ("from_env", "T1", "realtime", 4)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--name T1", "--run is missing"),
        ("--run r", "--name is missing"),
        ("--run a/b --name T1", "'a/b' is not a name"),
        ("--run r --name *", "'\\*' is not a name"),
        ("--run r --name T1 --clock slow", "'slow' is none of"),
        ("--run r --name T1 --clock realtime:0", "'realtime:0' is none of"),
        ("--run r --name T1 --clock fast:2", "'fast:2' is none of"),
        ("--run r --name T1 --setup /nowhere.json", "there is no file"),
        ("--run r --name T1 --seed x", "invalid int value"),
    ],
)
def test_wrong_options_end_with_2(line: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        arguments(line.split())
    assert ended.value.code == 2
    capture = capsys.readouterr().err
    assert re.search(message, capture), capture


def test_wrong_values_in_the_environment_end_with_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("MUSTER_CLOCK", "slow")
    with pytest.raises(SystemExit) as ended:
        arguments(["--run", "r", "--name", "T1"])
    assert ended.value.code == 2
    assert "'slow' is none of" in capsys.readouterr().err
