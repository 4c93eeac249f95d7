"""``muster plan``: the form of its JSON, the published optimum, and honest ends without a plan."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path
from typing import Any

import pytest

from ops import planning
from ops.cli import main
from ops.planning import solve
from ops.scenario import load

SECOND = 'teams.T2.workers=[{name="w1", at=[1,3], effector=1}, {name="w2", at=[1,2], effector=2}]'
LENDING = ["teams.T1.boxes=2", SECOND]


def run(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    code = main(words)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_one_worker_and_three_boxes_take_29_steps(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, out, _ = run(capsys, "plan", "factory/one_worker", "--json")
    told = json.loads(out)
    assert code == 0
    assert (told["status"], told["makespan"], told["lower_bound"]) == ("optimal", 29, 29)
    assert told["proof"].startswith("28 steps refuted")
    assert len(told["teams"]["T1"]["steps"]) == 29
    assert told["exchanges"] == []
    path = tmp_path / "plan.json"
    path.write_text(out)
    code, out, _ = run(capsys, "check", str(path), "--json")
    assert (code, json.loads(out)["violations"]) == (0, [])


@pytest.mark.slow
def test_two_teams_lend(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    more = [word for assignment in LENDING for word in ("--set", assignment)]
    code, out, _ = run(capsys, "plan", "factory/broken_worker", "--json", *more)
    told = json.loads(out)
    assert code == 0
    assert told["status"] == "optimal"
    assert set(told) >= {"status", "makespan", "lower_bound", "proof", "exchanges", "teams", "questions", "seconds"}
    for exchange in told["exchanges"]:
        assert set(exchange) == {"worker", "from", "give_step", "to", "take_step", "as"}
        assert exchange["take_step"] >= exchange["give_step"] + 2
    path = tmp_path / "plan.json"
    path.write_text(out)
    assert run(capsys, "check", str(path))[0] == 0


def test_a_plan_for_people_has_a_line_a_step(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "plan", "factory/broken_worker")
    assert code == 0
    assert out.startswith("optimal: 15 steps, no fewer than 15\nproof: 14 steps refuted")
    assert out.count("workOn(w1,1)") == 6


def test_a_goal_that_cannot_be_reached_has_a_reason(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "plan", "factory/one_worker", "--json", "--set", "teams.T1.workers=[]")
    told = json.loads(out)
    assert code == 1
    assert (told["status"], told["teams"]) == ("infeasible", {})
    assert "T1 can never finish alone" in told["proof"]


def test_a_search_that_is_cut_short_says_that_it_does_not_know(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "plan", "factory/four_teams", "--json", "--set", "limits.search_s=0.3")
    told = json.loads(out)
    assert code == 1
    assert (told["status"], told["gap"]) == ("unknown", None)
    assert told["lower_bound"] > 0
    assert "limits.search_s" in told["proof"]
    assert told["seconds"] < 20


@pytest.mark.slow
def test_a_budget_is_kept(capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = run(capsys, "plan", "factory/four_teams", "--json", "--budget", "5", "--set", "teams.T2.boxes=8")
    told = json.loads(out)
    assert told["status"] != "optimal", "make the scenario harder: the budget was not needed"
    assert 4.5 <= told["seconds"] <= 5.5


@pytest.mark.slow
def test_a_search_that_is_stopped_tells_its_best_plan_the_bound_and_the_gap() -> None:
    heard: list[str] = []
    plan = solve(load("factory/broken_worker", LENDING), heard.append, stop=lambda: "are known" in "".join(heard))
    assert plan.status == "feasible"
    assert plan.gap == plan.makespan - plan.lower_bound > 0
    assert "interrupted" in plan.proof
    assert max(len(steps) for steps in plan.teams.values()) == plan.makespan
    best = solve(load("factory/broken_worker", LENDING), heard.append)
    assert plan.lower_bound <= best.makespan <= plan.makespan


def test_an_interrupt_tells_what_is_known_so_far(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    ask = planning._ask

    def interrupted(*args: Any) -> Any:
        os.kill(os.getpid(), signal.SIGINT)
        return ask(*args)

    monkeypatch.setattr(planning, "_ask", interrupted)
    code, out, err = run(capsys, "plan", "factory/four_teams", "--json")
    told = json.loads(out)
    assert (code, told["status"], told["questions"], err) == (1, "unknown", 4, "")
    assert "the search was interrupted" in told["proof"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize("word", ["-1", "inf", "nan", "soon"])
def test_a_budget_is_a_number_of_seconds(capsys: pytest.CaptureFixture[str], word: str) -> None:
    with pytest.raises(SystemExit):
        main(["plan", "factory/one_worker", f"--budget={word}"])
    assert "--budget" in capsys.readouterr().err
