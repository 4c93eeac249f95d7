"""docker-compose starts what the supervisor starts, by the same commands."""

from __future__ import annotations

import json
import re
from pathlib import Path, PurePosixPath

import msgspec
import pytest

from bus.scene import Scene
from ops.compile import compile_scenario
from ops.processes import Layout, commands
from ops.scenario import load

ROOT = Path(__file__).parents[2]
TEAMS = ("T1", "T2", "T3", "T4")


def services() -> dict[str, list[str]]:
    """The commands in docker-compose.yml; they are written as JSON on one line so that no YAML parser is needed."""
    found: dict[str, list[str]] = {}
    service = ""
    text = (ROOT / "docker-compose.yml").read_text()
    for line in text[text.index("\nservices:") :].splitlines():
        if header := re.fullmatch(r"  (\w+):", line):
            service = header[1]
        elif command := re.fullmatch(r"    command: (\[.*\])", line):
            found[service] = json.loads(command[1])
    return found


def test_compose_starts_what_the_supervisor_starts() -> None:
    run = PurePosixPath("/run/muster")
    layout = Layout(
        run="compose",
        teams=TEAMS,
        connect="tcp/router:7447",
        home=run,
        setups=run,
        record=run,
        clock="realtime",
        listen="tcp/0.0.0.0:7447",
    )
    found = services()
    extra = {name: found.pop(name) for name in ("setup", "dashboard")}
    assert found == commands(layout)
    assert extra["dashboard"] == ["muster", "watch", "--connect", layout.connect, "--run", layout.run]
    assert extra["setup"][:2] == ["muster", "compile"]


def test_the_default_scenario_has_the_teams_that_there_are_services_for() -> None:
    setup = services()["setup"]
    default = re.fullmatch(r"\$\{SCENARIO:-(.*)\}", setup[2])
    assert default is not None
    assert load(default[1]).teams == TEAMS
    assert setup[setup.index("--teams") + 1] == ",".join(TEAMS)


def test_the_image_has_every_package() -> None:
    dockerfile = (ROOT / "Dockerfile").read_text()
    for package in ("agents", "bus", "encodings", "ops", "reasoning", "world"):
        assert f"COPY {package} {package}\n" in dockerfile


@pytest.mark.parametrize("name", ["factory/four_teams", "factory/team_killed"])
def test_compiled_files_say_no_more_than_a_process_may_know(name: str, tmp_path: Path) -> None:
    compiled = compile_scenario(load(name))
    compiled.write(tmp_path)
    scene = msgspec.json.decode((tmp_path / "world.json").read_bytes(), type=Scene)
    assert {entity.team for entity in scene.entities} == set(compiled.teams)
    assert len(scene.faults) == len(compiled.scenario.faults)
    coordinator = json.loads((tmp_path / "coordinator.json").read_text())
    assert coordinator == {"teams": list(compiled.teams), "delay": 2, "plan": None, "conducted": True}
    for team in compiled.teams:
        told = json.loads((tmp_path / f"{team}.json").read_text())
        assert set(told) == {"domain", "team", "static", "conflicts"}
        assert "at(" not in json.dumps(told)


def test_the_agents_take_the_files(tmp_path: Path) -> None:
    """The agents define these types; ops may not import them, a test may."""
    from agents.setups import CoordinatorSetup, TeamSetup

    compiled = compile_scenario(load("factory/four_teams"))
    compiled.write(tmp_path)
    assert msgspec.json.decode((tmp_path / "coordinator.json").read_bytes(), type=CoordinatorSetup).teams == TEAMS
    assert msgspec.json.decode((tmp_path / "T2.json").read_bytes(), type=TeamSetup).team == "T2"
