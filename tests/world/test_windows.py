"""When steps are carried out, together with whom, and that each is carried out once."""

from __future__ import annotations

import pytest

from bus.messages import Envelope, Execute, Executed, Observe, Observed, Ok, Status
from tests.world.stage import PERIOD_S, Stage, call, hand, piece, scene


def three(**more: object) -> Stage:
    return Stage(scene(*(hand(t, "h1", 2, 2) for t in "ABC"), teams=3, **more))  # type: ignore[arg-type]


def execute(stage: Stage, team: str, step: int, text: str = "go(h1,right)", name: str = "") -> Envelope:
    return stage.mail(team, Execute(team, step, (call(text),)), name)


def executed(stage: Stage) -> list[tuple[str, int, float]]:
    return [(m.body.team, m.body.step, m.at_s) for _, m in stage.sent if isinstance(m.body, Executed)]


def test_all_that_are_there_share_a_window_and_it_begins_at_once() -> None:
    stage = three()
    stage.deliver(*(execute(stage, team, 4) for team in "CAB"))
    assert [e["team"] for e in stage.events("step_started")] == ["A", "B", "C"]
    assert stage.world.next_s() == PERIOD_S
    stage.advance(PERIOD_S)
    assert executed(stage) == [("A", 4, 2.0), ("B", 4, 2.0), ("C", 4, 2.0)]
    assert stage.world.next_s() is None
    assert [e["command"] for e in stage.events("step_ended")] == [e["command"] for e in stage.events("step_started")]


def test_a_team_may_join_while_nothing_moves_yet_and_not_later() -> None:
    stage = three()
    stage.deliver(execute(stage, "A", 0))
    stage.advance(0.1)
    stage.deliver(execute(stage, "B", 0))
    stage.advance(0.3)
    stage.deliver(execute(stage, "C", 0))
    stage.advance(PERIOD_S - 0.4)
    assert executed(stage) == [("A", 0, 2.0), ("B", 0, 2.0)]
    assert stage.state("A")["at(h1)"] == stage.state("B")["at(h1)"] == "(3,2)"
    stage.advance(PERIOD_S)
    assert executed(stage)[2:] == [("C", 0, 4.0)]


def test_a_team_has_one_command_a_window() -> None:
    stage = three()
    stage.deliver(execute(stage, "A", 0), execute(stage, "A", 1))
    stage.advance(2 * PERIOD_S + 0.01)
    assert executed(stage) == [("A", 0, 2.0), ("A", 1, 4.0)]
    assert stage.state()["at(h1)"] == "(4,2)"


def test_the_same_command_again_is_executed_once_and_answered_again() -> None:
    stage = three()
    first = execute(stage, "A", 0, name="A.step.0")
    stage.deliver(first, first)
    stage.deliver(first)
    stage.advance(PERIOD_S)
    stage.deliver(first)
    stage.advance(2 * PERIOD_S)
    replies = [m for _, m in stage.sent if isinstance(m.body, Executed)]
    assert [(m.re, m.id) for m in replies] == [("A.step.0", "re.A.step.0")] * 2
    assert replies[0].body == replies[1].body
    assert stage.state()["at(h1)"] == "(3,2)"
    assert len(stage.events("step_started")) == len(stage.events("step_ended")) == 1


def test_the_global_step_is_the_highest_of_the_window() -> None:
    stage = three()
    stage.deliver(execute(stage, "A", 3), execute(stage, "B", 5))
    stage.advance(PERIOD_S)
    assert stage.events("membership")[-1]["step"] == 5
    assert stage.bodies(Status)[-1].step == 5


def test_looking_waits_for_the_end_of_the_own_step() -> None:
    stage = three()
    stage.deliver(execute(stage, "A", 0))
    stage.advance(1.0)
    assert stage.ask("A", Observe("A"), Observed) is None
    assert stage.ask("B", Observe("B"), Observed).state["at(h1)"] == "(2,2)"
    stage.advance(1.0)
    assert [o.state["at(h1)"] for o in stage.bodies(Observed, "A")] == ["(3,2)"]


def test_what_is_not_ones_own_is_refused() -> None:
    stage = three()
    before = stage.state("B")
    stage.deliver(stage.mail("A", Execute("B", 0, (call("go(h1,right)"),))))
    stage.deliver(stage.mail("X", Execute("X", 0)), stage.mail("X", Observe("X")), stage.mail("A", Observe("B")))
    stage.advance(PERIOD_S)
    assert stage.state("B") == before
    assert len(stage.bodies(Ok)) == 4
    assert stage.node.post.inbox.refused == {"not_yours": 4}


def test_without_anything_to_do_time_is_free_to_pass() -> None:
    stage = three()
    assert stage.world.next_s() is None
    stage.now_s = 1000.0
    stage.world.advance(1000.0)
    assert stage.world.now_s == pytest.approx(1000.0)
    stage.deliver(execute(stage, "A", 0))
    stage.advance(PERIOD_S)
    assert executed(stage) == [("A", 0, 1002.0)]


def test_time_may_come_in_any_portions() -> None:
    whole, pieces = three(), three()
    for stage in (whole, pieces):
        stage.deliver(*(execute(stage, team, 0) for team in "ABC"))
    whole.advance(PERIOD_S)
    for _ in range(287):
        pieces.now_s += 0.007
        pieces.world.advance(pieces.now_s)
    frames = [stage.world.truth.save() for stage in (whole, pieces)]
    assert frames[0] == frames[1]


def test_what_is_recorded_of_a_step() -> None:
    stage = Stage(scene(hand("A", "h1", 3, 3), piece("A", 1, 3)))
    stage.step(7, A="work(h1,1) go(h1,up)")
    assert stage.events("started") == [
        {"text": "the world is up", "incarnation": 1, "role": "world", "recovered": False, "step": -1}
    ]
    (begun,) = stage.events("step_started")
    assert (begun["team"], begun["step"], begun["actions"]) == ("A", 7, ["work(h1,1)", "go(h1,up)"])
    (failed,) = stage.events("skill_failed")
    assert (failed["team"], failed["step"], failed["action"]) == ("A", 7, "go(h1,up)")
    (ended,) = stage.events("step_ended")
    assert ended["state"] == stage.bodies(Executed)[0].state
    assert stage.events("membership")[-1] == {
        "text": "who is where after step 7",
        "step": 7,
        "robots": {"A.h1": ["A", "h1"]},
        "objects": {"A.1": {"line": 3, "state": 1, "hot": 1}},
    }
