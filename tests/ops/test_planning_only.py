"""Domains whose scenarios can be planned, but not run: everybody says so, and planning works from end to end."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ops.cli import main
from ops.places import runnable, shipped
from reasoning.domain import Domain, domains, load

ALONE = [name for name in domains() if not load(name).data.conducted]


@pytest.fixture
def name(monkeypatch: pytest.MonkeyPatch) -> str:
    """A scenario of a domain of which the world is taken to know no skills."""
    monkeypatch.setattr(Domain, "can_run", property(lambda domain: domain.name != ALONE[0]))
    return f"{ALONE[0]}/bedroom"


@pytest.mark.parametrize("command", ["run", "compile"])
def test_what_cannot_be_run_is_refused_with_a_clear_sentence(
    command: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [command, name, *(["-o", str(tmp_path)] if command == "compile" else [])]
    assert main(words) == 2
    assert "cannot be run yet: the world does not know its skills" in capsys.readouterr().err


def test_validate_and_list_say_so(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", name]) == 0
    assert "can be planned and checked, but not run yet" in capsys.readouterr().out
    assert main(["validate", name, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["can_run"] is False
    assert main(["list"]) == 0
    before, after = capsys.readouterr().out.split("scenarios that can be planned, but not run yet")
    assert name in after
    assert name not in before
    assert name not in runnable()
    assert name in shipped()


def test_no_plan_and_a_refused_plan_end_with_exit_code_1(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", name, "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert (told["status"], told["refused"], told["teams"]) == ("infeasible", [], {})
    assert main(["plan", name, "--set", "house.geometry=none"]) == 1
    told = capsys.readouterr().out
    assert told.startswith("refused: 4 steps, but the checker finds that it cannot be done")
    assert "[no_way]" in told


def test_a_plan_in_json_is_accepted_by_the_checker(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plan", name, "--json", "--set", "teams.bedroom.furniture=[]"]) == 0
    told = capsys.readouterr().out
    assert (json.loads(told)["status"], json.loads(told)["makespan"]) == ("optimal", 4)
    (tmp_path / "plan.json").write_text(told)
    assert main(["check", str(tmp_path / "plan.json")]) == 0


def test_teams_that_lend_nobody_are_planned_each_for_itself(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    more = "teams.kitchen={room='kitchen', deposit=[0,1,0,1], robots=[{name='r9', at=[3,3]}]}"
    assert main(["plan", name, "--json", "--set", "teams.bedroom.furniture=[]", "--set", more]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["makespan"], told["lower_bound"]) == (4, 4)
    assert {team: len(plan["steps"]) for team, plan in told["teams"].items()} == {"bedroom": 4, "kitchen": 0}
