"""Robots that change teams: to the bench, waiting there, and away from it."""

from __future__ import annotations

from math import dist

import pytest

from bus.scene import Transport
from tests.world.stage import Stage, call, hand, scene, tug


def stage_with(delay: int = 2, teams: int = 3, **more: object) -> Stage:
    return Stage(scene(hand("A", "h1", 1, 2), hand("B", "h1", 1, 2), teams=teams, delay=delay, **more))  # type: ignore[arg-type]


def place(stage: Stage, robot: str = "A.h1") -> str:
    return stage.world.truth.things[robot].place


def test_given_a_robot_is_no_longer_sensed_and_belongs_to_the_bench() -> None:
    stage = stage_with()
    assert stage.step(0, A="give(h1)")["A"].state == {}
    assert stage.events("membership")[-1]["robots"] == {"A.h1": ["bench", "A.h1"], "B.h1": ["B", "h1"]}
    assert "at(h1)" in stage.state("B")


@pytest.mark.parametrize("delay", [1, 2, 3, 5])
def test_it_can_be_taken_after_the_delay_and_not_before(delay: int) -> None:
    stage = stage_with(delay)
    stage.step(0, A="give(h1)")
    for step in range(1, delay):
        assert stage.step(step, C=[call("take(h7,1,3)", robot="A.h1")])["C"].state == {}
    assert stage.reasons() == ["A.h1 is not on the bench"] * (delay - 1)
    truth = stage.world.truth
    assert dist(truth.floor.where("A.h1"), truth.layout.slot("A.h1")) < 0.01
    state = stage.step(delay, C=[call("take(h7,1,3)", robot="A.h1", tool=3)])["C"].state
    assert state == {"at(h7)": "(1,3)", "tool(h7)": 3}
    assert stage.events("membership")[-1]["robots"]["A.h1"] == ["C", "h7"]
    assert truth.floor.where("A.h1") == truth.layout.cell("C", 1, 3)
    assert stage.step(delay + 1, C="go(h7,right)")["C"].state["at(h7)"] == "(2,3)"


def test_it_waits_on_the_bench_as_long_as_need_be() -> None:
    stage = stage_with()
    stage.step(0, A="give(h1)")
    stage.advance(30.0)
    before = stage.world.truth.floor.where("A.h1")
    stage.advance(30.0)
    assert stage.world.truth.floor.where("A.h1") == before
    assert stage.step(1, A=[call("take(h1,1,1)", robot="A.h1")])["A"].state["at(h1)"] == "(1,1)"


def test_all_robots_can_travel_at_once() -> None:
    teams = "ABCDEFGHIJ"
    stage = Stage(scene(*(hand(t, "h1", 1, 1) for t in teams), teams=10))
    stage.step(0, **dict.fromkeys(teams, "give(h1)"))
    stage.step(1, **dict.fromkeys(teams, ""))
    moves = {t: [call("take(h2,1,2)", robot=f"{u}.h1")] for t, u in zip(teams, teams[::-1], strict=True)}
    assert all(done.state["at(h2)"] == "(1,2)" for done in stage.step(2, **moves).values())
    assert stage.reasons() == []


def test_following_into_the_dock_and_out_of_it() -> None:
    stage = Stage(scene(hand("A", "h1", 1, 2), hand("A", "h2", 2, 2), hand("B", "h1", 1, 1), teams=2))
    assert stage.step(0, A="give(h1) go(h2,left)")["A"].state == {"at(h2)": "(1,2)", "tool(h2)": 1}
    stage.step(1, A="")
    state = stage.step(2, A=[call("go(h2,right)"), call("take(h3,1,2)", robot="A.h1")])["A"].state
    assert (state["at(h2)"], state["at(h3)"]) == ("(2,2)", "(1,2)")


@pytest.mark.parametrize(
    ("robot", "action", "reason"),
    [
        (hand("A", "h1", 2, 1), "give(h1)", "h1 is not in the dock"),
        (hand("A", "h1", 1, 1, broken=True), "give(h1)", "h1 is broken"),
        (hand("A", "h1", 1, 1), "give(h2)", "there is no robot h2"),
    ],
)
def test_giving_that_is_impossible(robot: object, action: str, reason: str) -> None:
    stage = Stage(scene(robot))  # type: ignore[arg-type]
    stage.step(0, A=action)
    assert stage.reasons() == [reason]
    assert place(stage) == "A"


