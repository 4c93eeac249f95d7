"""The verdict as a function of events."""

from __future__ import annotations

from typing import Any

import pytest

from bus.messages import SCHEMA_VERSION, Beat, Body, Envelope, Event, RunOver
from ops.scenario import Verdict
from ops.verdict import NOT_OVER, judge, matches

OVER = RunOver(True, "every team has reached its goal", 27, 1)


def said(src: str, body: Body, seq: int = 1, inc: int = 1) -> Envelope:
    return Envelope(SCHEMA_VERSION, "run", src, inc, seq, f"{src}.{inc}.{seq}", 0.0, body)


def event(src: str, kind: str, **data: object) -> Envelope:
    return said(src, Event(kind, {"text": f"{kind} it is", **data}))


EVENTS = (
    event("coordinator", "shared_plan", status="optimal", makespan=27, start=0),
    event("T4", "diagnosis", team="T4", step=16, causes=[["broken(c1)"], ["broken(w1)"]]),
    event("T4", "repair", team="T4", robot="c1"),
)


def test_a_plain_goal() -> None:
    report = judge(Verdict(), EVENTS, OVER)
    assert (report.goal, report.makespan, report.replans, report.exit_code) == (True, 27, 1, 0)
    assert [condition.text for condition in report.conditions] == ["goal reached"]
    assert report.diagnoses[0]["causes"] == [["broken(c1)"], ["broken(w1)"]]


@pytest.mark.parametrize(
    ("verdict", "ok"),
    [
        (Verdict(makespan_at_most=27), True),
        (Verdict(makespan_at_most=26), False),
        (Verdict(optimal=True), True),
        (Verdict(optimal=False), False),
        (Verdict(eventually=({"event": "repair", "team": "T4"},)), True),
        (Verdict(eventually=({"event": "repair", "source": "T4"},)), True),
        (Verdict(eventually=({"event": "repair", "team": "T1"},)), False),
        (Verdict(eventually=({"event": "repair", "colour": "red"},)), False),
        (Verdict(eventually=({"event": "diagnosis", "causes": [["broken(c1)"], ["broken(w1)"]]},)), True),
        (Verdict(eventually=({"event": "diagnosis", "causes": [["broken(c1)"]]},)), False),
        (Verdict(never=({"event": "discrepancy"},)), True),
        (Verdict(never=({"event": "repair"},)), False),
        (Verdict(goal=False), False),
    ],
)
def test_conditions(verdict: Verdict, ok: bool) -> None:
    report = judge(verdict, EVENTS, OVER)
    assert all(condition.ok for condition in report.conditions) is ok
    assert report.exit_code == (0 if ok else 1)


def test_an_unreachable_goal_fails_the_run_even_if_it_was_expected() -> None:
    report = judge(Verdict(goal=False), (), RunOver(False, "no plan: nobody can paint", 0, 0))
    assert all(condition.ok for condition in report.conditions)
    assert report.exit_code == 1
    assert report.reason == "no plan: nobody can paint"


def test_a_broken_invariant_outweighs_everything() -> None:
    assert judge(Verdict(), EVENTS, OVER, ("T1.w1 is in two teams",)).exit_code == 3
    assert judge(Verdict(), EVENTS, OVER, ()).exit_code == 0


def test_a_run_that_stopped_early_says_why() -> None:
    assert judge(Verdict(), EVENTS, None).reason == NOT_OVER
    report = judge(Verdict(makespan_at_most=30), EVENTS, None, stopped="T1 died 6 times")
    assert (report.goal, report.reason, report.exit_code) == (False, "T1 died 6 times", 1)
    assert not any(condition.ok for condition in report.conditions)


def test_a_given_plan_is_not_judged_for_optimality() -> None:
    given = event("coordinator", "shared_plan", status="given")
    assert judge(Verdict(optimal=True), (given, *EVENTS), OVER).exit_code == 0
    assert judge(Verdict(optimal=True), (given,), OVER).exit_code == 1


def test_messages_are_summed_over_lives() -> None:
    beats = [
        said("T1", Beat(1, sent=5, received=4), inc=1),
        said("T1", Beat(1, sent=9, received=8), inc=1),
        said("T1", Beat(2, sent=2, refused=1), inc=2),
        said("world", Beat(3, sent=10)),
    ]
    messages = judge(Verdict(), EVENTS, OVER, beats=beats).messages
    assert (messages.sent, messages.received, messages.refused) == (21, 8, 1)


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [
        ({"event": "order"}, True),
        ({"event": "order", "added": ["3", "4"]}, True),
        ({"event": "order", "added": ["3"]}, False),
        ({"event": "order", "nested": {"a": [1]}}, True),
        ({"event": "contact"}, False),
    ],
)
def test_patterns_match_subsets(pattern: dict[str, Any], expected: bool) -> None:
    assert matches(pattern, "world", Event("order", {"added": ("3", "4"), "nested": {"a": (1,)}})) is expected


@pytest.mark.parametrize(("status", "code"), [("optimal", 0), ("feasible", 1)])
def test_plans_of_teams_that_act_for_themselves_are_judged_like_shared_ones(status: str, code: int) -> None:
    plans = (event("kitchen", "plan_adopted", status="optimal"), event("bedroom", "plan_adopted", status=status))
    assert judge(Verdict(optimal=True), plans, OVER).exit_code == code
