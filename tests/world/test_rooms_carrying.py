"""Heavy things: what one robot cannot move, and two can."""

from __future__ import annotations

from math import cos, dist, hypot, sin

import pytest

from tests.world.house import House, cart, do, go, house, pot, where


def test_one_robot_cannot_drag_a_heavy_thing_and_two_can() -> None:
    stage = House(house(cart("A", "r1", 2, 2), cart("A", "r2", 3, 2), pot("A", "chest", 2, 2, "(3,2)")))
    stage.act("A", do("take", "r1", what="grip(chest,1)"))
    for goal in ((2.5, 4.5), (0.5, 2.5), (4.5, 2.5)):
        assert stage.act("A", go("r1", (2.5, 2.5), goal, units=1)).felt["r1"] in ("too_heavy", "blocked")
        assert dist(where(stage, "A.chest"), (2.5, 2.5)) < 0.002
    told = stage.act("A", do("take", "r2", what="grip(chest,2)"))
    assert (told.state["holds(r1)"], told.state["holds(r2)"]) == ("grip(chest,1)", "grip(chest,2)")
    told = stage.act("A", go("r1", (2.5, 2.5), (2.5, 4.5), units=1), go("r2", (3.5, 2.5), (3.5, 4.5), units=1))
    assert told.felt == {}
    assert (told.state["at(chest)"], told.state["end(chest)"]) == ("(2,4)", "(3,4)")
    turned = [(2.5 + cos(k / 20), 4.5 + sin(k / 20)) for k in range(31)]
    told = stage.act(
        "A",
        go("r1", *[(2.5, 4.5)] * 32, units=2),
        go("r2", *turned, (2.5, 5.5), units=2),
    )
    assert told.felt == {}
    assert (told.state["at(chest)"], told.state["end(chest)"]) == ("(2,4)", "(2,5)")
    assert stage.world.truth.floor.end("A.chest", 2) == pytest.approx((2.5, 5.5))
    told = stage.act("A", do("drop", "r1"), do("drop", "r2"))
    assert (told.state["holds(r1)"], told.state["holds(r2)"]) == ("none", "none")


def test_two_that_do_not_drive_together_do_not_drive() -> None:
    bodies = cart("A", "r1", 2, 2), cart("A", "r2", 3, 2), pot("A", "chest", 2, 2, "(3,2)")
    stage = House(house(*bodies))
    stage.act("A", do("take", "r1"), do("take", "r2"))
    stage.act("A", go("r1", (2.5, 2.5), (2.5, 4.5), units=1), go("r2", (3.5, 2.5), (4.5, 3.5), units=1))
    stage.act("A", go("r1", (2.5, 2.5), (2.5, 4.5), units=1), go("r2", (3.5, 2.5), (3.5, 3), (3.5, 4.5), units=1))
    told = stage.act("A", go("r1", (2.5, 2.5), (2.5, 4.5), units=1))
    assert told.felt == {"r1": "too_heavy"}
    assert stage.reasons() == [
        *["the ways do not keep a metre apart"] * 2,
        *["the ways differ in their number of points"] * 2,
        "r1 cannot move what it holds",
    ]
    assert hypot(*(a - b for a, b in zip(where(stage, "A.chest"), (2.5, 2.5), strict=True))) < 0.002


def test_who_carries_with_a_robot_that_breaks_feels_the_weight() -> None:
    bodies = cart("A", "r1", 2, 2), cart("A", "r2", 3, 2), pot("A", "chest", 2, 2, "(3,2)")
    stage = House(house(*bodies))
    stage.act("A", do("take", "r1"), do("take", "r2"))
    ways = go("r1", (2.5, 2.5), (2.5, 5.5), units=2), go("r2", (3.5, 2.5), (3.5, 5.5), units=2)
    command = stage.command("A", *ways)
    stage.deliver(command)
    stage.now_s += 3.0
    stage.world.advance(stage.now_s)
    assert stage.inject("break", "A.r2").accepted
    told = stage.ended(command)
    assert told.felt == {"r1": "too_heavy"}
    assert told.state["holds(r1)"] == "grip(chest,1)"


def test_who_stays_where_it_is_with_a_heavy_thing_has_got_there() -> None:
    stage = House(house(cart("A", "r1", 2, 2), pot("A", "chest", 2, 2, "(3,2)")))
    stage.act("A", do("take", "r1"))
    assert stage.act("A", go("r1", (2.5, 2.5), (2.5, 2.5), units=1)).felt == {}


def test_who_was_carried_off_when_it_had_arrived_is_not_put_back() -> None:
    stage = House(house(cart("A", "r1", 0, 0), cart("A", "r2", 0, 7)))
    command = stage.command("A", go("r1", (0.5, 0.5), (1.5, 0.5), units=1), go("r2", (0.5, 7.5), (7.5, 7.5), units=4))
    stage.deliver(command)
    stage.now_s += 5.0
    stage.world.advance(stage.now_s)
    assert stage.inject("move", "A.r1", x=4, y=4).accepted
    assert stage.ended(command).state["at(r1)"] == "(4,4)"
