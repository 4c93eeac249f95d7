"""Robots that come home from another room by themselves, when their own team calls them."""

from __future__ import annotations

from pathlib import Path

import pytest

from bus.scene import Entity, Solid
from tests.world.house import UNIT_S, House, cart, do, go, house, human, pot, room

ROOMS = (room("A", room_b=(3, 4, 7, 7)), room("B", room_a=(3, 4, 0, 0)))
DESK = Solid("desk", ((2.0, 1.5), (7.9, 1.5), (7.9, 2.5), (2.0, 2.5)))
CALL = do("home", "r1", robot="A.r1")


def visit(*entities: Entity, home: Path | None = None, b: tuple[Solid, ...] = ()) -> House:
    """r1 of A is in B's room, at the door."""
    rooms = ROOMS if not b else (ROOMS[0], room("B", *b, room_a=(3, 4, 0, 0)))
    stage = House(house(cart("A", "r1", 3, 7), *entities, rooms=rooms), home)
    stage.act("A", do("out", "r1", "room_b"))
    stage.act("B")
    assert stage.act("B", do("in", "r1", robot="A.r1")).state["at(r1)"] == "(3,0)"
    return stage


def come_home(stage: House, most: int = 12) -> int:
    """Call until it is there; how many times that took."""
    for times in range(1, most + 1):
        if "at(r1)" in stage.act("A", CALL).state:
            return times
    raise AssertionError(stage.reasons() + stage.waits())


def test_it_finds_its_way_to_the_door_and_comes_home() -> None:
    stage = visit(b=(DESK,))
    stage.act("B", go("r1", (3.5, 0.5), (1.0, 0.5), (1.0, 3.5), (6.5, 3.5), units=4))
    assert come_home(stage) == 4
    assert stage.state("A")["at(r1)"] == "(3,7)"
    assert not stage.reasons()
    homes = [event["robots"]["A.r1"][0] for event in stage.events("membership")]
    assert list(dict.fromkeys(homes[homes.index("B") :])) == ["B", "bench", "A"]


def test_only_its_own_team_can_call_it_and_nobody_commands_it_then() -> None:
    stage = visit(cart("B", "r2", 1, 1))
    stage.act("B", go("r1", (3.5, 0.5), (3.5, 6.5), units=3))
    stage.act("B", do("home", "r1", robot="A.r1"))
    stage.act("A", do("home", "r2", robot="B.r2"))
    assert stage.reasons() == ["A.r1 is no robot of B", "B.r2 is no robot of A"]
    assert stage.state("B")["at(r1)"] == "(3,6)"
    called = stage.command("A", CALL)
    stage.deliver(called)
    told = stage.act("B", go("r1", (3.5, 6.5), (6.5, 6.5), units=1), go("r2", (1.5, 1.5), (1.5, 4.5), units=1))
    assert stage.reasons()[2:] == ["r1 is called home by its own team"]
    assert "at(r1)" not in told.state
    assert told.state["at(r2)"] == "(1,4)"
    stage.ended(called)
    come_home(stage)
    stage.act("A", go("r1", (3.5, 7.5), (3.5, 4.5), units=1))
    assert stage.state("A")["at(r1)"] == "(3,4)"


def test_a_step_of_the_other_team_is_finished_first() -> None:
    stage = visit()
    driving = stage.command("B", go("r1", (3.5, 0.5), (3.5, 6.5), units=3))
    stage.deliver(driving)
    stage.act("A", CALL)
    assert stage.waits()[-1] == "A.r1 waits until go(r1,3,6) of B is over"
    assert "at(r1)" not in stage.ended(driving).state
    assert stage.world.truth.cell(stage.world.truth.things["A.r1"]) == (3, 6)
    come_home(stage)


def test_that_it_only_waits_is_known_after_the_world_died(tmp_path: Path) -> None:
    stage = visit(home=tmp_path)
    driving, called = stage.command("B", go("r1", (3.5, 0.5), (3.5, 6.5), units=4)), stage.command("A", CALL)
    stage.deliver(driving)
    stage.deliver(called)
    assert stage.inject("drop", "A", share=0.0).accepted, "this is journalled, and with it all steps under way"
    stage = stage.again()
    stage.ended(called)
    assert stage.reasons() == []
    assert stage.waits() == ["A.r1 waits until go(r1,3,6) of B is over"]


