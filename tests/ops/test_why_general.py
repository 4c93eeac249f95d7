"""``muster why`` about teams that share their robots without the published limits."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from ops.cli import main
from ops.compile import start
from ops.scenario import load
from ops.shares import delays, most, problems
from reasoning.domain import load as load_domain
from reasoning.ledger import Known, Ledger
from reasoning.planner import Planner
from reasoning.prospects import prospects
from reasoning.refusals import Terms, program, refuted, unrefuted
from reasoning.values import Question
from reasoning.why import Clash, explain
from tests.ops.test_why import ask, members

pytestmark = pytest.mark.slow

LENGTHS = {"two_loans": 11, "carrier_lent": 11, "given_back": 17}


@pytest.mark.parametrize("name", LENGTHS)
def test_why_no_shared_plan_is_shorter(capsys: pytest.CaptureFixture[str], name: str) -> None:
    steps = LENGTHS[name]
    (part,) = ask(capsys, f"factory/{name}", "--within", str(steps - 1))
    assert part["claim"] == f"there is no shared plan of {steps - 1} steps"
    assert any(member.startswith('refuted("T1",') for member in members(part))
    assert ask(capsys, f"factory/{name}", "--within", str(steps), code=1)[0]["status"] == "possible"


def test_the_words_are_plain(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["why", "factory/given_back", "--within", "16"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "  resource    transport from T2 to T1 takes 1 step" in lines
    assert any(line.startswith("  team        T2 cannot finish in time giving a waxer by step ") for line in lines)


def test_why_one_team_borrows_and_not_the_other(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, "factory/given_back", "--borrows", "T2", "--not", "T1")
    assert members(part) == {'may_not("T2",borrow)', 'refuted("T2","alone")'}
    assert part["notes"][0] == "T1 borrows in this plan as well, so it cannot do so instead of T2"
    assert main(["why", "factory/carrier_lent", "--borrows", "T2"]) == 2
    assert "T2 does not borrow in this plan; who does: T1" in capsys.readouterr().err


def test_why_no_team_could_do_it_alone(capsys: pytest.CaptureFixture[str]) -> None:
    waxer, painter = ask(capsys, "factory/given_back", "--none")
    assert (waxer["claim"], painter["claim"]) == tuple(
        f"{team} has no plan alone, however long" for team in ("T1", "T2")
    )
    assert members(painter) >= {"stamped(1)", "crew", "start(fixed(w1),1)", "rule(swap_fixed)", "rule(work_stage)"}
    assert main(["why", "factory/two_loans", "--none"]) == 2
    assert "every team might finish by itself" in capsys.readouterr().err


def test_a_plan_is_asked_as_its_scenario_is(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["plan", "factory/two_loans", "--json"]) == 0
    file = tmp_path / "plan.json"
    file.write_text(capsys.readouterr().out)
    (part,) = ask(capsys, str(file))
    assert part["claim"] == "there is no shared plan of 10 steps"
    assert "most(worker,2)" in members(part)


def test_the_time_is_told_where_it_was_over(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["why", "factory/given_back", "--within", "16", "--budget", "0", "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["late"].startswith("the time was over: T1 had not answered whether it can finish in 16 steps")


@pytest.mark.parametrize("name", LENGTHS)
def test_each_member_is_refuted_by_its_team_and_needed(name: str) -> None:
    scenario = load(f"factory/{name}")
    setup, domain, within = start(scenario), load_domain("factory"), LENGTHS[name] - 1
    asked = problems(domain, setup)
    terms = Terms(within, delays(setup), most(domain, setup))
    teams = {team: Ledger(stock=prospects(replace(p, guests=())).stock) for team, p in asked.items()}
    planners = {team: Planner(problem) for team, problem in asked.items()}
    while (parts := unrefuted(teams, terms)) is not None:
        for team, part in parts.items():
            answer = planners[team].answer(part)
            teams[team] = teams[team].learn(Known(answer.easiest or part, answer.verdict))
    for team, ledger in teams.items():
        for question in refuted(ledger, terms):
            assert Planner(asked[team]).answer(question).verdict == "no"
    found = explain(lambda: program(teams, terms))
    assert isinstance(found, Clash)
    for left_out in ("", *found.members):
        rest = [("use", (member,), True) for member in found.members if member != left_out]
        assert program(teams, terms).solve(rest).satisfiable == bool(left_out)


def test_what_is_certain_before_any_answer_counts_as_refuted() -> None:
    terms = Terms(3, {("A", "B"): 1, ("B", "A"): 1}, {"worker": 1})
    all_help = Question("share", 3, 0, (), (("worker", 0),))
    assert refuted(Ledger(4), terms) == [all_help]
    assert refuted(Ledger(can_alone=False, can_borrow=False), terms) == [all_help]
    assert refuted(Ledger(can_alone=False), terms) == [Question("share", 3)]
    assert refuted(Ledger(answers=(Known(Question("share", 2), "no"),)), terms) == []
    stuck = {"A": Ledger(can_alone=False), "B": Ledger(stock={"worker": 0})}
    found = explain(lambda: program(stuck, terms))
    assert isinstance(found, Clash)
    assert found.checked
