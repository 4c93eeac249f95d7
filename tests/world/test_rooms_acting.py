"""What robots take hold of, what they see, and how they go from room to room."""

from __future__ import annotations

import pytest

from bus.messages import Execute, Observe, Observed
from bus.scene import Solid
from tests.world.house import UNIT_S, House, cart, do, go, house, human, pot, room

BED = Solid("bed", ((3.0, 3.0), (5.0, 3.0), (5.0, 5.0), (3.0, 5.0)))
WARDROBE = Solid("wardrobe", BED.corners, tall=True)
TWO = (room("A", room_b=(3, 4, 7, 7)), room("B", room_a=(3, 4, 0, 0), room_c=(0, 0, 0, 0)))


# ---------------------------------------------------------------- grips
def test_what_is_taken_goes_along_and_stays_where_it_is_dropped() -> None:
    stage = House(house(cart("A", "r1", 2, 2), pot("A", "cup", 2, 2)))
    told = stage.act("A", do("take", "r1", what="grip(cup,1)"))
    assert (told.state["holds(r1)"], told.state["raised(cup)"], told.state["takes"]) == ("grip(cup,1)", 0, 1)
    assert stage.now_s == pytest.approx(UNIT_S)
    told = stage.act("A", go("r1", (2.5, 2.5), (5.5, 6.5), units=2))
    assert told.state["at(cup)"] == "(5,6)"
    assert stage.act("A", do("drop", "r1")).state["holds(r1)"] == "none"
    told = stage.act("A", go("r1", (5.5, 6.5), (1.5, 6.5), units=2))
    assert (told.state["at(r1)"], told.state["at(cup)"]) == ("(1,6)", "(5,6)")
    assert not stage.reasons()


def test_who_grasps_into_the_air_feels_it() -> None:
    stage = House(house(cart("A", "r1", 2, 2), cart("A", "r2", 5, 5), pot("A", "cup", 3, 2)))
    assert stage.act("A", do("take", "r1")).felt == {"r1": "nothing_there"}
    assert stage.act("A", do("take", "r1", what="grip(cup,1)")).felt == {"r1": "nothing_there"}
    stage.inject("take", "A.cup")
    stage.act("A", go("r1", (2.5, 2.5), (3.5, 2.5), units=1))
    told = stage.act("A", do("take", "r1", what="grip(cup,1)"))
    assert (told.felt, told.state["holds(r1)"], told.state["takes"]) == ({"r1": "nothing_there"}, "none", 0)
    assert "at(cup)" not in told.state


def test_short_arms_take_only_what_is_raised() -> None:
    low = cart("A", "r1", 2, 2)
    low.attributes["low"] = 1
    stage = House(house(low, pot("A", "cup", 2, 2)))
    assert stage.act("A", do("take", "r1")).felt == {}
    stage.act("A", do("drop", "r1"))
    assert stage.act("A", do("take", "r1")).felt == {"r1": "nothing_there"}
    assert stage.reasons() == ["r1 has low, and cup is not raised"]


def test_that_a_thing_is_heavy_shows_when_somebody_tries() -> None:
    stage = House(house(cart("A", "r1", 2, 2), cart("A", "r2", 3, 2), pot("A", "pan", 2, 2, "(3,2)", known=False)))
    assert "end(pan)" not in stage.state()
    told = stage.act("A", do("take", "r1", what="grip(pan,1)"))
    assert (told.felt, told.state["holds(r1)"], told.state["end(pan)"]) == ({"r1": "too_heavy"}, "none", "(3,2)")
    told = stage.act("A", do("take", "r1", what="grip(pan,1)"), do("take", "r2", what="grip(pan,2)"))
    assert (told.felt, told.state["holds(r2)"]) == ({}, "grip(pan,2)")
    assert stage.act("A", do("take", "r2")).felt == {}
    assert stage.reasons()[-1] == "r2 holds something"


