"""Coupling, tools, work at the line, and what people do."""

from __future__ import annotations

from math import dist

import pytest

from tests.world.stage import Stage, hand, piece, scene, tug


# ---------------------------------------------------------------- coupling
def test_coupled_bodies_move_together_since_a_joint_pulls() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 1), tug("A", "t1", 2, 1)))
    assert stage.step(0, A="join(t1,h1)")["A"].state["holds(t1)"] == "h1"
    apart: list[float] = []
    floor, inner = stage.world.truth.floor, stage.world.truth.floor.step

    def watched(times: int) -> None:
        for _ in range(times):
            inner(1)
            apart.append(dist(floor.where("A.h1"), floor.where("A.t1")))

    floor.step = watched  # type: ignore[method-assign]
    state = stage.step(1, A="push(t1)")["A"].state
    assert (state["at(h1)"], state["at(t1)"]) == ("(2,2)", "(2,2)")
    assert apart
    assert max(apart) < 0.001
    state = stage.step(2, A="pull(t1)")["A"].state
    assert (state["at(h1)"], state["at(t1)"]) == ("(2,1)", "(2,1)")
    assert stage.step(3, A="part(t1)")["A"].state["holds(t1)"] == "none"
    state = stage.step(4, A="go(t1,up)")["A"].state
    assert (state["at(h1)"], state["at(t1)"]) == ("(2,1)", "(2,2)")
    assert stage.reasons() == []


def test_without_the_joint_nobody_is_pulled() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 1), tug("A", "t1", 2, 1)))
    state = stage.step(0, A="push(t1)")["A"].state
    assert (state["at(h1)"], state["at(t1)"]) == ("(2,1)", "(2,1)")
    assert stage.reasons() == ["t1 is not coupled"]


@pytest.mark.parametrize(
    ("actions", "reason"),
    [
        ("go(h1,right)", "h1 is coupled"),
        ("go(t1,right)", "t1 is coupled"),
        ("give(h1)", "h1 is coupled"),
        ("join(t1,h2)", "t1 is coupled already"),
        ("pull(t1)", "there is a wall"),
        ("part(h1)", "h1 cannot be coupled to others"),
        ("push(h1)", "h1 cannot be coupled to others"),
    ],
)
def test_what_a_coupled_pair_cannot_do(actions: str, reason: str) -> None:
    stage = Stage(scene(hand("A", "h1", 1, 1), hand("A", "h2", 2, 1), tug("A", "t1", 1, 1, holds="h1")))
    before = stage.state()
    assert before["holds(t1)"] == "h1"
    assert stage.step(0, A=actions)["A"].state == before
    assert stage.reasons() == [reason]


def test_who_drives_away_is_not_coupled() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 1), tug("A", "t1", 2, 1)))
    state = stage.step(0, A="go(h1,right) join(t1,h1)")["A"].state
    assert (state["holds(t1)"], state["at(h1)"], state["at(t1)"]) == ("none", "(3,1)", "(2,1)")
    assert stage.reasons() == ["t1 and h1 are 1.00 m apart"]


def test_nobody_is_pushed_into_an_occupied_cell() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 1), hand("A", "h2", 2, 2), tug("A", "t1", 2, 1, holds="h1")))
    state = stage.step(0, A="push(t1)")["A"].state
    assert (state["at(t1)"], state["at(h1)"]) == ("(2,1)", "(2,1)")
    state = stage.step(1, A="push(t1) go(h2,right)")["A"].state
    assert (state["at(t1)"], state["at(h1)"], state["at(h2)"]) == ("(2,2)", "(2,2)", "(3,2)")


@pytest.mark.parametrize("broken", ["tug", "hand"])
def test_who_is_broken_neither_couples_nor_is_coupled(broken: str) -> None:
    stage = Stage(scene(hand("A", "h1", 2, 1, broken=broken == "hand"), tug("A", "t1", 2, 1, broken=broken == "tug")))
    assert stage.step(0, A="join(t1,h1)")["A"].state["holds(t1)"] == "none"
    assert len(stage.reasons()) == 1


def test_a_broken_tug_neither_pushes_nor_lets_go() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 1), tug("A", "t1", 2, 1, holds="h1", broken=True)))
    before = stage.state()
    assert stage.step(0, A="push(t1)")["A"].state == before
    assert stage.step(1, A="part(t1)")["A"].state == before
    assert stage.reasons() == ["t1 is broken", "t1 is broken"]


def test_a_broken_hand_can_still_be_pushed() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 1, broken=True), tug("A", "t1", 2, 1, holds="h1")))
    assert stage.step(0, A="push(t1)")["A"].state["at(h1)"] == "(2,2)"


# ---------------------------------------------------------------- tools and work
def test_tools_are_changed() -> None:
    stage = Stage(scene(hand("A", "h1", 1, 1), hand("A", "h2", 1, 2, broken=True)))
    state = stage.step(0, A="fit(h1,3) fit(h2,2)")["A"].state
    assert (state["tool(h1)"], state["tool(h2)"]) == (3, 1)
    assert stage.step(1, A="fit(h1,big)")["A"].state["tool(h1)"] == 3
    assert stage.reasons() == ["h2 is broken", "tool of h1 cannot be big"]


