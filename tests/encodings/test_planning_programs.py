"""The planner's programs: how they are put together, and what single actions do."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from reasoning.domain import load
from reasoning.planner import Planner, predict
from reasoning.values import Question
from tests.reasoning.teams import DOMAIN, team

INCLUDE = re.compile(r'^#include "(.+)"\.$', re.MULTILINE)
ENTRIES = ("plan", "predict", "prospects")


def parts(entry: Path) -> list[Path]:
    return [entry.parent / name for name in INCLUDE.findall(entry.read_text())]


@pytest.mark.parametrize("name", ENTRIES)
def test_entry_files_only_include_and_one_part_displays(name: str) -> None:
    entry = load(DOMAIN).program(name)
    code = [line for line in entry.read_text().splitlines() if line and not line.startswith("%")]
    assert all(INCLUDE.match(line) for line in code)
    assert sum("#show" in part.read_text() for part in parts(entry)) == 1
    for part in parts(entry):
        text = part.read_text()
        assert not INCLUDE.search(text), "library files include nothing"
        assert text.startswith("% "), "a header says what the part is for"
        assert "#program" in text, "a part says which program it belongs to"
        assert len(text.splitlines()) < 60


@pytest.mark.parametrize("problem", [team([], 0, carrier=None), team([((1, 1), 1)], 0), team([], 1, guest="w1")])
def test_the_smallest_teams_are_grounded_without_a_message(problem: object) -> None:
    planner = Planner(problem)  # type: ignore[arg-type]
    assert planner.answer(Question("alone", 20)).verdict in ("yes", "no")


TWO = team([((1, 2), 1), ((2, 2), 2)], [(2, 1, 0), (3, 0, 0)], size=(3, 2), carrier=(2, 2), guest="w3")
TIED = team([((2, 1), 1)], [(2, 0, 0)], size=(3, 2), carrier=(2, 1), tied="w1")
BROKEN = team([((2, 1), 1)], [(2, 0, 0)], size=(3, 2), carrier=(2, 1), tied="w1", broken=["w1"])


@pytest.mark.parametrize(
    ("problem", "step", "changes"),
    [
        (TWO, "move(w2,right)", {"at(w2)": "(3,2)"}),
        (TWO, "move(w1,right)", None),  # the cell is taken
        (TWO, "move(w1,right) move(w2,right)", {"at(w1)": "(2,2)", "at(w2)": "(3,2)"}),
        (TWO, "move(w1,right) move(w2,left)", None),  # they would exchange their cells
        (TWO, "move(w1,left)", None),
        (TWO, "move(c1,down)", {"at(c1)": "(2,1)"}),
        (TWO, "move(c1,up)", None),
        (TWO, "attach(c1,w2) workOn(w2,1)", {"attached(c1)": "w2", "stage(1)": 2}),
        (TWO, "attach(c1,w2) move(w2,right)", None),
        (TWO, "attach(c1,w1)", None),  # not in the same cell
        (TWO, "workOn(w2,1) lineShift", None),
        (TWO, "workOn(w2,2)", None),
        (TWO, "lineShift", {"line(1)": 1, "line(2)": 2}),
        (TWO, "swapEndEffector(w1,3)", {"effector(w1)": 3}),
        (TWO, "swapEndEffector(w1,1)", None),
        (TWO, "swapEndEffector(w2,1)", None),  # not in the pit stop
        (TWO, "giveRobot(w2)", None),
        (TWO, "giveRobot(w1) move(w2,left)", {"at(w1)": None, "effector(w1)": None, "at(w2)": "(1,2)"}),
        (TWO, "takeRobot(w3,1,2)", None),  # the cell is taken
        (TWO, "takeRobot(w3,2,1)", None),  # not in the pit stop
        (TIED, "push(c1)", {"at(c1)": "(2,2)", "at(w1)": "(2,2)"}),
        (TIED, "pull(c1)", None),
        (TIED, "move(w1,right)", None),
        (TIED, "move(c1,right)", None),
        (TIED, "detach(c1)", {"attached(c1)": "none"}),
        (TIED, "detach(c1) push(c1)", None),
        (TIED, "repair(w1)", None),  # not known to be broken
        (BROKEN, "push(c1)", None),
        (BROKEN, "repair(w1)", {}),
        (BROKEN, "repair(w1) detach(c1)", None),
        (BROKEN, "detach(c1)", {"attached(c1)": "none"}),
    ],
)
def test_what_one_step_does(problem: object, step: str, changes: dict[str, int | str | None] | None) -> None:
    plan, possible = predict(problem, [tuple(step.split())])  # type: ignore[arg-type]
    assert possible == (changes is not None)
    if changes is not None:
        before, after = plan.states
        differ = {f: after.get(f) for f in before.keys() | after.keys() if before.get(f) != after.get(f)}
        assert differ == changes


def test_paint_is_wet_in_the_state_after_and_dry_in_the_next() -> None:
    problem = team([((2, 2), 1)], [(2, 0, 0)], size=(2, 2))
    plan, possible = predict(problem, [("workOn(w1,1)",), (), ()])
    assert possible == 3
    assert [state["wet(1)"] for state in plan.states] == [0, 1, 0, 0]
