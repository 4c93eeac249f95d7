"""Every rule of the checker, by a plan that breaks it; and what geometry adds."""

from __future__ import annotations

from typing import Any

import pytest

from reasoning.checker import check
from reasoning.domain import load
from reasoning.motion.oracle import Oracle
from reasoning.motion.trajectory import Trajectory
from reasoning.values import Problem
from tests.encodings.housekeeping.rooms import DOMAIN, NIGHTSTAND, SHELF, problem, robot, thing
from tests.encodings.housekeeping.test_actions import (
    AT,
    BOTH,
    DEADLINE,
    HALL,
    HELD,
    LONG,
    ONE,
    RUG,
    SHORT,
    WARNED,
    WEAK,
)  # fmt: skip

GAP = [robot("r1", 0, 1)]
NARROW: dict[str, Any] = {"furniture": [NIGHTSTAND, SHELF]}
LATE = problem([robot("r1", 0, 0)], [thing("book", 0, 0)], late=[{"thing": "book", "steps": 2}])
FEW = problem([robot("r1", 1, 1)], [thing("book", 1, 1)])
FEW = type(FEW)(DOMAIN, {**FEW.static, "most(living_room,attaches)": 0}, FEW.state)
AWAY = problem([robot("r1", 0, 0), robot("r2", 1, 1)])
AWAY = type(AWAY)(DOMAIN, {**AWAY.static, "away(living_room,0)": "(r1,3)"}, AWAY.state)
NOT_YET = type(FEW)(DOMAIN, {**ONE.static, "away(living_room,0)": "(r1,3)"}, ONE.state)
ROW = problem(GAP, [thing("a", 1, 0), thing("b", 1, 1), thing("c", 1, 2)])
BROAD = type(ROW)(DOMAIN, {**ROW.static, "radius(thing)": 40}, ROW.state)
BROKEN = {
    "unknown": (ONE, "fly(r1)"),
    "busy": (AT, "attach(r1) goto(r1,2,2)"),
    "stays": (ONE, "goto(r1,0,0)"),
    "no_way": (problem(GAP, **NARROW), "goto(r1,3,1)"),
    "too_far": (HALL, "goto(r1,13,0)"),
    "never": (WARNED, "goto(r1,2,0)"),
    "alone": (BOTH, "goto(r1,2,1)"),
    "torn": (BOTH, "goto(r1,2,1) goto(r2,3,2)"),
    "attach_air": (ONE, "attach(r1)"),
    "attach_tied": (HELD, "attach(r1)"),
    "attach_floor": (SHORT, "attach(r1)"),
    "attach_heavy": (WEAK, "attach(r1)"),
    "detach_free": (ONE, "detach(r1)"),
    "early": (LATE, "attach(r1) | goto(r1,1,0) | goto(r1,3,0) | detach(r1)"),
    "away": (NOT_YET, "goto(r1,1,0)"),
    "same_cell": (AT, "goto(r2,2,2) goto(r1,2,2)"),
    "cell_taken": (AT, "goto(r2,1,1)"),
    "goal_place": (ONE, ""),
    "goal_free": (HELD, "goto(r1,3,2)"),
    "deadline": (DEADLINE, "goto(r1,7,0)"),
    "attaches": (FEW, "attach(r1)"),
    "held_back": (
        problem(
            [robot("r1", 0, 0), robot("r2", 0, 1), robot("r3", 2, 0)],
            heavy=[LONG],
            held={"r1": "grip(rug,1)", "r2": "grip(rug,2)"},
        ),
        "goto(r1,2,0) goto(r2,2,1)",
    ),
}


@pytest.mark.parametrize("rule", sorted(BROKEN))
def test_a_plan_that_breaks_a_rule_is_refused_by_its_name(rule: str) -> None:
    start, told = BROKEN[rule]
    steps = [tuple(step.split()) for step in told.split("|")]
    found = check(DOMAIN, start.static, {"T1": start.state}, {"T1": steps})
    assert rule in {violation.rule for violation in found}
    assert all("{" not in violation.text for violation in found)


def test_what_the_details_say_is_judged_too() -> None:
    def rules(point: str) -> set[str]:
        details = {"T1": {(0, "attach(r1)"): {"attach_point": point}}}
        found = check(DOMAIN, AT.static, {"T1": AT.state}, {"T1": [("attach(r1)",)]}, details=details)
        return {violation.rule for violation in found if violation.action != "goal"}

    assert rules("grip(book,1)") == set()
    assert rules("grip(pad,1)") == {"attach_apart"}
    held = {**RUG.state, "connected(r2)": "grip(rug,1)", "at(r2)": "(0,0)", "at(r1)": "(0,1)"}
    found = check(DOMAIN, RUG.static, {"T1": held}, {"T1": [("attach(r1)",)]},
                  details={"T1": {(0, "attach(r1)"): {"attach_point": "grip(rug,1)"}}})  # fmt: skip
    assert "attach_taken" in {violation.rule for violation in found}


