"""Robots on the floor: cell to cell, one behind the other, into walls and into one another."""

from __future__ import annotations

import itertools
from math import dist

import pytest

from tests.world.stage import Stage, hand, scene, tug
from world.motion import Motion


@pytest.mark.parametrize(
    ("direction", "cell"), [("up", "(3,3)"), ("down", "(3,1)"), ("left", "(2,2)"), ("right", "(4,2)")]
)
def test_a_robot_drives_one_cell(direction: str, cell: str) -> None:
    stage = Stage(scene(tug("A", "t1", 3, 2)))
    assert stage.step(0, A=f"go(t1,{direction})")["A"].state["at(t1)"] == cell
    assert stage.reasons() == []


def test_it_comes_to_rest_at_the_centre_well_before_the_period_ends() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 2), tug("A", "t1", 4, 1)))
    floor, there = stage.world.truth.floor, {"A.h1": (3.0, 2.0), "A.t1": (4.0, 2.0)}
    late: list[float] = []
    inner = floor.step

    def watched(times: int) -> None:
        for _ in range(times):
            inner(1)
            late.extend(dist(floor.where(name), goal) for name, goal in there.items() if window_s() > 0.85 * 2.0)

    def window_s() -> float:
        return stage.world.truth.tick * 0.02

    floor.step = watched  # type: ignore[method-assign]
    stage.step(0, A="go(h1,right) go(t1,up)")
    assert late
    assert max(late) < 0.001
    assert {name: floor.where(name) for name in there} == there
    assert {floor.velocity(name) for name in there} == {(0.0, 0.0)}


def test_time_goes_by_in_periods() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 2)))
    stage.step(0, A="go(h1,right)")
    stage.step(1, A="")
    assert stage.now_s == pytest.approx(4.0)
    assert stage.world.now_s == pytest.approx(4.0)


def test_following_into_a_cell_that_is_left() -> None:
    stage = Stage(scene(*(hand("A", f"h{i}", i, 2) for i in range(1, 5))))
    nearest: list[float] = []
    floor, inner = stage.world.truth.floor, stage.world.truth.floor.step

    def watched(times: int) -> None:
        for _ in range(times):
            inner(1)
            row = [floor.where(f"A.h{i}") for i in range(1, 5)]
            nearest.append(min(dist(a, b) for a, b in itertools.pairwise(row)))

    floor.step = watched  # type: ignore[method-assign]
    state = stage.step(0, A=" ".join(f"go(h{i},right)" for i in range(1, 5)))["A"].state
    assert [state[f"at(h{i})"] for i in range(1, 5)] == ["(2,2)", "(3,2)", "(4,2)", "(5,2)"]
    assert min(nearest) > 0.99


def test_who_cannot_leave_keeps_its_cell_and_all_behind_it_stay_too() -> None:
    stage = Stage(scene(hand("A", "h1", 3, 2), hand("A", "h2", 4, 2), hand("A", "h3", 5, 2)))
    state = stage.step(0, A="go(h1,right) go(h2,right) go(h3,right)")["A"].state
    assert [state[f"at(h{i})"] for i in (1, 2, 3)] == ["(3,2)", "(4,2)", "(5,2)"]
    assert stage.reasons() == ["h2 is in (4,2)", "h3 is in (5,2)", "there is a wall"]


def test_a_broken_robot_stands_in_the_way() -> None:
    stage = Stage(scene(hand("A", "h1", 1, 2), hand("A", "h2", 2, 2, broken=True)))
    state = stage.step(0, A="go(h1,right) go(h2,right)")["A"].state
    assert (state["at(h1)"], state["at(h2)"]) == ("(1,2)", "(2,2)")
    assert stage.reasons() == ["h2 is in (2,2)", "h2 is broken"]


def test_two_do_not_exchange_cells_nor_share_one() -> None:
    stage = Stage(scene(hand("A", "h1", 1, 2), hand("A", "h2", 2, 2), hand("A", "h3", 4, 2)))
    state = stage.step(0, A="go(h1,right) go(h2,left)")["A"].state
    assert (state["at(h1)"], state["at(h2)"]) == ("(1,2)", "(2,2)")
    state = stage.step(1, A="go(h2,right) go(h3,left)")["A"].state
    assert (state["at(h2)"], state["at(h3)"]) == ("(2,2)", "(4,2)")
    assert len(stage.reasons()) == 4


def test_round_a_corner_and_in_a_circle() -> None:
    stage = Stage(scene(hand("A", "h1", 1, 1), hand("A", "h2", 2, 1), hand("A", "h3", 2, 2), hand("A", "h4", 1, 2)))
    state = stage.step(0, A="go(h1,right) go(h2,up) go(h3,left) go(h4,down)")["A"].state
    assert [state[f"at(h{i})"] for i in (1, 2, 3, 4)] == ["(2,1)", "(2,2)", "(1,2)", "(1,1)"]


def test_robots_of_different_layers_pass_through_one_another() -> None:
    stage = Stage(scene(hand("A", "h1", 2, 2), tug("A", "t1", 3, 2)))
    state = stage.step(0, A="go(h1,right) go(t1,left)")["A"].state
    assert (state["at(h1)"], state["at(t1)"]) == ("(3,2)", "(2,2)")
    assert stage.step(1, A="go(t1,right)")["A"].state["at(t1)"] == "(3,2)"


@pytest.mark.parametrize("direction", ["up", "down", "left", "right", "north"])
def test_there_are_walls(direction: str) -> None:
    one = scene(hand("A", "h1", 1, 1), hand("A", "h2", 5, 3))
    stage = Stage(one)
    robot = "h1" if direction in ("down", "left") else "h2"
    before = stage.state()
    assert stage.step(0, A=f"go({robot},{direction})")["A"].state == before
    assert stage.reasons() == ["north is no direction" if direction == "north" else "there is a wall"]


def test_who_is_run_into_stays_where_it_is_and_who_runs_stops() -> None:
    """Physics alone, as when something is in the way that a robot could not see."""
    stage = Stage(scene(hand("A", "h1", 1, 2), hand("A", "h2", 2, 2)))
    truth = stage.world.truth
    motion = Motion(truth)
    motion.hop(truth.things["A.h1"], truth.layout.cell("A", 2, 2))
    for tick in range(100):
        truth.tick = tick
        motion.run(tick)
        truth.floor.step(1)
    assert dist(truth.floor.where("A.h2"), truth.layout.cell("A", 2, 2)) < 0.02
    assert 0.6 < dist(truth.floor.where("A.h1"), truth.floor.where("A.h2")) < 0.7
    assert stage.state()["at(h1)"] == "(1,2)"


def test_a_robot_does_one_thing_at_a_time() -> None:
    stage = Stage(scene(hand("A", "h1", 1, 1)))
    state = stage.step(0, A="go(h1,right) go(h1,up) fit(h1,2)")["A"].state
    assert (state["at(h1)"], state["tool(h1)"]) == ("(2,1)", 1)
    assert stage.reasons() == ["h1 is busy with go(h1,right)"] * 2


@pytest.mark.parametrize(
    ("action", "reason"),
    [
        ("fly(h1)", "there is no such action"),
        ("go(h1)", "it takes 2 arguments"),
        ("go(h9,up)", "there is no robot h9"),
        ("go(1,up)", "there is no robot 1"),
        ("join(h1,h1)", "h1 cannot be coupled to that"),
    ],
)
def test_nonsense_has_no_effect(action: str, reason: str) -> None:
    stage = Stage(scene(hand("A", "h1", 1, 1)))
    before = stage.state()
    assert stage.step(0, A=action)["A"].state == before
    assert stage.reasons() == [reason]
