"""Robots on the floor of a room: they drive their ways exactly and in time, and stop before what is in the way."""

from __future__ import annotations

from itertools import pairwise
from math import dist

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.messages import Executed
from bus.scene import Solid, Stop
from tests.world.house import UNIT_S, House, cart, do, go, house, human, pot, room, where
from world.plane import away
from world.ways import Way, read

WARDROBE = Solid("wardrobe", ((3.0, 2.0), (4.2, 1.6), (4.4, 2.3), (3.2, 2.7)), tall=True)
CORNER_ROUND = ((2.5, 1.5), (4.26, 1.34), (4.55, 1.52), (4.69, 2.38), (4.5, 3.5))


def watched(stage: House, name: str, *calls: object) -> tuple[Executed, list[tuple[float, float]]]:
    """A step of team A, and where a body was at every tenth of a second."""
    command = stage.command("A", *calls)  # type: ignore[arg-type]
    stage.deliver(command)
    track = []
    while not any(m.re == command.id and isinstance(m.body, Executed) for _, m in stage.sent):
        stage.now_s += 0.1
        stage.world.advance(stage.now_s)
        track.append(where(stage, name))
    return stage.ended(command), track


def off_way(at: tuple[float, float], way: tuple[tuple[float, float], ...]) -> float:
    return min(away(at, a, b) for a, b in pairwise(way))


def test_a_way_is_driven_exactly_and_in_time() -> None:
    stage = House(house(cart("A", "r1", 2, 1), rooms=(room("A", WARDROBE),)))
    told, track = watched(stage, "A.r1", go("r1", *CORNER_ROUND, units=2))
    assert told.felt == {}
    assert told.state["at(r1)"] == "(4,3)"
    assert "pose(r1)" not in told.state
    assert where(stage, "A.r1") == (4.5, 3.5)
    assert stage.now_s == pytest.approx(2 * UNIT_S)
    assert told.state["clock"] == 2
    assert max(off_way(at, CORNER_ROUND) for at in track) < 0.005


@settings(max_examples=6, deadline=None)
@given(st.lists(st.tuples(st.integers(5, 75), st.integers(5, 75)), min_size=1, max_size=5))
def test_any_way_is_driven_to_its_end(corners: list[tuple[int, int]]) -> None:
    way = ((2.5, 2.5), *((x / 10, y / 10) for x, y in corners))
    stage = House(house(cart("A", "r1", 2, 2)))
    told, track = watched(stage, "A.r1", go("r1", *way, units=6))
    assert told.felt == {}
    assert where(stage, "A.r1") == pytest.approx(way[-1], abs=1e-9)
    assert max(off_way(at, way) for at in track) < 0.01