def rules_of(start: Problem, told: str) -> set[str]:
    """The rules that a plan breaks on its way, whatever its goal says."""
    steps = [tuple(step.split()) for step in told.split("|")]
    found = check(DOMAIN, start.static, {"T1": start.state}, {"T1": steps})
    return {violation.rule for violation in found if violation.action != "goal"}


@pytest.mark.parametrize(
    ("start", "wrong", "right"),
    [
        (LATE, "goto(r1,1,0) | goto(r1,0,0) | attach(r1) | goto(r1,3,0) | goto(r1,3,1)",
         "goto(r1,1,0) | goto(r1,2,0) | goto(r1,0,0) | attach(r1) | goto(r1,3,0)"),
        (AWAY, "goto(r2,2,1) | goto(r2,3,1) | goto(r1,1,0)",
         "goto(r2,2,1) | goto(r2,3,1) | goto(r2,2,1) | goto(r1,1,0)"),
    ],
    ids=["early", "away"],
)  # fmt: skip
def test_what_is_not_yet_allowed_is_from_its_time_on(start: Problem, wrong: str, right: str) -> None:
    assert len(rules_of(start, wrong)) == 1
    assert rules_of(start, right) == set()


def test_who_carries_stays_when_the_other_one_may_not_go() -> None:
    held = {"r1": "grip(rug,1)", "r2": "grip(rug,2)"}
    start = problem([robot("r1", 0, 0), robot("r2", 0, 1)], heavy=[LONG], held=held,
                    never=[{"robot": "r2", "from": [0, 1], "to": [2, 1]}])  # fmt: skip
    found = check(DOMAIN, start.static, {"T1": start.state}, {"T1": [("goto(r1,2,0)", "goto(r2,2,1)")]})
    told = {(violation.action, violation.rule) for violation in found if violation.action != "goal"}
    assert told == {("goto(r1,2,0)", "held_back"), ("goto(r2,2,1)", "never")}


def test_every_rule_has_its_test_and_its_words() -> None:
    tested = {*BROKEN, "attach_apart", "attach_taken", "collision"}
    assert tested == set(load(DOMAIN).data.rules)


def test_the_furniture_that_is_between_is_named() -> None:
    start, told = BROKEN["no_way"]
    found = check(DOMAIN, start.static, {"T1": start.state}, {"T1": [(told,)]})
    texts = [violation.text for violation in found if violation.rule == "no_way"]
    assert texts == ["r1 has no way there: between are nightstand and shelf"]


def test_things_that_are_between_are_named_where_they_lie_at_that_step() -> None:
    found = check(DOMAIN, BROAD.static, {"T1": BROAD.state}, {"T1": [("goto(r1,2,1)",)]})
    (text,) = [violation.text for violation in found if violation.rule == "no_way"]
    assert text == "r1 has no way there: between are a, b, c"
    through = [("goto(r1,1,1)",), ("goto(r1,2,1)",)]  # what lies where a way begins is in nobody's way
    assert not [v for v in check(DOMAIN, BROAD.static, {"T1": BROAD.state}, {"T1": through}) if v.action != "goal"]


def test_time_is_that_of_the_way_that_is_driven() -> None:
    shelf = {"name": "shelf", "corners": [[110, 0], [190, 0], [190, 220], [110, 220]]}
    start = problem([robot("r1", 0, 0)], furniture=[shelf], deadline=1)
    assert [v.rule for v in check(DOMAIN, start.static, {"T1": start.state}, {"T1": [("goto(r1,2,0)",)]})] == [
        "deadline"
    ]


@pytest.mark.parametrize(("at", "end"), [((1, 1), (1, 0)), ((1, 0), (1, 1))])
def test_the_replay_looks_at_both_ends_of_a_thing(
    at: tuple[int, int], end: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A motion planner that overlooks things goes straight over one of them."""
    straight = Trajectory(((0.5, 1.5), (3.5, 1.5)), 3.0)
    monkeypatch.setattr(Oracle, "shortest", lambda *_: straight)
    start = problem([robot("r1", 0, 1)], heavy=[{"name": "rug", "kind": "cushion", "at": [*at], "end": [*end]}])
    found = check(DOMAIN, start.static, {"T1": start.state}, {"T1": [("goto(r1,3,1)",)]})
    assert "r1 would touch rug on its way" in {violation.text for violation in found}