def test_what_it_holds_is_left_where_nothing_else_lies() -> None:
    stage = visit(pot("B", "cup", 3, 0), pot("B", "jug", 3, 3))
    stage.act("B", do("take", "r1", what="grip(cup,1)"))
    stage.act("B", go("r1", (3.5, 0.5), (3.5, 3.5), units=2))
    ox, oy = stage.world.truth.layout.origin("B")
    stage.world.truth.floor.put("B.jug", (ox + 3.5, oy + 3.9))  # two things in one cell: it may not let go here
    come_home(stage)
    state = {thing: stage.world.truth.cell(stage.world.truth.things[f"B.{thing}"]) for thing in ("cup", "jug")}
    assert state["jug"] == (3, 3)
    assert state["cup"] != (3, 3)
    assert stage.world.truth.things["A.r1"].partner == ""


def test_of_what_two_carry_the_guest_lets_go() -> None:
    stage = visit(cart("B", "r2", 4, 0), pot("B", "pan", 3, 0, "(4,0)"))
    stage.act("B", do("take", "r1", what="grip(pan,1)"), do("take", "r2", what="grip(pan,2)"))
    stage.act("B", go("r1", (3.5, 0.5), (3.5, 4.5), units=2), go("r2", (4.5, 0.5), (4.5, 4.5), units=2))
    come_home(stage)
    told = stage.act("B", go("r2", (4.5, 4.5), (4.5, 6.5), units=1))
    assert told.felt == {"r2": "too_heavy"}
    assert told.state["holds(r2)"] == "grip(pan,2)"


def test_who_finds_no_way_waits_until_there_is_one() -> None:
    stage = visit(human("B", "anna", 5, 5), human("B", "ben", 6, 6))
    stage.act("B", go("r1", (3.5, 0.5), (3.5, 6.5), units=3))
    assert stage.inject("move", "B.anna", x=3, y=0).accepted
    assert stage.inject("move", "B.ben", x=4, y=0).accepted
    for _ in range(3):
        assert stage.act("A", CALL).felt == {"r1": "blocked"}
    assert stage.waits() == ["A.r1 waits in the room of B: it has no way to the door"]
    assert stage.inject("move", "B.ben", x=6, y=6).accepted
    come_home(stage)


def test_who_has_not_come_in_yet_turns_round() -> None:
    stage = House(house(cart("A", "r1", 3, 7), rooms=ROOMS))
    stage.act("A", do("out", "r1", "room_b"))
    stage.act("A", CALL)
    assert "at(r1)" not in stage.act("B", do("in", "r1", robot="A.r1")).state
    assert stage.waits()[-1] == "A.r1 is called home by its own team"
    come_home(stage)
    assert stage.state("A")["at(r1)"] == "(3,7)"


def test_there_is_nothing_to_call_home() -> None:
    stage = House(house(cart("A", "r1", 3, 7), rooms=ROOMS))
    stage.act("A", CALL)
    stage.act("A", do("home", "r9", robot="A.r9"))
    assert stage.reasons() == ["A.r1 is at home", "there is no robot A.r9"]
    stage = visit()
    assert stage.inject("break", "A.r1").accepted
    for _ in range(3):
        stage.act("A", CALL)
    assert stage.waits() == ["A.r1 does not come: it is broken"]


@pytest.mark.parametrize("killed_s", [0.5, 3.5, 5.9])
def test_a_world_that_dies_brings_it_home_all_the_same(tmp_path: Path, killed_s: float) -> None:
    """B's steps save how far its way home has come."""
    stage = visit(cart("B", "r2", 6, 6), pot("B", "cup", 6, 6), home=tmp_path)
    stage.act("B", go("r1", (3.5, 0.5), (3.5, 6.5), units=3))
    begun_s = stage.now_s
    called, quick = stage.command("A", CALL), stage.command("B", do("take", "r2"))
    stage.deliver(called, quick)
    stage.advance(killed_s)
    stage = stage.again()
    stage.deliver(called, quick)
    stage.ended(called)
    assert stage.now_s == pytest.approx(begun_s + 3 * UNIT_S)
    assert stage.world.truth.cell(stage.world.truth.things["A.r1"])[1] == 0
    stage.deliver(called)
    assert len([e for e in stage.events("step_ended") if e["command"] == called.id]) == 1
    come_home(stage)
    assert not stage.reasons()
