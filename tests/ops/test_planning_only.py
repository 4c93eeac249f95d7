"""Domains whose teams act for themselves: planning works from end to end."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ops.cli import main
from reasoning.domain import domains, load

ALONE = [name for name in domains() if not load(name).data.conducted]


@pytest.fixture
def name() -> str:
    return f"{ALONE[0]}/bedroom"


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
