"""Recordings of teams that act for themselves before the independent checker: as they were made, and spoiled."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import pytest

from bus.messages import BodyFrame, Envelope, Event, Frame, Value
from ops.cli import main
from ops.recorded import check_run, static_beside
from ops.recorded_rooms import AT_DOORS, BETWEEN, DISTURBED, LATE, UNFINISHED, UNSEEN, Judged
from ops.recording import Recording
from tests.system.whole import ended

pytestmark = pytest.mark.slow

Data = dict[str, Any]


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of one whole run of the kitchen, 16 steps of a robot that is alone."""
    return tmp_path_factory.mktemp("kitchen")


@pytest.fixture(scope="module")
def kitchen(home: Path) -> Recording:
    return ended("housekeeping/kitchen", home, "--clock", "fast").recording


def judged(recording: Recording, home: Path, **more: Value) -> Judged:
    static = static_beside(home / "record")
    assert static is not None
    return check_run(recording, {**static, **more})


def rules(found: Judged) -> set[tuple[int, str, str]]:
    return {(violation.step, violation.action, violation.rule) for violation in found.violations}


def events(recording: Recording, change: Callable[[str, Data], Data | None]) -> Recording:
    """With the data of the world's events changed; without those of which nothing is left."""
    out = []
    for envelope in recording.events:
        if isinstance(envelope.body, Event) and envelope.src == "world":
            data = change(envelope.body.kind, envelope.body.data)
            if data is None:
                continue
            envelope = msgspec.structs.replace(envelope, body=Event(envelope.body.kind, data))
        out.append(envelope)
    return replace(recording, events=tuple(out))


def spoiled(recording: Recording, actions: Mapping[int, list[str]], team: str = "kitchen") -> Recording:
    """As if these actions had been carried out in these steps."""
    return events(
        recording,
        lambda kind, data: (
            {**data, "actions": actions[data["step"]]}
            if kind == "step_started" and data["team"] == team and data["step"] in actions
            else data
        ),
    )


def frames(recording: Recording, change: Callable[[Frame], Frame | None]) -> Recording:
    out = []
    for envelope in recording.frames:
        assert isinstance(envelope.body, Frame)
        frame = change(envelope.body)
        out += [msgspec.structs.replace(envelope, body=frame)] if frame is not None else []
    return replace(recording, frames=tuple(out))


def said(recording: Recording, at_s: float, event: str, /, **data: object) -> Recording:
    """With one more event of the world, the last of those that it said by then."""
    last = max((e for e in recording.events if e.src == "world" and e.at_s <= at_s), key=lambda e: (e.inc, e.seq))
    more: Envelope = msgspec.structs.replace(last, at_s=at_s, body=Event(event, data))
    return replace(recording, events=(*recording.events, more))


def begun_s(recording: Recording, step: int) -> float:
    started = [e for e in recording.events if isinstance(e.body, Event) and e.body.kind == "step_started"]
    return next(e.at_s for e in started if isinstance(e.body, Event) and e.body.data["step"] == step)


def test_a_run_has_no_violations(capsys: pytest.CaptureFixture[str], kitchen: Recording, home: Path) -> None:
    assert judged(kitchen, home) == Judged([], {})
    code = main(("check", str(home / "record"), "--json"))
    told = json.loads(capsys.readouterr().out)
    assert (code, told["ok"], told["violations"], told["not_judged"]) == (0, True, [], {})


def test_spoiled_actions_are_told_with_their_rules(kitchen: Recording, home: Path) -> None:
    """Every step is judged from the truth before it, so one that is wrong does not spoil those after it."""
    wrong = {
        0: (["attach(r2)"], "attach_air"),
        1: (["detach(r2)"], "detach_free"),
        2: (["goto(r2,5,5)"], "stays"),
        3: (["goto(r2,8,3)"], "unknown"),
        5: (["attach(r7)"], "unknown"),
        7: (["attach(r2)"], "attach_tied"),
        9: (["fly(r2)"], "unknown"),
        11: (["detach("], "unknown"),
    }
    found = judged(spoiled(kitchen, {step: actions for step, (actions, _) in wrong.items()}), home)
    assert rules(found) == {(step, actions[0], rule) for step, (actions, rule) in wrong.items()}


