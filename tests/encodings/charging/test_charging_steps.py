"""The planner's programs of the charging factory: what single actions do, and exact answer sets of tiny teams."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import pytest

from reasoning.domain import load
from reasoning.planner import Planner, predict
from reasoning.setup import Refused, Setup, compile_setup
from reasoning.solver import Program
from reasoning.values import Problem, Question
from tests.encodings.charging.teams import CAPACITY, DOMAIN, RATE, team

INCLUDE = re.compile(r'^#include "(.+)"\.$', re.MULTILINE)


@pytest.mark.parametrize("name", ["plan", "predict", "prospects", "check", "diagnose"])
def test_entry_files_only_include_and_one_part_displays(name: str) -> None:
    entry = load(DOMAIN).program(name)
    code = [line for line in entry.read_text().splitlines() if line and not line.startswith("%")]
    assert all(INCLUDE.match(line) for line in code)
    texts = [(entry.parent / part).read_text() for part in INCLUDE.findall(entry.read_text())]
    assert sum("#show" in text for text in texts) == 1
    assert all(text.startswith("% ") and len(text.splitlines()) < 60 for text in texts)


@pytest.mark.parametrize("problem", [team([], 0, charger=None), team([((1, 1), 1, 1)], 0), team([], 1, guest="w1")])
def test_the_smallest_teams_are_grounded_without_a_message(problem: Problem) -> None:
    assert Planner(problem).answer(Question("alone", 12)).verdict in ("yes", "no")


TWO = team([((1, 2), 1, 12), ((2, 2), 2, 2)], [(2, 1, 0), (3, 0, 0)], charger=(2, 2), guest="w3")
LOW = team([((2, 1), 1, 1), ((2, 2), 2, 0)], [(2, 1, 0)], charger=(2, 2))
DOCKED = team([((2, 2), 1, 3)], [(2, 0, 0)], charger=(2, 2), docked="w1")
FULL = team([((2, 1), 1, 10)], [(2, 0, 0)], charger=(2, 1), docked="w1")
BROKEN = team([((2, 1), 1, 3)], [(2, 0, 0)], charger=(2, 1), docked="w1", broken=["c1"])


@pytest.mark.parametrize(
    ("problem", "step", "changes"),
    [
        (TWO, "move(w2,down)", {"at(w2)": "(2,1)", "battery(w2)": 1}),
        (
            TWO,
            "move(w2,down) move(w1,right)",
            {"at(w1)": "(2,2)", "at(w2)": "(2,1)", "battery(w1)": 11, "battery(w2)": 1},
        ),
        (TWO, "move(w1,right)", None),  # the cell is taken
        (TWO, "move(w1,up)", None),
        (TWO, "move(c1,left)", {"at(c1)": "(1,2)"}),  # chargers share cells, and drain nothing
        (TWO, "dock(c1,w2)", {"docked(c1)": "w2"}),
        (TWO, "dock(c1,w2) workOn(w2,1)", {"docked(c1)": "w2", "stage(1)": 2, "battery(w2)": 1}),
        (TWO, "dock(c1,w2) move(w2,down)", None),
        (TWO, "dock(c1,w1)", None),  # not in the same cell
        (TWO, "undock(c1)", None),
        (TWO, "charge(c1)", None),
        (TWO, "swapEndEffector(w1,3)", {"effector(w1)": 3, "battery(w1)": 11}),
        (TWO, "giveRobot(w1)", {"at(w1)": None, "effector(w1)": None, "battery(w1)": None}),
        (TWO, "takeRobot(w3,1,2)", None),  # the cell is taken
        (TWO, "lineShift", {"line(1)": 1, "line(2)": 2}),
        (LOW, "move(w1,left)", None),  # the last unit is not to be used
        (LOW, "workOn(w2,1)", None),
        (LOW, "dock(c1,w2)", {"docked(c1)": "w2"}),
        (DOCKED, "charge(c1)", {"battery(w1)": 3 + RATE}),
        (DOCKED, "charge(c1) workOn(w1,1)", None),  # who is charged does nothing else
        (DOCKED, "workOn(w1,1)", {"stage(1)": 1, "wet(1)": 1, "battery(w1)": 2}),
        (DOCKED, "undock(c1) workOn(w1,1)", {"docked(c1)": "none", "stage(1)": 1, "wet(1)": 1, "battery(w1)": 2}),
        (DOCKED, "undock(c1) charge(c1)", None),
        (DOCKED, "undock(c1) move(c1,left)", None),
        (DOCKED, "move(w1,left)", None),
        (DOCKED, "move(c1,left)", None),
        (DOCKED, "dock(c1,w1)", None),
        (FULL, "charge(c1)", {"battery(w1)": CAPACITY}),
        (BROKEN, "charge(c1)", None),
        (BROKEN, "undock(c1)", None),
        (BROKEN, "repair(c1)", {}),
        (BROKEN, "repair(c1) charge(c1)", None),
    ],
)
def test_what_one_step_does(problem: Problem, step: str, changes: dict[str, int | str | None] | None) -> None:
    plan, possible = predict(problem, [tuple(step.split())])
    assert possible == (changes is not None)
    if changes is not None:
        before, after = plan.states
        differ = {f: after.get(f) for f in before.keys() | after.keys() if before.get(f) != after.get(f)}
        assert differ == changes


def test_who_is_taken_comes_charged() -> None:
    plan, possible = predict(
        team([], 0, guest="w1"), [("takeRobot(w1,1,2)",)], {(0, "takeRobot(w1,1,2)"): {"effector": 3}}
    )
    assert possible == 1
    assert plan.details == {(0, "takeRobot(w1,1,2)"): {"effector": 3, "battery": CAPACITY}}
    assert plan.states[1]["battery(w1)"] == CAPACITY


# ---------------------------------------------------------------- answer sets
def plans(problem: Problem, steps: int) -> set[str]:
    """All plans of so many steps that the program admits, alone; the actions of a step are in order."""
    facts = [f"static({k},{v})." for k, v in problem.static.items()]
    facts += [f"init({f},{v})." for f, v in problem.state.items()]
    facts += [f"#program step(t). :- t = {steps}, not done(t). :- lent(t). :- borrowed(t)."]
    program = Program([load(DOMAIN).program("plan")], facts)
    program.ground(("base", ()), *(("step", (t,)) for t in range(1, steps + 1)))
    found = set()
    for model in program.within(()):
        actions: list[list[str]] = [[] for _ in range(steps)]
        for name, args in model.atoms:
            if name == "occurs":
                actions[int(args[1])].append(str(args[0]))
        found.add(" / ".join(" ".join(sorted(step)) for step in actions))
    return found


def tiny(battery: int, **more: Any) -> Problem:
    """A stamper beside a box that is still to be stamped; two units make a full battery, and a charge brings one."""
    problem = team([((2, 1), 3, battery)], [(2, 2, 0)], size=(2, 1), **more)
    return replace(problem, static={**problem.static, "capacity": 2, "rate": 1})


# Once the box is stamped, the worker has a unit left and cannot stroll; the charger may charge it once more.
ALONE = {"lineShift / lineShift"}
DOCKED_STILL = ALONE | {
    "charge(c1) lineShift / lineShift",
    "lineShift / charge(c1) lineShift",
    "lineShift undock(c1) / lineShift",
    "lineShift / lineShift undock(c1)",
    "charge(c1) lineShift / lineShift undock(c1)",
}
AGAIN = ALONE | {"dock(c1,w1) lineShift / charge(c1) lineShift"}


@pytest.mark.parametrize(
    ("problem", "expected"),
    [
        (tiny(2, charger=None), {f"workOn(w1,1) / {rest}" for rest in ALONE}),
        (
            tiny(2, charger=(1, 1)),
            {"workOn(w1,1) / lineShift / lineShift"}
            | {"move(c1,right) workOn(w1,1) / dock(c1,w1) lineShift / charge(c1) lineShift"},
        ),
        (
            tiny(0, charger=(2, 1), docked="w1"),
            {f"charge(c1) / charge(c1) / workOn(w1,1) / {rest}" for rest in DOCKED_STILL}
            | {f"charge(c1) / charge(c1) / undock(c1) workOn(w1,1) / {rest}" for rest in AGAIN},
        ),
        (
            tiny(1, charger=(1, 1)),
            {f"move(c1,right) / dock(c1,w1) / charge(c1) / workOn(w1,1) / {rest}" for rest in DOCKED_STILL}
            | {f"move(c1,right) / dock(c1,w1) / charge(c1) / undock(c1) workOn(w1,1) / {rest}" for rest in AGAIN},
        ),
    ],
)
def test_all_shortest_plans_of_the_smallest_teams(problem: Problem, expected: set[str]) -> None:
    steps = max(expected).count("/") + 1
    assert plans(problem, steps) == expected
    assert plans(problem, steps - 1) == set()


# ---------------------------------------------------------------- set-up
TEAM = {"boxes": 1, "workers": [{"name": "w1", "at": [2, 1], "effector": 1}], "charger": {"name": "c1", "at": [1, 1]}}


def test_a_scenario_starts_with_full_batteries_and_nobody_docked() -> None:
    setup = compile_setup(DOMAIN, {"teams": {"T1": TEAM}})
    assert isinstance(setup, Setup)
    state = setup.states["T1"]
    assert (state["battery(w1)"], state["docked(c1)"], state["at(c1)"]) == (CAPACITY, "none", "(1,1)")
    assert (setup.static["capacity"], setup.static["rate"]) == (CAPACITY, RATE)
    assert [(e.name, e.kind) for e in setup.entities] == [("w1", "worker"), ("c1", "charger"), ("1", "box")]


def test_the_world_charges_as_the_programs_say() -> None:
    charge = load(DOMAIN).data.actions["charge"]
    assert (charge["most"], charge["gain"]) == (CAPACITY, RATE)
    battery = load(DOMAIN).data.setup["team"]["workers"].item["battery"]
    assert (battery.max, battery.default) == (CAPACITY, CAPACITY)


@pytest.mark.parametrize(
    ("charger", "key", "expected"),
    [
        ({"name": "c1", "at": [9, 1]}, "teams.T1.charger.at", "a cell of the grid: column 1 to 5, row 1 to 3"),
        ({"name": "w1", "at": [1, 1]}, "teams.T1.workers[0].name", "a name that no other robot of the team has"),
        ({"name": "none", "at": [1, 1]}, "teams.T1.charger.name", "another name; none is a word of the domain"),
    ],
)
def test_a_wrong_charger_is_refused_by_its_key(charger: dict[str, object], key: str, expected: str) -> None:
    refused = compile_setup(DOMAIN, {"teams": {"T1": {**TEAM, "charger": charger}}})
    assert isinstance(refused, Refused)
    assert (key, expected) in [(wrong.key, wrong.expected) for wrong in refused.errors]


# ---------------------------------------------------------------- prospects
@pytest.mark.parametrize(
    ("problem", "hopeless", "bound"),
    [
        (team([((3, 2), 1, 12)], 1), "", 7),
        (team([((3, 2), 1, 0)], 1), "", 7),
        (team([], 1), "there is no worker", 7),
        (team([], 1, guest="w1"), "", 7),
        (team([((3, 2), 1, 1)], 1, charger=None), "no worker has power for an action, and there is no charger", 7),
        (team([((3, 2), 1, 2)], [(1, 2, 0)]), "box 1 is at line position 1, past the last place", 2),
        (team([((1, 1), 1, 12)], 2), "", 11),
    ],
)
def test_what_is_known_before_any_search(problem: Problem, hopeless: str, bound: int) -> None:
    planner = Planner(problem)
    assert planner.hopeless().startswith(hopeless)
    assert bool(planner.hopeless()) == bool(hopeless)
    assert planner.lower_bound() == bound