def test_an_end_that_is_held_is_not_there_for_others() -> None:
    stage = House(house(cart("A", "r1", 2, 2), cart("A", "r2", 5, 2), pot("A", "cup", 2, 2)))
    stage.act("A", do("take", "r1"))
    stage.inject("move", "A.r2", x=2, y=3)
    stage.world.truth.floor.put("A.r2", (2.9, 2.9))
    assert stage.act("A", do("take", "r2")).felt == {"r2": "nothing_there"}
    assert stage.reasons() == ["that end of cup is taken"]


def test_a_broken_robot_does_nothing_and_feels_nothing() -> None:
    stage = House(house(cart("A", "r1", 2, 2, broken=True), cart("A", "r2", 5, 2), pot("A", "cup", 2, 2)))
    for call in (do("take", "r1"), do("drop", "r1"), go("r1", (2.5, 2.5), (4.5, 2.5), units=2)):
        told = stage.act("A", call)
        assert (told.felt, told.state["at(r1)"], told.state["holds(r1)"]) == ({}, "(2,2)", "none")
    command = stage.command("A", go("r2", (5.5, 2.5), (5.5, 7.5), units=3))
    stage.deliver(command)
    stage.now_s += 4.0
    stage.world.advance(stage.now_s)
    assert stage.inject("break", "A.r2").accepted
    before_s = stage.now_s - 4.0
    told = stage.ended(command)
    assert (told.felt, stage.now_s) == ({}, pytest.approx(before_s + 3 * UNIT_S))
    assert "(5,2)" < str(told.state["at(r2)"]) < "(5,7)"


# ---------------------------------------------------------------- sight
def test_tall_furniture_hides_and_low_does_not() -> None:
    bodies = cart("A", "r1", 4, 1), pot("A", "cup", 4, 6), human("A", "anna", 1, 3)
    assert House(house(*bodies, rooms=(room("A", BED),))).state()["at(cup)"] == "(4,6)"
    stage = House(house(*bodies, rooms=(room("A", WARDROBE),)))
    state = stage.state()
    assert "at(cup)" not in state
    assert "raised(cup)" not in state
    assert state["at(anna)"] == "(1,3)"
    told = stage.act("A", go("r1", (4.5, 1.5), (6.5, 3.5), (6.5, 6.5), units=2))
    assert told.state["at(cup)"] == "(4,6)"
    assert "at(anna)" not in told.state


def test_a_heavy_thing_is_seen_by_either_end() -> None:
    stage = House(house(cart("A", "r1", 4, 1), pot("A", "pan", 4, 6, "(5,6)"), rooms=(room("A", WARDROBE),)))
    assert "at(pan)" not in stage.state()
    stage.world.truth.floor.put("A.r1", (6.6, 2.0))
    assert (stage.state()["at(pan)"], stage.state()["end(pan)"]) == ("(4,6)", "(5,6)")


def test_rooms_see_their_own_alone_and_the_clock_counts_waiting() -> None:
    stage = House(house(cart("A", "r1", 1, 1), pot("A", "cup", 2, 2), cart("B", "r2", 1, 1), rooms=TWO))
    assert stage.state("B") == {
        "here": "room_b", "takes": 0, "clock": 0, "at(r2)": "(1,1)", "low(r2)": 0, "holds(r2)": "none"
    }  # fmt: skip
    stage.advance(4.0)
    assert stage.state("A")["clock"] == 2
    told = stage.act("A")
    assert told.state["clock"] == 3


def test_exact_poses_are_told_of_what_is_not_in_the_middle_of_a_cell() -> None:
    stage = House(house(cart("A", "r1", 1, 1), human("A", "anna", 6, 6)))
    stage.world.truth.floor.put("A.r1", (2.345, 6.789))
    assert (stage.state()["at(r1)"], stage.state()["pose(r1)"]) == ("(2,6)", "(2345,6789)")
    assert "pose(anna)" not in stage.state()