def test_what_the_world_refused_is_no_violation(kitchen: Recording, home: Path) -> None:
    run = spoiled(kitchen, {0: ["attach(r2)"]})
    failed = {"team": "kitchen", "step": 0, "action": "attach(r2)", "reason": "nothing is there for r2"}
    assert rules(judged(run, home)) == {(0, "attach(r2)", "attach_air")}
    assert judged(said(run, 1.0, "skill_failed", **failed), home) == Judged([], {})


def test_what_people_do_meanwhile_is_no_violation(kitchen: Recording, home: Path) -> None:
    run = spoiled(kitchen, {0: ["attach(r2)"]})
    brought = said(run, 1.0, "fault_injected", kind="bring", target="kitchen.cup", args={})
    assert judged(brought, home) == Judged([], {DISTURBED: 1})
    elsewhere = said(run, 1.0, "fault_injected", kind="bring", target="bedroom.cup", args={})
    assert rules(judged(elsewhere, home)) == {(0, "attach(r2)", "attach_air")}


def test_the_goal_counts_with_the_deadline_as_it_was_last(kitchen: Recording, home: Path) -> None:
    late = said(kitchen, 1.0, "order", team="kitchen", added=[], cancelled=[], deadline=23)
    assert rules(judged(late, home)) == {(16, "goal", "deadline")}
    assert judged(said(late, 2.0, "order", team="kitchen", added=[], cancelled=[], deadline=0), home) == Judged([], {})
    elsewhere: dict[str, Value] = {"area(kitchen,kitchen)": "(0,0,0,0)"}
    assert (16, "goal", "goal_place") in rules(judged(kitchen, home, **elsewhere))
    over_s = max(e.at_s for e in kitchen.events if isinstance(e.body, Event) and e.body.kind == "run_over")
    changed = said(kitchen, over_s, "fault_injected", kind="move", target="kitchen.mug", args={})
    assert judged(changed, home, **elsewhere).unjudged.keys() == {DISTURBED}


def test_a_run_that_stopped_early_is_not_blamed_for_its_goal(kitchen: Recording, home: Path) -> None:
    end_s = begun_s(kitchen, 9)
    early = replace(kitchen, events=tuple(e for e in kitchen.events if e.at_s <= end_s))
    assert judged(early, home) == Judged([], {UNFINISHED: 1})


def test_what_was_not_shown_is_not_judged(kitchen: Recording, home: Path) -> None:
    """Frames may be lost: two steps begin while there are none."""
    from_s, to_s = begun_s(kitchen, 4) - 1.0, begun_s(kitchen, 5)
    dark = frames(kitchen, lambda frame: None if from_s <= frame.at_s <= to_s else frame)
    assert judged(spoiled(dark, {4: ["detach(r2)"], 5: ["detach(r2)"]}), home) == Judged([], {UNSEEN: 2})


def test_ways_from_between_two_cells_are_not_judged(kitchen: Recording, home: Path) -> None:
    begins_s = begun_s(kitchen, 4)

    def aside(body: BodyFrame) -> BodyFrame:
        return msgspec.structs.replace(body, x_m=body.x_m + 0.2) if body.name == "r2" else body

    run = frames(
        kitchen,
        lambda frame: (
            msgspec.structs.replace(frame, bodies=tuple(map(aside, frame.bodies)))
            if abs(frame.at_s - begins_s) < 0.05
            else frame
        ),
    )
    assert judged(run, home) == Judged([], {BETWEEN: 1})


def test_conditions_on_a_plans_last_steps_are_not_judged(kitchen: Recording, home: Path) -> None:
    assert judged(kitchen, home, **{"late(kitchen,0)": "(mug,3)"}) == Judged([], {LATE: 1})


def test_guests_and_heavy_things_are_judged_by_the_rules(tmp_path: Path) -> None:
    """Two robots carry what is heavy, one of them a guest; alone neither may."""
    run = ended("housekeeping/both_ask", tmp_path, "--clock", "fast").recording
    assert judged(run, tmp_path).violations == []
    assert judged(run, tmp_path).unjudged.keys() == {AT_DOORS}
    pairs = [e.body.data for e in run.events if isinstance(e.body, Event) and e.body.kind == "step_started"
             and len(list(e.body.data["actions"])) == 2]  # type: ignore[call-overload]  # fmt: skip
    carried = [data for data in pairs if data["team"] == "bedroom" and "goto" in str(data["actions"])][-1]
    step, (first, _) = int(str(carried["step"])), list(carried["actions"])  # type: ignore[call-overload]
    assert (step, first, "alone") in rules(judged(spoiled(run, {step: [first]}, "bedroom"), tmp_path))