def test_work_advances_the_object_and_the_mark_falls_off() -> None:
    stage = Stage(scene(hand("A", "h1", 3, 3), hand("A", "h2", 2, 3, tool=2), piece("A", 1, 3)))
    state = stage.step(0, A="work(h1,1)")["A"].state
    assert (state["state(1)"], state["hot(1)"]) == (1, 1)
    state = stage.step(1, A="shift")["A"].state
    assert (state["line(1)"], state["hot(1)"]) == (2, 0)
    state = stage.step(2, A="work(h2,1)")["A"].state
    assert (state["state(1)"], state["hot(1)"]) == (2, 0)


def test_a_marked_object_is_not_worked_on() -> None:
    stage = Stage(scene(hand("A", "h1", 3, 3), piece("A", 1, 3)))
    stage.step(0, A="work(h1,1)")
    stage.world.truth.things["A.h1"].attributes["tool"] = 2
    state = stage.step(1, A="work(h1,1)")["A"].state
    assert (state["state(1)"], state["hot(1)"]) == (1, 0)
    assert stage.reasons() == ["1 is hot"]
    assert stage.step(2, A="work(h1,1)")["A"].state["state(1)"] == 2


@pytest.mark.parametrize(
    ("robot", "thing", "reason"),
    [
        (hand("A", "h1", 3, 2), piece("A", 1, 3), "h1 is not at the line"),
        (hand("A", "h1", 1, 3), piece("A", 1, 1), "h1 is not at the line"),
        (hand("A", "h1", 3, 3), piece("A", 1, 4), "h1 is at column 3 and 1 at position 4"),
        (hand("A", "h1", 3, 3, tool=2), piece("A", 1, 3), "tool 2 of h1 does not fit 1 with state 0"),
        (hand("A", "h1", 3, 3), piece("A", 1, 3, state=1), "tool 1 of h1 does not fit 1 with state 1"),
        (hand("A", "h1", 3, 3, broken=True), piece("A", 1, 3), "h1 is broken"),
        (hand("A", "h1", 3, 3), piece("A", 2, 3), "there is no object 1"),
        (tug("A", "h1", 3, 3), piece("A", 1, 3), "tool None of h1 does not fit 1 with state 0"),
    ],
)
def test_work_that_is_impossible(robot: object, thing: object, reason: str) -> None:
    stage = Stage(scene(robot, thing))  # type: ignore[arg-type]
    before = stage.state()
    assert stage.step(0, A="work(h1,1)")["A"].state == before
    assert stage.reasons() == [reason]


def test_who_is_pushed_away_has_not_worked() -> None:
    stage = Stage(scene(hand("A", "h1", 3, 3), tug("A", "t1", 3, 3, holds="h1"), piece("A", 1, 3)))
    state = stage.step(0, A="work(h1,1) pull(t1)")["A"].state
    assert (state["state(1)"], state["at(h1)"]) == (0, "(3,2)")


# ---------------------------------------------------------------- the line
def test_the_line_carries_everything_one_position_down_and_out() -> None:
    stage = Stage(scene(piece("A", 1, 1), piece("A", 2, 3), piece("A", 3, 9), piece("B", 1, 6), teams=2))
    state = stage.step(0, A="shift", B="")["A"].state
    assert [state[f"line({i})"] for i in (1, 2, 3)] == [0, 2, 8]
    assert stage.state("B")["line(1)"] == 6
    state = stage.step(1, A="shift", B="shift")["A"].state
    assert [state[f"line({i})"] for i in (1, 2, 3)] == [0, 1, 7]
    state = stage.step(2, A="shift shift")["A"].state
    assert [state[f"line({i})"] for i in (1, 2, 3)] == [0, 0, 6]
    assert stage.reasons() == ["shift has the line"]


def test_the_line_stands_while_somebody_works() -> None:
    stage = Stage(scene(hand("A", "h1", 3, 3), piece("A", 1, 3)))
    state = stage.step(0, A="shift work(h1,1)")["A"].state
    assert (state["line(1)"], state["state(1)"]) == (3, 1)
    assert stage.reasons() == ["work(h1,1) has the line"]
    assert stage.step(1, A="shift work(h1,1)")["A"].state["line(1)"] == 2


# ---------------------------------------------------------------- people
def test_repair_makes_whole_and_keeps_the_robot_from_anything_else() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 2, broken=True)))
    assert stage.step(0, A="go(h1,right) mend(h1)")["A"].state["at(h1)"] == "(2,2)"
    assert stage.reasons() == ["h1 is busy with mend(h1)"]
    assert stage.step(1, A="go(h1,right)")["A"].state["at(h1)"] == "(3,2)"


def test_an_inspection_tells_how_it_was_at_the_beginning() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 2, broken=True), hand("A", "h2", 3, 2)))
    assert stage.step(0, A="look(h1) look(h2) mend(h1)")["A"].findings == {"h1": "broken", "h2": "sound"}
    assert stage.step(1, A="look(h1) go(h1,left)")["A"].findings == {"h1": "sound"}
    assert stage.state()["at(h1)"] == "(1,2)"
    assert stage.step(2, A="look(h9)")["A"].findings == {}


def test_what_is_broken_is_not_sensed() -> None:
    healthy, broken = Stage(scene(hand("A", "h1", 2, 2))), Stage(scene(hand("A", "h1", 2, 2, broken=True)))
    assert healthy.state() == broken.state()