# ---------------------------------------------------------------- windows
def test_every_team_has_windows_of_its_own() -> None:
    stage = House(house(cart("A", "r1", 1, 1), cart("B", "r1", 1, 1), pot("B", "cup", 1, 1), rooms=TWO))
    slow = stage.command("A", go("r1", (1.5, 1.5), (7.5, 7.5), units=4))
    stage.deliver(slow)
    assert stage.act("B", do("take", "r1")).state["holds(r1)"] == "grip(cup,1)"
    assert stage.now_s == pytest.approx(UNIT_S)
    assert stage.act("B", go("r1", (1.5, 1.5), (4.5, 1.5), units=1)).felt == {}
    assert stage.ask("A", Observe("A"), Observed) is None
    assert stage.ended(slow).state["at(r1)"] == "(7,7)"
    assert stage.now_s == pytest.approx(4 * UNIT_S)
    assert stage.bodies(Observed, "A")[0].state["at(r1)"] == "(7,7)"
    assert [(e["team"], e["step"]) for e in stage.events("step_ended")] == [("B", 0), ("B", 1), ("A", 0)]
    assert stage.world.next_s() is None


def test_a_team_has_one_step_at_a_time_and_each_once() -> None:
    stage = House(house(cart("A", "r1", 1, 1)))
    first, second = stage.command("A", go("r1", (1.5, 1.5), (3.5, 1.5), units=1)), stage.command("A")
    stage.deliver(first, second, first)
    stage.ended(second)
    stage.deliver(first)
    assert [(e["step"], e["command"]) for e in stage.events("step_ended")] == [(0, first.id), (1, second.id)]
    assert stage.now_s == pytest.approx(2 * UNIT_S)
    stage.deliver(stage.mail("A", Execute("B", 0)))
    assert stage.node.post.inbox.refused == {"not_yours": 1}


# ---------------------------------------------------------------- doors
def test_a_helper_goes_to_the_other_room_and_back() -> None:
    stage = House(house(cart("A", "r1", 3, 7), cart("B", "r2", 3, 0), rooms=TWO))
    told = stage.act("A", do("out", "r1", "room_b"))
    assert "at(r1)" not in told.state
    assert stage.world.truth.things["A.r1"].place == "bench"
    told = stage.act("B", do("in", "r1", robot="A.r1"))
    assert "at(r1)" not in told.state
    told = stage.act("B", do("in", "r1", robot="A.r1"))
    assert (told.state["at(r1)"], told.state["holds(r1)"]) == ("(4,0)", "none")
    assert stage.now_s == pytest.approx(3 * UNIT_S)
    told = stage.act("B", go("r1", (4.5, 0.5), (4.5, 3.5), units=1))
    assert told.state["at(r1)"] == "(4,3)"
    stage.act("B", do("out", "r1", "room_a"))
    told = stage.act("B", go("r1", (4.5, 3.5), (4.5, 0.5), units=1))
    assert stage.act("B", do("out", "r1", "room_a")).state.keys() == stage.state("B").keys()
    stage.act("A")
    told = stage.act("A", do("in", "r1", robot="A.r1"))
    assert told.state["at(r1)"] == "(3,7)"
    assert stage.reasons() == ["r1 is not at the door to room_a"]
    assert stage.waits() == ["B waits for A.r1, which is on its way"]
    homes = [event["robots"]["A.r1"] for event in stage.events("membership")]
    assert [place for place, _ in homes if place != "bench"] == ["A", *["B"] * 4, "A"]


