"""Every kind of disturbance: by script at a step, a time or an action, and on request."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from bus.faults import KINDS
from bus.messages import Contact, Execute, Impair, Inject, Injected, Order, ProcessFault
from bus.node import NoAnswer
from bus.scene import Fault
from tests.world.house import House, house, pot
from tests.world.stage import PERIOD_S, Stage, call, hand, piece, scene, tug


def stage_with(*faults: Fault, **more: Any) -> Stage:
    bodies = (hand("A", "h1", 2, 2), hand("A", "h2", 4, 2), tug("A", "t1", 2, 2), piece("A", 1, 6), piece("A", 2, 7))
    return Stage(scene(*bodies, hand("B", "h1", 2, 2), teams=2, faults=faults, **more))


# ---------------------------------------------------------------- triggers
def test_at_a_step() -> None:
    stage = stage_with(Fault("break", "A.h1", at_step=1))
    assert stage.step(0, A="go(h1,up)")["A"].state["at(h1)"] == "(2,3)"
    assert stage.step(1, A="go(h1,down)")["A"].state["at(h1)"] == "(2,3)"
    (event,) = stage.events("fault_injected")
    assert (event["kind"], event["target"], event["args"]) == ("break", "A.h1", {})
    assert stage.reasons() == ["h1 is broken"]


def test_at_a_step_that_is_skipped() -> None:
    stage = stage_with(Fault("break", "A.h1", at_step=1))
    stage.step(0, A="")
    stage.step(5, A="")
    stage.step(6, A="")
    assert len(stage.events("fault_injected")) == 1


def test_when_an_action_begins() -> None:
    stage = stage_with(Fault("break", "A.t1", on_action="A.join(t1, h1)"), Fault("break", "B.h1", on_action="B.shift"))
    assert stage.step(0, A="go(h2,up) shift", B="go(h1,up)")["B"].state["at(h1)"] == "(2,3)"
    assert stage.step(1, A="join(t1,h1)", B="shift")["A"].state["holds(t1)"] == "none"
    assert [e["target"] for e in stage.events("fault_injected")] == ["A.t1", "B.h1"]
    stage.step(2, A="join(t1,h1)")
    assert len(stage.events("fault_injected")) == 2


def test_at_a_time_while_nothing_else_happens() -> None:
    stage = stage_with(
        Fault("break", "A.h1", at_s=3.0), Fault("set", "A.1", at_s=0.0, args={"attribute": "state", "value": 2})
    )
    assert stage.world.next_s() == 0.0
    stage.advance(2.9)
    assert stage.state()["state(1)"] == 2
    assert stage.world.next_s() == pytest.approx(3.0)
    assert not stage.world.truth.things["A.h1"].broken
    stage.advance(0.2)
    assert stage.world.truth.things["A.h1"].broken
    assert stage.world.next_s() is None


def test_in_the_middle_of_a_period_bodies_are_disturbed_at_its_end() -> None:
    stage = stage_with(Fault("break", "A.h1", at_s=1.0))
    assert stage.step(0, A="go(h1,up)")["A"].state["at(h1)"] == "(2,3)"
    assert stage.world.truth.things["A.h1"].broken
    assert stage.reasons() == []


# ---------------------------------------------------------------- bodies
def test_a_person_moves_a_robot() -> None:
    stage = stage_with()
    assert stage.inject("move", "A.h1", x=5, y=3) == Injected(True)
    assert stage.state()["at(h1)"] == "(5,3)"
    assert stage.step(0, A="go(h1,left)")["A"].state["at(h1)"] == "(4,3)"


def test_a_robot_that_is_moved_is_uncoupled() -> None:
    stage = stage_with()
    stage.step(0, A="join(t1,h1)")
    stage.inject("move", "A.h1", x=5, y=3)
    state = stage.state()
    assert (state["at(h1)"], state["at(t1)"], state["holds(t1)"]) == ("(5,3)", "(2,2)", "none")
    assert stage.step(1, A="go(t1,up) go(h1,down)")["A"].state["at(t1)"] == "(2,3)"


def test_a_person_moves_an_object() -> None:
    stage = stage_with()
    assert stage.inject("move", "A.1", to=2).accepted
    assert stage.state()["line(1)"] == 2
    assert stage.step(0, A="shift")["A"].state["line(1)"] == 1
    assert stage.inject("move", "A.1", to=0).accepted
    assert stage.step(1, A="shift")["A"].state["line(1)"] == 0
    assert stage.inject("move", "A.1", to=4).accepted
    assert stage.step(2, A="shift")["A"].state["line(1)"] == 3


def test_a_person_changes_an_object() -> None:
    stage = stage_with()
    assert stage.inject("set", "A.1", attribute="state", value=3).accepted
    assert stage.inject("set", "A.2", attribute="hot", value=1).accepted
    state = stage.state()
    assert (state["state(1)"], state["hot(2)"]) == (3, 1)
    assert stage.step(0, A="")["A"].state["hot(2)"] == 0


@pytest.mark.parametrize(
    ("kind", "target", "args", "reason"),
    [
        ("explode", "A.h1", {}, "unknown kind 'explode'. Supported: break, move,"),
        ("break", "A.h9", {}, "there is no robot A.h9. There are: A.h1, A.h2, A.t1, B.h1"),
        ("break", "A.1", {}, "there is no robot A.1"),
        ("break", "A.h1", {"x": 1}, "break does not take x; it takes nothing"),
        ("move", "A.h1", {"x": 4, "y": 2}, "cell (4,2) is taken"),
        ("move", "A.h1", {"x": 6, "y": 2}, "A.h1 can be put on a cell of its workspace: x, y"),
        ("move", "A.h1", {"to": 2}, "A.h1 can be put on a cell of its workspace: x, y"),
        ("move", "A.1", {"to": 7}, "position 7 is taken"),
        ("move", "A.1", {"to": -1}, "A.1 can be put on a line position: to, 0 or more"),
        ("move", "C.1", {"to": 1}, "there is no C.1 in a workspace"),
        ("set", "A.1", {"attribute": "state"}, "set needs value"),
        ("set", "A.1", {"attribute": "colour", "value": 1}, "A.1 has no colour; it has state, hot"),
        ("set", "A.1", {"attribute": "state", "value": "x"}, "state of A.1 cannot be x"),
        ("set", "A.h1", {"attribute": "tool", "value": 1}, "there is no object A.h1"),
        ("order", "C", {"add": 1}, "a team gets at least one more object: C, 1"),
        ("order", "A", {"add": 0}, "a team gets at least one more object: A, 0"),
        ("cancel", "A", {"objects": 3}, "only 2 objects of A are on the line"),
        ("kill", "T9", {}, "there is no process 'T9'. There are: world, coordinator, A, B"),
        ("pause", "A", {"for_s": 0.0}, "for_s must be seconds, more than 0"),
        ("drop", "A->Z", {"share": 0.1}, "there is no process 'Z'. There are: world, coordinator, A, B"),
        ("drop", "A", {"share": 1.5}, "share must be a number from 0 to 1"),
        ("delay", "A", {"share": 0.5}, "delay needs for_s"),
        ("pause", "A", {"for_s": 1e308}, "for_s must be a number of at most 1,000,000"),
        ("pause", "A", {"for_s": 10**18}, "for_s must be a number of at most 1,000,000"),
        ("move", "A.1", {"to": 10**9}, "to must be a number of at most 1,000,000"),
        ("set", "A.1", {"attribute": "state", "value": 2**40}, "value must be a number of at most 1,000,000"),
        ("set", "A.1", {"attribute": "state", "value": -(2**40)}, "value must be a number of at most 1,000,000"),
        ("order", "A", {"add": 999_999}, "there is room for"),
        ("pause", "world", {"for_s": 1.0}, "the world cannot be paused: nobody would wake it"),
    ],
)
def test_what_cannot_be_is_refused_with_a_reason(kind: str, target: str, args: dict[str, Any], reason: str) -> None:
    stage = stage_with()
    before = stage.state()
    answer = stage.inject(kind, target, **args)
    assert not answer.accepted
    assert answer.reason.startswith(reason)
    assert stage.state() == before
    assert stage.events("fault_injected") == []


def test_a_script_that_cannot_be_is_told_and_not_tried_again() -> None:
    stage = stage_with(Fault("move", "A.h1", at_step=0, args={"x": 4, "y": 2}))
    stage.step(0, A="")
    stage.step(1, A="")
    (told,) = stage.events("refused")
    assert told["reason"] == "cell (4,2) is taken"


def test_a_request_in_the_middle_of_a_period_waits_for_its_end() -> None:
    stage = stage_with()
    stage.deliver(stage.mail("A", Execute("A", 0, (call("go(h1,up)"),))))
    stage.advance(1.0)
    assert stage.ask("operator", Inject("move", "A.h1", {"x": 5, "y": 1}), Injected) is None
    stage.advance(1.0)
    assert stage.bodies(Injected, "operator") == [Injected(True)]
    assert [e["state"]["at(h1)"] for e in stage.events("step_ended")] == ["(2,3)"]
    assert stage.state()["at(h1)"] == "(5,1)"


def test_a_lent_robot_is_known_by_either_name() -> None:
    stage = stage_with()
    stage.inject("move", "A.h1", x=1, y=1)
    stage.step(0, A="give(h1)")
    stage.step(1, A="")
    stage.step(2, B=[call("take(h7,1,1)", robot="A.h1")])
    assert stage.inject("break", "B.h7").accepted
    assert stage.world.truth.things["A.h1"].broken
    assert stage.inject("move", "A.h1", x=3, y=1).accepted
    assert stage.state("B")["at(h7)"] == "(3,1)"


# ---------------------------------------------------------------- orders
def test_more_objects_queue_up_behind_all_others() -> None:
    stage = stage_with(Fault("order", "A", at_step=0, args={"add": 2}))
    state = stage.step(0, A="shift")["A"].state
    assert [state[f"line({i})"] for i in (1, 2, 3, 4)] == [5, 6, 7, 8]
    assert (state["state(3)"], state["hot(4)"]) == (0, 0)
    assert stage.bodies(Order, "coordinator") == [Order("A", added=("3", "4"))]
    (event,) = stage.events("order")
    assert (event["team"], event["added"], event["cancelled"]) == ("A", ["3", "4"], [])
    assert set(stage.events("membership")[-1]["objects"]) == {"A.1", "A.2", "A.3", "A.4"}


def test_the_first_objects_of_a_team_begin_behind_the_line() -> None:
    stage = stage_with()
    assert stage.inject("order", "B", add=1).accepted
    assert stage.state("B")["line(1)"] == 6


def test_the_last_objects_are_cancelled_and_their_names_not_given_again() -> None:
    stage = stage_with()
    assert stage.inject("cancel", "A", objects=1).accepted
    assert "line(2)" not in stage.state()
    assert stage.bodies(Order, "coordinator") == [Order("A", cancelled=("2",))]
    assert set(stage.events("order")[0]["cancelled"]) == {"2"}
    assert stage.inject("order", "A", add=1).accepted
    state = stage.step(0, A="shift")["A"].state
    assert (state["line(1)"], state["line(3)"]) == (5, 6)
    assert stage.inject("set", "A.2", attribute="state", value=1).accepted is False


# ---------------------------------------------------------------- processes and links
@pytest.mark.parametrize("kind", ["kill", "restart"])
def test_processes_are_the_supervisors(kind: str) -> None:
    stage = stage_with(Fault(kind, "A", at_step=0))
    stage.step(0, A="")
    assert stage.asked == [ProcessFault(kind, "A")]  # type: ignore[arg-type]
    assert stage.inject(kind, "world") == Injected(True)
    assert stage.asked[1] == ProcessFault(kind, "world")  # type: ignore[arg-type]


def test_who_is_paused_is_resumed_in_simulated_time() -> None:
    stage = stage_with(Fault("pause", "A", at_step=0, args={"for_s": 5.0}))
    stage.step(0, A="", B="")
    assert stage.asked == [ProcessFault("pause", "A")]
    assert stage.world.next_s() == pytest.approx(5.0)
    stage.advance(PERIOD_S)
    assert len(stage.asked) == 1
    stage.advance(PERIOD_S)
    assert stage.asked[1:] == [ProcessFault("resume", "A")]
    assert stage.world.next_s() is None


def test_without_a_supervisor_nothing_is_claimed() -> None:
    stage = stage_with()

    def silent(to: str, body: object, timeout_s: float) -> Any:
        raise NoAnswer("supervisor did not answer")

    stage.node.ask = silent  # type: ignore[method-assign]
    assert stage.inject("kill", "A") == Injected(False, "supervisor did not answer")


def test_a_team_that_acts_for_itself_can_be_stopped_for_good(tmp_path: Path) -> None:
    stage = House(house(pot("A", "1", 2, 2)), tmp_path)
    assert stage.inject("stop", "A").accepted
    assert stage.asked == [ProcessFault("stop", "A")]
    assert stage.node.post.given_up == ["A"]
    stage = stage.again()
    assert stage.node.post.given_up == ["A"], "the next world does not wait for it either"
    assert "there is no team 'world'" in stage.inject("stop", "world").reason
    conducted = stage_with()
    assert "all others would wait for it" in conducted.inject("stop", "A").reason
    assert conducted.asked == []


def test_links_are_each_nodes_own_and_add_up() -> None:
    stage = stage_with()
    assert stage.inject("drop", "A", share=0.1).accepted
    assert stage.inject("delay", "A>coordinator", share=0.2, for_s=0.5).accepted
    assert stage.inject("repeat", "A->coordinator", share=0.3).accepted
    assert stage.bodies(Impair, "A") == [
        Impair("*", drop=0.1, seed=1),
        Impair("coordinator", late=0.2, late_s=0.5, seed=1),
        Impair("coordinator", late=0.2, late_s=0.5, repeat=0.3, seed=1),
    ]


def test_everybodys_links_include_our_own() -> None:
    stage = stage_with()
    assert stage.inject("repeat", "*", share=1.0).accepted
    for name in ("coordinator", "A", "B"):
        # Our own mail is repeated from now on: it comes twice.
        assert stage.bodies(Impair, name) == [Impair("*", repeat=1.0, seed=1)] * 2


def test_every_kind_of_the_vocabulary_is_supported() -> None:
    arguments: dict[str, dict[str, Any]] = {
        "move": {"x": 5, "y": 3}, "set": {"attribute": "state", "value": 1}, "order": {"add": 1},
        "cancel": {"objects": 1}, "pause": {"for_s": 1.0}, "drop": {"share": 0.0},
        "delay": {"share": 0.0, "for_s": 1.0}, "repeat": {"share": 0.0}, "deadline": {"units": 9},
        "bring": {"what": "ball", "x": 3, "y": 3},
    }  # fmt: skip
    targets = {
        "robot": "A.h1", "body": "A.h1", "object": "A.1", "new": "A.ball", "team": "A", "process": "A", "link": "A"
    }  # fmt: skip
    for kind, known in KINDS.items():
        in_room = kind in ("bring", "take", "stop", "deadline")
        stage = House(house(pot("A", "1", 2, 2))) if in_room else stage_with()
        assert stage.inject(kind, targets[known.on], **arguments.get(kind, {})) == Injected(True), kind
        assert [e["kind"] for e in stage.events("fault_injected")] == [kind]


# ---------------------------------------------------------------- contact
def test_who_is_lost_from_sight_is_reported_to_the_coordinator() -> None:
    stage = stage_with()
    stage.world.on_contact("A", "present")
    stage.world.on_contact("A", "lost_contact")  # told when what was told before has been confirmed: see test_herald
    stage.world.on_contact("coordinator", "lost_contact")
    assert stage.bodies(Contact, "coordinator") == [Contact("A", "present")]
    assert [(e["name"], e["state"]) for e in stage.events("contact")] == [
        ("A", "present"),
        ("A", "lost_contact"),
        ("coordinator", "lost_contact"),
    ]
