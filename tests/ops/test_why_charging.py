"""``muster why`` about the charging factory: all kinds of questions, as shipped."""

from __future__ import annotations

import pytest

from ops.cli import main
from tests.ops.test_why import ask, members

DRAINED = "charging/one_worker"


@pytest.mark.slow
def test_why_not_one_step_shorter(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, DRAINED)
    assert part["claim"] == "T1 cannot finish in 16 steps"
    assert members(part) >= {
        "stamped(1)", "gone(1)", "steps(16)", "robot(w1)", "robot(c1)", "start(battery(w1),1)", "rule(battery)"
    }  # fmt: skip
    assert ask(capsys, DRAINED, "--within", "17", code=1)[0]["status"] == "possible"


def test_why_no_plan_however_long(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, DRAINED, "--set", "teams.T1.workers=[]")
    assert members(part) == {"stamped(1)", "start(stage(1),0)", "crew"}


@pytest.mark.slow
def test_why_an_action_was_not_possible(capsys: pytest.CaptureFixture[str]) -> None:
    (drained,) = ask(capsys, DRAINED, "--action", "move(w1,left)", "--step", "0")
    assert members(drained) == {"action(move(w1,left))", "robot(w1)", "start(battery(w1),1)", "rule(battery)"}
    assert main(["why", DRAINED, "--action", "move(w1,left)", "--step", "0"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "  fact        the battery of w1 has its last unit" in lines
    (docked,) = ask(capsys, DRAINED, "--action", "move(w1,left)", "--step", "3")
    assert members(docked) == {"action(move(w1,left))", "robot(w1)", "start(docked(c1),w1)", "rule(move_tied)"}


def test_why_the_charger_is_suspected_and_the_worker_is_not(capsys: pytest.CaptureFixture[str]) -> None:
    charger, worker = ask(capsys, "charging/charge_failed", "--suspected", "c1", "--not", "w1")
    seen = {"commanded(charge(c1),1)", "seen(battery(w1),1)", "seen(docked(c1),w1)"}
    assert members(charger) == {"cleared(c1)", *seen}
    assert members(worker) == {"suspect(w1)", "most(1)", *seen}


@pytest.mark.slow
def test_which_exchange_stands_in_the_way(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, "charging/broken_worker")
    assert part["claim"] == "there is no shared plan of 16 steps"
    assert members(part) == {'alone("T2")', 'early("T1",10)', 'late("T2",11)', "delay(2)"}