def test_who_may_not_leave_or_come() -> None:
    stage = House(house(cart("A", "r1", 3, 7), pot("A", "cup", 3, 7), cart("B", "r1", 0, 0), rooms=TWO))
    stage.act("A", do("take", "r1"))
    stage.act("A", do("out", "r1", "room_b"))
    stage.act("A", do("drop", "r1"))
    stage.act("A", do("out", "r1", "room_c"))
    stage.act("A", do("out", "r1", "room_b"))
    stage.act("B", do("out", "r1", "room_c"))
    stage.act("B", do("in", "r1", robot="A.r1"))
    stage.act("B", do("in", "r9", robot="B.r1"))
    stage.act("B", do("in", "at(r9),", robot="A.r1"))
    assert stage.reasons() == [
        "r1 holds something",
        "no door leads to room_c",
        "no door leads to room_c",
        "there is a r1 already",
        "B.r1 is not on its way",
        "a robot cannot be called at(r9),",
    ]


def test_a_door_where_somebody_stands_is_blocked() -> None:
    stage = House(house(cart("A", "r1", 3, 7), human("B", "anna", 3, 0), human("B", "ben", 4, 0), rooms=TWO))
    stage.act("A", do("out", "r1", "room_b"))
    stage.act("A")
    for _ in range(3):
        assert stage.act("B", do("in", "r1", robot="A.r1")).felt == {"r1": "blocked"}
    assert stage.waits() == ["A.r1 waits at the door for B: somebody stands there"]
    assert not stage.reasons()
    assert stage.inject("move", "B.ben", x=6, y=6).accepted
    assert stage.act("B", do("in", "r1", robot="A.r1")).state["at(r1)"] == "(4,0)"


# ---------------------------------------------------------------- people who bring, take and move
def test_people_bring_take_and_move_what_is_in_a_room() -> None:
    bodies = cart("A", "r1", 2, 2), pot("A", "cup", 2, 2), human("A", "anna", 7, 0)
    stage = House(house(*bodies, rooms=(room("A", BED),)))
    stage.act("A", do("take", "r1"))
    assert stage.inject("move", "A.cup", x=6, y=6).accepted
    assert (stage.state()["holds(r1)"], stage.state()["at(cup)"]) == ("none", "(6,6)")
    assert stage.inject("bring", "A.ball", what="ball", x=0, y=0).accepted
    assert stage.state()["at(ball)"] == "(0,0)"
    assert stage.inject("take", "A.cup").accepted
    assert "at(cup)" not in stage.state()
    assert stage.events("membership")[-1]["objects"].keys() == {"A.cup"}
    stage.act("A")
    assert stage.events("membership")[-1]["objects"].keys() == {"A.ball"}  # people are no objects


@pytest.mark.parametrize(
    ("kind", "target", "args", "reason"),
    [
        ("bring", "A.ball", {"what": "ball", "x": 8, "y": 0}, "on a cell of its room"),
        ("bring", "A.cup", {"what": "ball", "x": 1, "y": 0}, "there is a cup already"),
        ("bring", "A.ball", {"what": "café", "x": 1, "y": 0}, "café is no kind of things"),
        ("bring", "A.ball", {"what": "ball", "x": 2, "y": 2}, "cup is there"),
        ("bring", "A.ball", {"what": "ball", "x": 4, "y": 4}, "bed stands there"),
        ("bring", "A.ball", {"what": "A Ball", "x": 1, "y": 1}, "is no kind of things"),
        ("bring", "C.ball", {"what": "ball", "x": 4, "y": 4}, "nothing can be brought"),
        ("take", "A.r1", {}, "there is no A.r1 in a room"),
        ("move", "A.r1", {"x": 6, "y": 6}, "anna is there"),
        ("move", "A.cup", {"to": 3}, "on a cell of its room"),
        ("move", "A.pan", {"x": 7, "y": 1}, "there is a wall"),
    ],
)
def test_what_people_cannot_do(kind: str, target: str, args: dict[str, int | str], reason: str) -> None:
    bodies = cart("A", "r1", 2, 2), pot("A", "cup", 2, 2), human("A", "anna", 6, 6), pot("A", "pan", 0, 6, "(1,6)")
    stage = House(house(*bodies, rooms=(room("A", BED),)))
    told = stage.inject(kind, target, **args)
    assert not told.accepted
    assert reason in told.reason
