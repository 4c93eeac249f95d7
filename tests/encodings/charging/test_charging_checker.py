"""The charging factory's checker accepts a shared plan, and refuses copies of it that are spoiled in a single rule."""

from __future__ import annotations

import pytest

from ops.compile import start
from ops.scenario import load
from reasoning.checker import Break, Exchange, check, examine
from reasoning.domain import load as load_domain
from tests.encodings.charging.teams import DOMAIN, RATE, team
from tests.reasoning.spoiling import Spoiled

SETUP = start(load("charging/two_drained"))
EXCHANGES = (Exchange("w2", "T2", 8, "T1", 10, "w2"),)
TAKE, GOAL = "takeRobot(w2,1,2)", 20
PLAN = {
    "T1": """
        lineShift move(c1,up) / lineShift move(c1,up) / lineShift move(c1,right) / lineShift move(c1,right) /
        dock(c1,w1) / charge(c1) / charge(c1) / undock(c1) workOn(w1,2) / move(c1,left) move(w1,left) /
        move(c1,left) workOn(w1,1) / move(w1,left) takeRobot(w2,1,2) /
        dock(c1,w1) move(w2,right) swapEndEffector(w1,3) / charge(c1) move(w2,up) / undock(c1) workOn(w2,1) /
        move(c1,right) move(w1,right) move(w2,right) / dock(c1,w1) workOn(w1,1) workOn(w2,2) / lineShift charge(c1) /
        undock(c1) workOn(w1,2) / lineShift move(w1,left) move(w2,left) / lineShift
    """,
    "T2": """
        lineShift move(c1,up) / lineShift dock(c1,w2) / lineShift charge(c1) / lineShift undock(c1) / move(c1,up) /
        move(c1,right) / dock(c1,w1) move(w2,up) / charge(c1) / charge(c1) giveRobot(w2) / undock(c1) workOn(w1,1) /
        move(w1,left) / swapEndEffector(w1,2) / move(w1,right) / workOn(w1,1) / move(w1,left) / swapEndEffector(w1,3) /
        move(w1,right) / workOn(w1,1) / lineShift / lineShift
    """,
}
STEPS = {team: [tuple(step.split()) for step in text.split("/")] for team, text in PLAN.items()}


def test_the_plan_is_right_whether_its_exchange_is_told_or_found() -> None:
    assert check(DOMAIN, SETUP.static, SETUP.states, STEPS) == []
    assert check(DOMAIN, SETUP.static, SETUP.states, STEPS, exchanges=EXCHANGES) == []


def test_a_charge_of_a_broken_charger_fails_and_fills_nothing() -> None:
    plan = {"T1": [*STEPS["T1"][:6]], "T2": []}
    result = examine(DOMAIN, SETUP.static, SETUP.states, plan, breaks=[Break("T1", "c1", 5)])
    assert [(d.step, d.action) for d in result.discrepancies] == [(5, "charge(c1)")]
    plan["T1"].append(("workOn(w1,2)",))
    result = examine(DOMAIN, SETUP.static, SETUP.states, plan, breaks=[Break("T1", "c1", 5)])
    assert (6, "battery") in [(v.step, v.rule) for v in result.violations]


@pytest.mark.parametrize("battery", range(4))
def test_a_charge_fills_up_to_the_capacity(battery: int) -> None:
    problem, capacity = team([((1, 1), 1, battery)], docked="w1"), 5
    moves = [(f"move(w1,{way})",) for way in ("right", "left") * 4]
    plan = {"T1": [("charge(c1)",), ("undock(c1)",), *moves]}
    found = check(DOMAIN, {**problem.static, "capacity": capacity}, {"T1": problem.state}, plan)
    empty = min(violation.step for violation in found if violation.rule == "battery")
    assert empty - 2 == min(battery + RATE, capacity) - 1, "the last unit is not to be used"


