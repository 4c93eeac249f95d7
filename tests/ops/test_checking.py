"""Plans and recorded runs before the independent checker, and diagnosis cases, from the command line."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import pytest

from ops.cli import main
from ops.plans import read_plan
from ops.recorded import check_run
from ops.tables import InputError
from reasoning.domain import load
from tests.ops import synthetic

STATIC = {"width": 5, "height": 3, "line": 5, "delay": 2}
PUBLISHED = load("factory").plans["published"]


def run(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    code = main(words)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_the_published_plan_is_right_but_for_the_failed_attach(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "check", "factory/published", "--json")
    told = json.loads(out)
    assert (code, told["ok"], told["violations"]) == (0, True, [])
    assert [(d["team"], d["step"], d["action"]) for d in told["discrepancies"]] == [("T4", 16, "attach(c1,w1)")]
    assert told["broken"] == [{"team": "T4", "robot": "c1", "step": 16}]


def test_the_published_exchanges_are_read_from_its_actions() -> None:
    loans = read_plan(PUBLISHED).loans
    assert [(x.from_, x.worker, x.give_step, x.to, x.as_, x.take_step) for x in loans] == [
        ("T2", "w3", 11, "T1", "w2", 13),
        ("T3", "w1", 13, "T4", "w2", 18),
    ]


def spoiled(change: dict[str, Any]) -> dict[str, Any]:
    """The published plan with the actions of some steps replaced: ``{"4": {16: [...]}}``."""
    data: dict[str, Any] = json.loads(PUBLISHED.read_text())
    for team, steps in change.items():
        for step, actions in steps.items():
            data["steps"][team][step] = actions
    return data


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"1": {0: ["fly(w1)"]}}, "unknown"),
        ({"1": {0: ["move(w1,left)", "lineShift"]}}, "off_grid"),
        ({"1": {7: ["move(w1,up)"]}}, "west_or_east"),
        ({"1": {3: ["workOn(w1,1)", "lineShift"]}}, "shift_at_work"),
    ],
)
def test_a_spoiled_plan_is_refused_with_the_rule(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, change: dict[str, Any], rule: str
) -> None:
    path = tmp_path / "spoiled.json"
    path.write_text(json.dumps(spoiled(change)))
    code, out, _ = run(capsys, "check", str(path), "--json")
    assert code == 1
    assert rule in {violation["rule"] for violation in json.loads(out)["violations"]}
    code, out, _ = run(capsys, "check", str(path))
    assert code == 1
    assert f"[{rule}]" in out


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("nothing", "expected a plan in JSON"),
        ("[1]", "expected a plan, as muster plan --json writes it"),
        ('{"teams": {"T1": {"steps": [["move(w1,right)"]]}}}', "does not say from which set-up it starts"),
        ('{"steps": {"1": []}, "setup": {"1": {"wings": 2}}}', "no domain takes the set-up in this plan"),
        ('{"teams": {}, "scenario": {"domain": "factory", "setup": {"teams": {}}}}', "scenario.setup: teams"),
    ],
)
def test_what_is_no_plan_is_wrong_input(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, text: str, expected: str
) -> None:
    path = tmp_path / "plan.json"
    path.write_text(text)
    code, _, err = run(capsys, "check", str(path))
    assert code == 2
    assert expected in err


def test_a_plan_without_a_setup_takes_a_scenarios(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    path.write_text('{"teams": {"T1": {"steps": [["move(w1,right)"]]}}}')
    code, out, _ = run(capsys, "check", str(path), "--scenario", "factory/one_worker")
    assert code == 1
    assert "is not stamped at the end [goal_stage]" in out
    assert "0 violations" not in out


def test_a_plan_for_nobody_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    path.write_text('{"teams": {"T9": {"steps": []}}}')
    code, _, err = run(capsys, "check", str(path), "--scenario", "factory/one_worker")
    assert code == 2
    assert "teams.T9: there is no such team; there are T1" in err


def recording() -> Any:
    made = synthetic.recording()
    return replace(made, scene=msgspec.structs.replace(made.scene, domain="factory"))


def test_a_run_that_was_right_has_no_violations() -> None:
    assert check_run(recording(), STATIC).violations == []


def test_a_run_in_which_an_action_was_out_of_order_has() -> None:
    made = recording()
    events = []
    for envelope in made.events:
        data = envelope.body.data
        if envelope.body.kind == "step_started" and (data["team"], data["step"]) == ("T1", 3):
            body = msgspec.structs.replace(envelope.body, data={**data, "actions": ["workOn(w1,2)"]})
            envelope = msgspec.structs.replace(envelope, body=body)
        events.append(envelope)
    found = check_run(replace(made, events=tuple(events)), STATIC).violations
    assert ("T1", 3, "work_column") in {(v.team, v.step, v.rule) for v in found}


def test_a_run_that_stopped_early_is_not_blamed_for_its_goal() -> None:
    made = recording()
    early = tuple(e for e in made.events if e.body.data.get("step", 0) < 10 and e.body.kind != "run_over")
    assert check_run(replace(made, events=early), STATIC).violations == []


@pytest.mark.parametrize("name", sorted(load("factory").cases))
def test_every_shipped_case_comes_out_as_it_says(capsys: pytest.CaptureFixture[str], name: str) -> None:
    code, out, _ = run(capsys, "diagnose", f"factory/{name}", "--json")
    assert code == 0, out
    assert json.loads(out)["as_expected"]


def test_a_case_of_the_users_own(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = load("factory").cases["push_did_not_happen"].read_text()
    path = tmp_path / "mine.toml"
    path.write_text('domain = "factory"\n' + text[: text.index("[expected]")])
    code, out, _ = run(capsys, "diagnose", str(path))
    assert code == 0
    assert "explanation 1: broken(c1)" in out
    assert "did not happen in step 1: push(c1)" in out


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("actions = []\n[before]\n", "domain: expected one of"),
        ('domain = "factory"\n[before]\n', "actions: is missing"),
        ('domain = "factory"\nactions = [["move("]]\n[before]\n', "must be terms of the domain"),
        ('domain = "factory"\nactions = []\nbounds = 3\n[before]\n', "bounds: unknown key; known here: before"),
    ],
)
def test_wrong_cases_are_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text)
    code, _, err = run(capsys, "diagnose", str(path))
    assert code == 2
    assert expected in err


def test_an_unknown_case_is_said_with_where_all_are_told() -> None:
    from ops.cases import read_case

    with pytest.raises(InputError, match="nor a shipped case"):
        read_case("factory/no_such_case")