@pytest.mark.parametrize(
    ("text", "detail", "reason"),
    [
        ("take(h2,2,1)", {"robot": "A.h1"}, "(2,1) is not in the dock"),
        ("take(h2,1,4)", {"robot": "A.h1"}, "(1,4) is not in the dock"),
        ("take(h2,x,1)", {"robot": "A.h1"}, "(None,1) is not in the dock"),
        ("take(h1,1,1)", {"robot": "A.h1"}, "there is a h1 already"),
        (f"take({'h' * 32},1,1)", {"robot": "A.h1"}, f"a robot cannot be called {'h' * 32}"),
        ("take(2,1,1)", {"robot": "A.h1"}, "a robot cannot be called 2"),
        ("take(h2,1,2)", {"robot": "A.h1"}, "h1 is in (1,2)"),
        ("take(h2,1,1)", {"robot": "B.h1"}, "B.h1 is not on the bench"),
        ("take(h2,1,1)", {}, "None is not on the bench"),
        ("take(h2,1,1)", {"robot": "A.h1", "colour": 1}, "colour of A.h1 cannot be 1"),
        ("take(h2,1,1)", {"robot": "A.h1", "tool": "x"}, "tool of A.h1 cannot be x"),
    ],
)
def test_taking_that_is_impossible(text: str, detail: dict[str, int | str], reason: str) -> None:
    stage = stage_with()
    stage.step(0, A="give(h1)")
    stage.advance(10.0)
    stage.step(2, B=[call(text, **detail)])
    assert stage.reasons() == [reason]
    assert place(stage) == "bench"
    assert stage.step(3, B=[call("take(h2,1,1)", robot="A.h1")])["B"].state["at(h2)"] == "(1,1)"


def test_one_robot_is_not_taken_by_two() -> None:
    stage = stage_with()
    stage.step(0, A="give(h1)")
    stage.advance(10.0)
    moves = [call("take(h2,1,1)", robot="A.h1")]
    done = stage.step(2, A=moves, C=moves)
    assert [len(done[team].state) for team in "AC"] == [2, 0]
    assert stage.reasons() == ["A.h1 cannot come: take(h2,1,1) of A came first"]


def test_nobody_couples_to_who_is_leaving() -> None:
    stage = Stage(scene(hand("A", "h1", 1, 1), tug("A", "t1", 1, 1)))
    assert stage.step(0, A="join(t1,h1) give(h1)")["A"].state == {"at(t1)": "(1,1)", "holds(t1)": "none"}
    assert place(stage) == "bench"


def test_a_broken_robot_is_brought_all_the_same() -> None:
    stage = stage_with()
    stage.step(0, A="give(h1)")
    assert stage.inject("break", "A.h1").accepted
    stage.step(1, A="")
    assert stage.step(2, C=[call("take(h2,1,1)", robot="A.h1")])["C"].state["at(h2)"] == "(1,1)"
    assert stage.step(3, C="go(h2,right)")["C"].state["at(h2)"] == "(1,1)"


def test_a_robot_may_begin_on_the_bench() -> None:
    from bus.scene import Entity

    stage = Stage(scene(Entity("A.h1", "A", "h1", "hand", "bench", {"tool": 1})))
    assert stage.state() == {}
    assert stage.step(0, A=[call("take(h4,1,1)", robot="A.h1")])["A"].state["at(h4)"] == "(1,1)"


def test_transport_may_take_longer_to_one_team_than_to_another() -> None:
    stage = stage_with(transports=(Transport("A", "C", 3),))
    stage.step(0, A="give(h1)")
    stage.step(1)
    assert stage.step(2, C=[call("take(h2,1,3)", robot="A.h1")])["C"].state == {}
    assert stage.reasons() == ["A.h1 is still on its way to C"]
    assert stage.step(3, C=[call("take(h2,1,3)", robot="A.h1")])["C"].state["at(h2)"] == "(1,3)"
    stage = stage_with(transports=(Transport("A", "C", 1),))
    stage.step(0, A="give(h1)")
    assert stage.step(1, C=[call("take(h2,1,3)", robot="A.h1")])["C"].state["at(h2)"] == "(1,3)"