SPOILED = [
    Spoiled("unknown", "T1", 8, add=("fly(w1)",)),
    Spoiled("unknown", "T1", 8, add=("charge(w1)",)),
    Spoiled("unknown", "T1", 8, add=("undock(w1)",)),
    Spoiled("unknown", "T1", 8, add=("dock(w1,c1)",)),
    Spoiled("unknown", "T1", 8, add=("attach(c1,w1)",)),
    Spoiled("unknown", "T1", 8, add=("push(c1)",)),
    Spoiled("unknown", "T1", 8, add=("giveRobot(c1)",)),
    Spoiled("absent", "T1", 3, add=("move(w2,left)",)),
    Spoiled("off_grid", "T1", 9, ("workOn(w1,1)",), ("move(w1,up)",)),
    Spoiled("off_grid", "T1", 0, ("move(c1,up)",), ("move(c1,down)",)),
    Spoiled("move_tied", "T1", 5, ("charge(c1)",), ("move(w1,down)",)),
    Spoiled("move_tied", "T1", 5, ("charge(c1)",), ("move(c1,down)",)),
    Spoiled("dock_apart", "T1", 3, ("move(c1,right)",), ("dock(c1,w1)",)),
    Spoiled("docked", "T1", 5, ("charge(c1)",), ("dock(c1,w1)",)),
    Spoiled("undocked", "T1", 8, ("move(c1,left)",), ("charge(c1)",)),
    Spoiled("undocked", "T1", 8, ("move(c1,left)",), ("undock(c1)",)),
    Spoiled("battery", "T1", 0, add=("move(w1,left)",)),
    Spoiled("battery", "T2", 0, add=("swapEndEffector(w2,1)",)),
    Spoiled("battery", "T2", 0, add=("giveRobot(w2)",)),
    Spoiled("battery", "T1", 6, ("charge(c1)",), found_at=("T1", 11)),
    Spoiled("swap_outside", "T1", 9, ("workOn(w1,1)",), ("swapEndEffector(w1,2)",)),
    Spoiled("swap_same", "T1", 11, ("swapEndEffector(w1,3)",), ("swapEndEffector(w1,1)",)),
    Spoiled("work_row", "T1", 12, ("move(w2,up)",), ("workOn(w2,1)",)),
    Spoiled("work_pit", "T1", 11, ("swapEndEffector(w1,3)",), ("workOn(w1,2)",)),
    Spoiled("work_column", "T1", 8, ("move(w1,left)",), ("workOn(w1,1)",)),
    Spoiled("work_stage", "T1", 8, ("move(w1,left)",), ("workOn(w1,2)",)),
    Spoiled("work_wet", "T1", 8, ("move(w1,left)",), ("workOn(w1,2)",)),
    Spoiled("work_together", "T1", 15, add=("workOn(w1,2)",)),
    Spoiled("shift_at_work", "T1", 9, add=("lineShift",)),
    Spoiled("give_outside", "T1", 9, ("workOn(w1,1)",), ("giveRobot(w1)",)),
    Spoiled("give_tied", "T2", 3, ("undock(c1)",), ("giveRobot(w2)",)),
    Spoiled("take_outside", "T1", 10, (TAKE,), ("takeRobot(w2,2,2)",)),
    Spoiled("take_present", "T1", 12, add=("takeRobot(w1,1,1)",)),
    Spoiled("take_nobody", "T2", 8, ("giveRobot(w2)",), found_at=("T1", 10)),
    Spoiled("take_own", "T2", 12, add=("takeRobot(w9,1,1)",), exchanges=(Exchange("w2", "T2", 8, "T2", 12, "w9"),)),
    Spoiled("take_early", "T1", 9, add=(TAKE,), also=("T1", 10, TAKE)),
    Spoiled(
        "take_twice",
        "T1",
        12,
        add=("takeRobot(w9,1,1)",),
        exchanges=(*EXCHANGES, Exchange("w2", "T2", 8, "T1", 12, "w9")),
    ),
    Spoiled("two_robots", "T1", 10, exchanges=(*EXCHANGES, Exchange("w1", "T2", 7, "T1", 10, "w2"))),
    Spoiled("exchange_no_give", "T2", 7, exchanges=(Exchange("w2", "T2", 7, "T1", 10, "w2"),)),
    Spoiled("exchange_no_take", "T1", 11, exchanges=(Exchange("w2", "T2", 8, "T1", 11, "w2"),)),
    Spoiled("repair_whole", "T1", 8, add=("repair(c1)",)),
    Spoiled("broken", "T1", 6, breaks=(Break("T1", "c1", 5),)),
    Spoiled("busy", "T1", 9, add=("move(w1,left)",)),
    Spoiled("busy", "T1", 6, add=("workOn(w1,2)",)),
    Spoiled("busy", "T1", 7, add=("charge(c1)",)),
    Spoiled("busy", "T1", 8, add=("dock(c1,w1)",)),
    Spoiled("twice", "T1", 11, add=("swapEndEffector(w1,2)",)),
    Spoiled("twice", "T1", 11, add=("dock(c1,w2)",)),
    Spoiled("same_cell", "T2", 4, add=("move(w1,left)", "move(w2,up)")),
    Spoiled("change_cells", "T1", 14, ("move(w2,right)",), ("move(w2,left)",), exchanges=EXCHANGES),
    Spoiled("cell_taken", "T1", 14, ("move(w2,right)",), exchanges=EXCHANGES),
    Spoiled("goal_stage", "T1", 17, ("workOn(w1,2)",), found_at=("T1", GOAL)),
    Spoiled("goal_line", "T1", 19, ("lineShift",), found_at=("T1", GOAL)),
]


@pytest.mark.slow
@pytest.mark.parametrize("spoiled", SPOILED, ids=lambda s: f"{s.rule}-{s.team}-{s.step}")
def test_a_copy_spoiled_in_one_rule_is_refused_for_that_rule(spoiled: Spoiled) -> None:
    plan = spoiled.of(STEPS)
    told = check(DOMAIN, SETUP.static, SETUP.states, plan, exchanges=spoiled.exchanges, breaks=spoiled.breaks)
    found = [v for v in told if (v.team, v.step) == (spoiled.found_at or (spoiled.team, spoiled.step))]
    assert spoiled.rule in {v.rule for v in found}
    assert all("{" not in v.text and v.text != v.rule for v in told)


def test_every_rule_has_its_words_and_a_spoiled_copy() -> None:
    assert {spoiled.rule for spoiled in SPOILED} == set(load_domain(DOMAIN).data.rules)
