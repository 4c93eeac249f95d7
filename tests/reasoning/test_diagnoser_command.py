"""What ``muster diagnose`` says of probabilities and inspections."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ops.cli import main
from reasoning.domain import load

CASE = load("factory").cases["frail_worker"].read_text()


def test_probabilities_and_the_inspections_as_text(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", "factory/frail_worker"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "explanation 1 (95.4%): broken(w3)" in lines
    assert lines[-4:] == [
        "inspections to be expected: 1.00 (in arbitrary order 1.00)",
        "  inspect c1",
        "    broken (4.6%): broken: c1",
        "    sound (95.4%): broken: w3",
    ]


def test_probabilities_and_the_inspections_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", "factory/three_pairs", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert sum(one["probability"] for one in told["diagnoses"]) == pytest.approx(1.0)
    assert told["expected_inspections"] == pytest.approx(3.0)
    assert told["expected_in_arbitrary_order"] == pytest.approx(3.8)
    assert told["inspections"]["if_sound"]["inspect"] == "c2"


def test_inspections_for_what_the_preference_drops(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", "factory/push_did_not_happen"]) == 0
    text = capsys.readouterr().out
    assert "set aside: broken(w3)" in text
    assert "inspections" not in text
    assert main(["diagnose", "factory/push_did_not_happen", "--all"]) == 0
    assert "sound (50.0%): broken: w3" in capsys.readouterr().out


@pytest.mark.parametrize("rate", ["0", "1.0", "-0.5", "nan", "2"])
def test_a_wrong_rate_is_refused_with_its_place(capsys: pytest.CaptureFixture[str], tmp_path: Path, rate: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text('domain = "factory"\n' + CASE.replace("c1 = 0.001", f"c1 = {rate}"))
    assert main(["diagnose", str(path)]) == 2
    assert "rates.c1: expected a robot's name and a number between 0 and 1" in capsys.readouterr().err


def test_other_probabilities_than_the_file_says(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text('domain = "factory"\n' + CASE.replace("[0.95, 0.05]", "[0.5, 0.5]"))
    assert main(["diagnose", str(path)]) == 1
    assert "expected the probabilities [0.5, 0.5]" in capsys.readouterr().out
