"""``muster why``: one answer for each kind of question, about scenarios, plans, cases and recordings."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import msgspec
import pytest

from bus.messages import Envelope, Event
from bus.scene import Scene
from ops.cli import main
from ops.compile import compile_scenario
from ops.recording import Writer
from ops.scenario import load
from ops.whysubjects import subject_of
from reasoning.reasons import no_plan

PUBLISHED = "encodings/factory/plans/published.json"
LENDING = (
    "--set", "teams.T1.boxes=2",
    "--set", 'teams.T2.workers=[{name="w1", at=[1,3], effector=1}, {name="w2", at=[1,2], effector=2}]',
)  # fmt: skip
ONE_BOX = ("factory/one_worker", "--set", "teams.T1.boxes=1")


def ask(capsys: pytest.CaptureFixture[str], *words: str, code: int = 0) -> list[dict[str, Any]]:
    """The parts of the answer."""
    assert main(["why", *words, "--json"]) == code
    told = json.loads(capsys.readouterr().out)
    assert told["answered"] == (code == 0)
    parts: list[dict[str, Any]] = told["parts"]
    return parts


def members(part: dict[str, Any]) -> set[str]:
    assert part["status"] == "minimal"
    assert part["checked"]
    assert all(member["needed"] and member["text"] for member in part["members"])
    return {member["member"] for member in part["members"]}


# ---------------------------------------------------------------- no plan, none shorter
@pytest.mark.slow
def test_why_not_shorter_is_the_question_about_what_has_a_plan(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, *ONE_BOX)
    assert part["claim"] == "T1 cannot finish in 14 steps"
    assert {"stamped(1)", "gone(1)", "steps(14)", "robot(w1)", "rule(swap_outside)"} <= members(part)
    subject = subject_of(ONE_BOX[0], [ONE_BOX[2]])
    solved = no_plan(subject.problem("T1"), 14, 15)().solve([("use", (m,), True) for m in sorted(members(part))])
    assert solved.satisfiable is False
    assert ask(capsys, *ONE_BOX, "--within", "15", code=1)[0]["status"] == "possible"


def test_why_no_plan_is_the_question_about_what_has_none(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, "factory/one_worker", "--set", "teams.T1.workers=[]", "--set", "teams.T1.boxes=1")
    assert members(part) == {"stamped(1)", "start(stage(1),0)", "crew"}
    shared, *each = ask(
        capsys, "factory/broken_worker", "--set", "teams.T1.workers=[]", "--set", "teams.T2.workers=[]", "--none"
    )
    assert members(shared) == {'alone("T1")', 'alone("T2")'}
    assert [members(part) for part in each] == [{"stamped(1)", "start(stage(1),0)", "crew"}] * 2
    assert ask(capsys, *ONE_BOX, "--none", code=1)[0]["status"] == "possible"


@pytest.mark.slow
def test_which_team_and_which_exchange_stand_in_the_way(capsys: pytest.CaptureFixture[str]) -> None:
    missing = ("factory/broken_worker", "--set", "teams.T1.workers=[]", "--shorter")
    (part,) = ask(capsys, *missing)
    assert part["claim"] == "there is no shared plan of 28 steps"
    assert members(part) == {'alone("T1")', 'early("T2",14)', 'late("T1",15)', "delay(2)"}
    shared, *own = ask(capsys, "factory/broken_worker", "--within", "7", "--team", "T1")
    assert members(shared) == {'alone("T1")', 'late("T1",-1)'}
    texts = [member["text"] for member in shared["members"]]
    assert "T1 cannot finish in time even with a borrowed robot" in texts
    assert [part["claim"].removeprefix("T1 cannot finish in 7 steps ") for part in own] == [
        "even with a borrowed robot", "without borrowing"
    ]  # fmt: skip
    assert all("gone(1)" in members(part) for part in own)


def test_a_search_that_is_over_says_how_far_it_got(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["why", "factory/one_worker", "--within", "28", "--budget", "0"]) == 1
    assert capsys.readouterr().out.startswith("the time was over: T1 had not answered whether it can")
    assert main(["why", "factory/one_worker", "--budget", "0"]) == 1
    assert "the best plan is not known" in capsys.readouterr().out


# ---------------------------------------------------------------- who borrows
@pytest.mark.slow
def test_why_one_team_borrows_and_not_another(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, "factory/broken_worker", *LENDING, "--borrows", "T1", "--not", "T2")
    assert part["claim"].endswith("steps are not possible if T2 borrows and T1 does not")
    assert members(part) == {'alone("T1")', 'may_not("T1",borrow)'}
    (part,) = ask(capsys, "factory/broken_worker", *LENDING, "--lends", "T2")
    assert members(part) == {'alone("T1")', 'may_not("T2",lend)'}
    assert main(["why", "factory/broken_worker", *LENDING, "--borrows", "T2"]) == 2
    assert "T2 does not borrow in this plan; who does: T1" in capsys.readouterr().err


# ---------------------------------------------------------------- an action
@pytest.mark.slow
@pytest.mark.parametrize(
    ("team", "step", "action", "expected"),
    [
        ("T1", "0", "move(w1,left)", {"robot(w1)", "start(at(w1),(1,3))", "rule(off_grid)"}),
        ("T4", "17", "attach(c1,w1)", {"robot(c1)", "start(broken(c1),1)", "rule(broken)"}),
        ("T4", "15", "repair(c1)", {"robot(c1)", "rule(repair_whole)"}),
        ("T1", "12", "takeRobot(w2,2,2)", {"robot(w2)", "rule(take_outside)"}),
    ],
)
def test_why_an_action_was_not_possible(
    capsys: pytest.CaptureFixture[str], team: str, step: str, action: str, expected: set[str]
) -> None:
    (part,) = ask(capsys, PUBLISHED, "--team", team, "--step", step, "--action", action)
    assert members(part) == {f"action({action})"} | expected


@pytest.mark.slow
def test_the_answer_for_people_is_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["why", PUBLISHED, "--team", "T4", "--step", "17", "--action", "attach(c1,w1)"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "T4 cannot do attach(c1,w1) in step 17: these 4 clash"
    assert "  fact        c1 is known to be broken" in lines
    words = "  rule        a broken robot does nothing until it is repaired [broken]"
    assert f"{words}; or else: c1 is known to be broken (step 17)" in lines
    assert lines[-1].startswith("  checked: all together are refuted, without any one there is a way; ")
    assert main(["why", PUBLISHED, "--team", "T4", "--step", "17", "--action", "repair(c1)"]) == 1
    assert capsys.readouterr().out == "T4 can do repair(c1) in step 17\n"


# ---------------------------------------------------------------- a suspicion
def test_why_the_carrier_is_suspected_and_the_worker_is_not(capsys: pytest.CaptureFixture[str]) -> None:
    carrier, worker = ask(capsys, "factory/carrier_at_step_16", "--suspected", "c1", "--not", "w1")
    seen = {"commanded(attach(c1,w1),0)", "seen(attached(c1),none)", "seen(stage(1),3)"}
    assert members(carrier) == {"cleared(c1)", *seen}
    assert members(worker) == {"suspect(w1)", "most(1)", *seen}
    (both,) = ask(capsys, "factory/carrier_or_worker", "--not", "w1", code=1)
    assert both["text"] == "nothing contradicts that w1 is broken: {broken(c1)} or {broken(w1)}"


START = {"at(w1)": "(1,3)", "effector(w1)": 1, "at(c1)": "(1,1)", "attached(c1)": "none"}
MET = {"at(w1)": "(1,3)", "effector(w1)": 1, "at(c1)": "(1,3)", "attached(c1)": "none"}


def recorded(folder: Path) -> Path:
    """A run in which the carrier comes to the worker, cannot attach to it, and is found broken. It has no boxes."""
    scenario = load("factory/one_worker", ["teams.T1.boxes=0"])
    compiled = compile_scenario(scenario)
    compiled.write(folder)
    steps = [(["move(c1,up)"], {**START, "at(c1)": "(1,2)"}), (["move(c1,up)"], MET), (["attach(c1,w1)"], MET)]
    writer = Writer(folder / "run.mcap")
    writer.add("scene", msgspec.json.decode((folder / "world.json").read_bytes(), type=Scene))
    for number, (source, event) in enumerate(_events(steps), 1):
        writer.add("event", Envelope(1, "told", source, 1, number, f"{source}-{number}", float(number), event))
    writer.close()
    return folder


def _events(steps: Sequence[tuple[list[str], dict[str, Any]]]) -> Iterator[tuple[str, Event]]:
    for step, (actions, state) in enumerate(steps):
        yield "world", Event("step_started", {"team": "T1", "step": step, "actions": actions})
        yield "world", Event("step_ended", {"team": "T1", "step": step, "state": state})
    causes = [["broken(c1)"], ["broken(w1)"]]
    yield "T1", Event("discrepancy", {"team": "T1", "step": 2, "differing": ["attached(c1)"]})
    yield "T1", Event("diagnosis", {"team": "T1", "step": 2, "causes": causes})
    yield "T1", Event("inspection", {"team": "T1", "robot": "c1", "finding": "broken"})
    yield "world", Event("step_started", {"team": "T1", "step": 3, "actions": []})
    yield "world", Event("step_ended", {"team": "T1", "step": 3, "state": MET})


def test_what_a_recorded_run_says(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    run = str(recorded(tmp_path))
    carrier, worker = ask(capsys, run, "--suspected", "c1", "--not", "w1", "--team", "T1")
    assert carrier["claim"] == "c1 is broken after step 2"
    assert members(carrier) == {"cleared(c1)", "inspected(c1,broken)"}
    assert members(worker) == {"suspect(w1)", "most(1)", "inspected(c1,broken)"}
    (early,) = ask(capsys, run, "--action", "attach(c1,w1)", "--step", "1")
    place = {"start(at(c1),(1,2))", "start(at(w1),(1,3))"}
    assert members(early) == {"action(attach(c1,w1))", "robot(c1)", "robot(w1)", "rule(attach_apart)", *place}
    (known,) = ask(capsys, run, "--action", "attach(c1,w1)", "--step", "3")
    assert "start(broken(c1),1)" in members(known)
    assert main(["why", run, "--suspected", "c1", "--step", "1"]) == 2
    assert "T1 met no discrepancy there; in this run: T1 in step 2" in capsys.readouterr().err


# ---------------------------------------------------------------- wrong input
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["factory/nowhere"], "neither a file nor a shipped scenario"),
        (["factory/carrier_or_worker", "--suspected", "w7"], "w7: there is no such robot; there are c1, w1"),
        (["factory/carrier_or_worker", "--not", "w7"], "w7: there is no such robot; there are c1, w1"),
        (["nothing.json"], "nothing.json: cannot be read"),
        ([PUBLISHED, "--action", "move(w1,right)", "--team", "T1"], "--action needs --step"),
        ([PUBLISHED, "--action", "move(w1,", "--step", "1", "--team", "T1"], "expected an action, as move(w1,right)"),
        ([PUBLISHED, "--action", "move(w1,right)", "--step", "99", "--team", "T1"], "T1 has steps 0 to 27"),
        ([PUBLISHED, "--action", "move(w1,right)", "--step", "1"], "say which team with --team: T1, T2, T3, T4"),
        ([PUBLISHED, "--team", "T9"], "--team T9: there is no such team; there are T1, T2, T3, T4"),
        (["factory/carrier_at_step_16"], "a diagnosis case; ask --suspected ROBOT"),
        (["factory/one_worker", "--within", "-1"], "expected steps, 0 or more"),
        (["factory/one_worker", "--budget", "nan"], "expected seconds, 0 or more"),
        (["factory/one_worker", "--set", "teams.T1.boxes=0"], "nothing is to be done"),
    ],
)
def test_wrong_input_is_refused(capsys: pytest.CaptureFixture[str], words: list[str], said: str) -> None:
    assert main(["why", *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.slow
def test_the_published_examples(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, "factory/one_worker", "--budget", "250")
    assert {"stamped(1)", "stamped(2)", "stamped(3)", "gone(3)", "steps(28)"} <= members(part)
    (shared,) = ask(capsys, "factory/four_teams", "--budget", "250")
    assert {'alone("T1")', 'alone("T4")'} <= members(shared)
