"""The doctor: its findings on a sound machine, and what it says when something is wrong."""

from __future__ import annotations

import json
import socket
from pathlib import Path

import pytest

from ops import doctor
from ops.cli import main


@pytest.fixture(autouse=True)
def _own_registry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))


def test_a_sound_machine(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["ok"]
    checks = {finding["check"]: finding["found"] for finding in told["findings"]}
    assert checks["bus"].startswith("200 round trips: median")
    assert {"python", "clingo", "eclipse-zenoh", "packages", "clock", "directory", "ports"} <= checks.keys()


def test_a_directory_of_somebody_else_is_said_with_what_to_do(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "file"))
    finding = doctor._directory()
    assert not finding.ok
    assert finding.found.endswith("cannot be made: Not a directory")
    assert finding.advice == "set XDG_RUNTIME_DIR to a directory of your own, or unset it"
    assert "cannot be told" in doctor._port().found


def test_a_missing_package_is_said_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(doctor.PACKAGES, "clingo", "no_such_module")
    finding = doctor._package("clingo")
    assert not finding.ok
    assert "No module named 'no_such_module'" in finding.found
    assert finding.advice


def test_packages_of_the_same_name_from_elsewhere_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "OURS", ("ops", "json"))
    finding = doctor._own_packages()
    assert not finding.ok
    assert finding.found.startswith("json come from elsewhere")
    assert "environment of its own" in finding.advice


def test_a_port_in_use_is_no_obstacle(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.socket() as user:
        user.bind(("127.0.0.1", 0))
        user.listen()
        monkeypatch.setattr(doctor, "OUR_DEFAULT_PORT", user.getsockname()[1])
        finding = doctor._port()
    assert finding.ok
    assert "is in use" in finding.found


def test_a_bus_that_does_not_work_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(_config: object) -> list[float]:
        raise OSError("no loopback")

    monkeypatch.setattr(doctor, "_round_trips", broken)
    finding = doctor._bus()
    assert (finding.ok, finding.found) == (False, "no loopback")
    assert "loopback" in finding.advice