def test_speeds_and_corners_stay_within_what_is_possible() -> None:
    way = Way([[(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (2.9, 2.0)]], 5.0)
    places = [way.at(way.driven(way.seconds * k / 400))[0] for k in range(401)]
    dt_s = way.seconds / 400
    speeds = [dist(a, b) / dt_s for a, b in pairwise(places)]
    assert max(speeds) <= 2.0 + 1e-9
    assert max(abs(a - b) / dt_s for a, b in pairwise(speeds)) < 12.0
    assert places[0] == (0.0, 0.0)
    assert places[-1] == (2.9, 2.0)


@pytest.mark.parametrize("text", ["", "((1,2),(x,3))", "(1,2)", "((1,2)(3,4))", "((1,2),(3,4)", "((1,2),(3.5,4))"])
def test_what_is_no_way_is_none(text: str) -> None:
    assert read(text) == []
    stage = House(house(cart("A", "r1", 2, 2)))
    told = stage.act("A", do("go", "r1", 4, 4, way=text, units=1))
    assert told.state["at(r1)"] == "(2,2)"
    assert stage.reasons() == ["there is no way, or none that can be read"]


def test_a_way_begins_where_the_robot_stands_and_takes_whole_units() -> None:
    stage = House(house(cart("A", "r1", 2, 2)))
    assert stage.act("A", go("r1", (3.5, 2.5), (4.5, 2.5), units=1)).felt == {"r1": "blocked"}
    stage.act("A", go("r1", (2.5, 2.5), (4.5, 2.5), units=0))
    stage.act("A", go("r1", (2.5, 2.5), (4.5, 2.5), units=2**62))
    stage.act("A", go("r9", (2.5, 2.5), (4.5, 2.5), units=1))
    assert stage.reasons() == [
        "the way does not begin where r1 stands",
        "it is not said how many units the way takes",
        "it is not said how many units the way takes",
        "there is no robot r9",
    ]
    assert stage.now_s == pytest.approx(4 * UNIT_S)


# ---------------------------------------------------------------- what is in the way
def test_it_stops_before_an_unknown_thing() -> None:
    stage = House(house(cart("A", "r1", 0, 2), pot("A", "ball", 4, 2)))
    told = stage.act("A", go("r1", (0.5, 2.5), (7.5, 2.5), units=3))
    assert told.felt == {"r1": "blocked"}
    x_m, y_m = where(stage, "A.r1")
    assert (told.state["pose(r1)"], told.state["at(r1)"]) == (f"({round(1000 * x_m)},2500)", f"({int(x_m)},2)")
    assert 0.37 < dist((x_m, y_m), where(stage, "A.ball")) < 0.5
    assert where(stage, "A.ball") == (4.5, 2.5)
    assert stage.now_s < 3 * UNIT_S
    # From there it goes round the thing.
    told = stage.act("A", go("r1", (x_m, y_m), (3.9, 3.3), (5.1, 3.3), (7.5, 2.5), units=3))
    assert (told.felt, told.state["at(r1)"]) == ({}, "(7,2)")


def test_what_lies_where_a_way_begins_or_ends_is_not_in_the_way_of_empty_hands() -> None:
    stage = House(house(cart("A", "r1", 2, 2), pot("A", "cup", 2, 2), pot("A", "ball", 4, 2)))
    assert stage.act("A", go("r1", (2.5, 2.5), (4.5, 2.5), units=1)).felt == {}
    assert stage.act("A", go("r1", (4.5, 2.5), (2.5, 2.5), units=1)).felt == {}
    stage.act("A", do("take", "r1"))
    assert stage.act("A", go("r1", (2.5, 2.5), (4.5, 2.5), units=1)).felt == {"r1": "blocked"}


def test_a_thing_brought_while_it_drives_stops_it() -> None:
    stage = House(house(cart("A", "r1", 0, 2)))
    command = stage.command("A", go("r1", (0.5, 2.5), (7.5, 2.5), units=3))
    stage.deliver(command)
    stage.now_s = 2.0
    stage.world.advance(2.0)
    assert stage.inject("bring", "A.ball", what="ball", x=5, y=2).accepted
    assert stage.ended(command).felt == {"r1": "blocked"}
    assert where(stage, "A.ball") == (5.5, 2.5)


def test_a_robot_that_stands_in_the_way_stops_it_at_once() -> None:
    stage = House(house(cart("A", "r1", 0, 2), cart("A", "r2", 4, 2)))
    assert stage.act("A", go("r1", (0.5, 2.5), (7.5, 2.5), units=3)).felt == {"r1": "blocked"}
    assert where(stage, "A.r2") == (4.5, 2.5)
    assert dist(where(stage, "A.r1"), (4.5, 2.5)) > 0.5


def test_robots_whose_ways_cross_let_one_another_pass() -> None:
    stage = House(house(cart("A", "r1", 0, 3), cart("A", "r2", 3, 0)))
    told = stage.act("A", go("r1", (0.5, 3.5), (6.5, 3.5), units=2), go("r2", (3.5, 0.5), (3.5, 6.5), units=2))
    assert told.felt == {}
    assert (told.state["at(r1)"], told.state["at(r2)"]) == ("(6,3)", "(3,6)")


def test_a_robot_goes_where_another_one_is_leaving() -> None:
    stage = House(house(cart("A", "r1", 1, 2), cart("A", "r2", 3, 2)))
    told = stage.act("A", go("r1", (1.5, 2.5), (3.5, 2.5), units=1), go("r2", (3.5, 2.5), (5.5, 2.5), units=1))
    assert told.felt == {}
    assert (told.state["at(r1)"], told.state["at(r2)"]) == ("(3,2)", "(5,2)")


def test_robots_that_come_straight_towards_one_another_stop_and_do_not_touch() -> None:
    stage = House(house(cart("A", "r1", 1, 2), cart("A", "r2", 5, 2)))
    told = stage.act("A", go("r1", (1.5, 2.5), (5.5, 2.5), units=2), go("r2", (5.5, 2.5), (1.5, 2.5), units=2))
    assert told.felt == {"r1": "blocked", "r2": "blocked"}
    assert dist(where(stage, "A.r1"), where(stage, "A.r2")) > 0.5


def test_furniture_that_nobody_told_it_of_holds_it_up() -> None:
    stage = House(house(cart("A", "r1", 2, 2), rooms=(room("A", WARDROBE),)))
    told = stage.act("A", go("r1", (2.5, 2.5), (6.5, 2.5), units=2))
    assert told.felt == {"r1": "blocked"}
    assert where(stage, "A.r1")[0] < 3.0


# ---------------------------------------------------------------- people
def test_people_are_not_pushed_and_waited_for() -> None:
    stage = House(house(cart("A", "r1", 0, 2), human("A", "anna", 4, 2)))
    told, track = watched(stage, "A.anna", go("r1", (0.5, 2.5), (7.5, 2.5), units=3))
    assert told.felt == {"r1": "blocked"}
    assert {*track} == {(4.5, 2.5)}
    assert UNIT_S < stage.now_s < 3 * UNIT_S
    assert dist(where(stage, "A.r1"), (4.5, 2.5)) > 0.5


def test_who_waits_for_a_person_goes_on_when_the_way_is_free() -> None:
    stage = House(house(cart("A", "r1", 0, 2), human("A", "anna", 4, 2, Stop(3.0, 4.5, 5.5))))
    told = stage.act("A", go("r1", (0.5, 2.5), (7.5, 2.5), units=3))
    assert (told.felt, told.state["at(r1)"], told.state["at(anna)"]) == ({}, "(7,2)", "(4,5)")
    assert stage.now_s >= 3 * UNIT_S


@pytest.mark.parametrize("start_s", [0.0, 0.4, 0.8, 1.2, 1.6, 2.0])
def test_people_and_robots_never_touch_whoever_comes_first(start_s: float) -> None:
    anna = human("A", "anna", 3, 0, Stop(start_s, 3.5, 5.5), Stop(start_s + 8, 3.5, 0.5), again_s=12.0)
    stage = House(house(cart("A", "r1", 0, 2), anna))
    command = stage.command("A", go("r1", (0.5, 2.5), (6.5, 2.5), units=2))
    stage.deliver(command)
    nearest = 9.0
    for _ in range(400):
        stage.now_s += 0.02
        stage.world.advance(stage.now_s)
        nearest = min(nearest, dist(where(stage, "A.r1"), where(stage, "A.anna")))
        assert where(stage, "A.anna")[0] == pytest.approx(3.5, abs=1e-9)
    assert nearest > 0.5
    assert stage.ended(command).state["at(r1)"] == "(6,2)"


def test_a_walk_begins_again_and_waits_for_who_is_in_front() -> None:
    anna = human("A", "anna", 1, 1, Stop(1.0, 5.5, 1.5), Stop(20.0, 1.5, 1.5), again_s=40.0)
    stage = House(house(anna, cart("A", "r1", 7, 7)))
    stage.advance(6.0)
    assert where(stage, "A.anna") == (5.5, 1.5)
    stage.advance(19.0)
    assert where(stage, "A.anna") == (1.5, 1.5)
    assert stage.inject("move", "A.r1", x=3, y=1).accepted
    stage.advance(23.0)
    assert 0.5 < 3.5 - where(stage, "A.anna")[0] < 1.0
    assert stage.inject("move", "A.r1", x=7, y=7).accepted
    stage.advance(4.0)
    assert where(stage, "A.anna") == (5.5, 1.5)
