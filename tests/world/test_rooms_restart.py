"""A world of rooms that is killed: steps are over, go on as they were when the world was last saved, or never were."""

from __future__ import annotations

from math import dist
from pathlib import Path

import pytest

from bus.messages import Executed
from bus.scene import Fault, Scene, Stop
from tests.world.house import UNIT_S, House, cart, do, go, house, human, pot, room

ROOMS = (room("A", room_b=(3, 4, 7, 7)), room("B", room_a=(3, 4, 0, 0)))


def scene(*faults: Fault) -> Scene:
    return house(
        cart("A", "r1", 2, 2),
        cart("A", "r2", 3, 2),
        pot("A", "chest", 2, 2, "(3,2)"),
        human("A", "anna", 7, 0, Stop(2.0, 7.5, 6.5)),
        cart("B", "r3", 1, 1),
        pot("B", "cup", 1, 1),
        rooms=ROOMS,
        faults=faults,
    )


def bodies(stage: House) -> dict[str, tuple[float, float]]:
    return {name: stage.world.truth.floor.where(name) for name in stage.world.truth.things}


def test_it_comes_back_with_all_that_was_over(tmp_path: Path) -> None:
    stage = House(scene(), tmp_path)
    stage.act("A", do("take", "r1"), do("take", "r2"))
    stage.act("A", go("r1", (2.5, 2.5), (2.5, 4.5), units=1), go("r2", (3.5, 2.5), (3.5, 4.5), units=1))
    stage.act("B", do("take", "r3"))
    before, at_s, state = bodies(stage), stage.now_s, stage.state()
    stage = stage.again()
    assert (bodies(stage), stage.now_s, stage.state()) == (before, at_s, state)
    assert state["takes"] == 2
    told = stage.act("A", go("r1", (2.5, 4.5), (2.5, 2.5), units=1), go("r2", (3.5, 4.5), (3.5, 2.5), units=1))
    assert (told.felt, told.state["at(chest)"]) == ({}, "(2,2)")


@pytest.mark.parametrize("killed_s", [0.5, 3.0, 3.5, 5.9])
def test_a_step_is_carried_out_once_whenever_the_world_dies(tmp_path: Path, killed_s: float) -> None:
    """B's first step ends after 3 seconds, and saves how far A's drive of 6 has come by then."""
    stage = House(scene(), tmp_path)
    slow = stage.command("A", go("r1", (2.5, 2.5), (2.5, 4.5), (5.5, 4.5), units=2))
    quick = stage.command("B", do("take", "r3"))
    stage.deliver(slow, quick)
    stage.advance(killed_s)
    stage = stage.again()
    over = killed_s >= UNIT_S
    assert stage.now_s == pytest.approx(UNIT_S if over else 0.0)
    assert [e["team"] for e in stage.events("step_started")] == (["A"] if over else [])
    if over:
        x_m, y_m = stage.world.truth.floor.where("A.r1")
        assert 0.5 < dist((x_m, y_m), (2.5, 2.5)) < 5.0
    stage.deliver(slow, quick)
    told = stage.ended(slow)
    assert (told.felt, told.state["at(r1)"]) == ({}, "(5,4)")
    assert stage.now_s == pytest.approx(2 * UNIT_S)
    assert stage.ended(quick).state["holds(r3)"] == "grip(cup,1)"
    assert [e["command"] for e in stage.events("step_ended")] == ([slow.id] if over else [quick.id, slow.id])
    stage.deliver(slow, quick)
    assert len([body for body in stage.bodies(Executed) if body.team == "A"]) == 2  # told, and told again
    assert len(stage.events("step_started")) == (1 if over else 2)


def test_two_that_carry_go_on_carrying(tmp_path: Path) -> None:
    stage = House(scene(), tmp_path)
    stage.act("A", do("take", "r1"), do("take", "r2"))
    ways = go("r1", (2.5, 2.5), (2.5, 6.5), units=2), go("r2", (3.5, 2.5), (3.5, 6.5), units=2)
    carrying = stage.command("A", *ways)
    stage.deliver(carrying)
    stage.act("B", do("take", "r3"))
    stage = stage.again()
    stage.deliver(carrying)
    told = stage.ended(carrying)
    assert (told.felt, told.state["at(chest)"], told.state["end(chest)"]) == ({}, "(2,6)", "(3,6)")


def test_who_is_between_the_rooms_gets_there(tmp_path: Path) -> None:
    stage = House(scene(), tmp_path)
    stage.act("A", go("r1", (2.5, 2.5), (4.5, 7.5), units=2))
    stage.act("A", do("out", "r1", "room_b"))
    coming = stage.command("B", do("in", "r1", robot="A.r1"))
    stage = stage.again()
    stage.advance(UNIT_S)
    stage.deliver(coming)
    assert stage.ended(coming).state["at(r1)"] == "(3,0)"
    assert stage.again().state("B")["at(r1)"] == "(3,0)"


def test_a_walk_goes_on_where_it_was(tmp_path: Path) -> None:
    stage = House(scene(), tmp_path)
    stage.advance(4.0)
    stage.act("B")
    stage = stage.again()
    assert stage.world.truth.floor.where("A.anna") == pytest.approx((7.5, 5.5), abs=0.05)
    stage.advance(2.0)
    assert stage.world.truth.floor.where("A.anna") == (7.5, 6.5)


def test_faults_of_a_step_are_of_the_own_team_and_happen_once(tmp_path: Path) -> None:
    faults = (
        Fault("take", "B.cup", at_step=1),
        Fault("bring", "A.ball", on_action="A.take(r1)", args={"what": "ball", "x": 6, "y": 6}),
        Fault("move", "A.r2", at_s=1.0, args={"x": 5, "y": 5}),
    )
    stage = House(scene(*faults), tmp_path)
    for _ in range(2):
        stage.act("A")
    assert stage.state("B")["at(cup)"] == "(1,1)"
    assert stage.state("A")["at(r2)"] == "(5,5)"
    stage.act("B")
    stage.act("B")
    assert "at(cup)" not in stage.state("B")
    stage.act("A", do("take", "r1"))
    stage = stage.again()
    assert stage.state("A")["at(ball)"] == "(6,6)"
    stage.act("A")
    assert stage.events("fault_injected") == []


def test_a_run_of_several_lives_is_the_same_as_one(tmp_path: Path) -> None:
    def end(*kills: int) -> dict[str, tuple[float, float]]:
        stage = House(scene(), tmp_path / "-".join(map(str, (0, *kills))))
        steps = [
            (do("take", "r1"), do("take", "r2")),
            (go("r1", (2.5, 2.5), (2.5, 4.5), units=1), go("r2", (3.5, 2.5), (3.5, 4.5), units=1)),
            (do("drop", "r1"), do("drop", "r2")),
            (go("r1", (2.5, 4.5), (6.5, 1.5), units=2), go("r2", (3.5, 4.5), (3.5, 7.5), units=1)),
        ]
        for number, calls in enumerate(steps):
            stage.act("A", *calls)
            if number in kills:
                stage = stage.again()
        return bodies(stage)

    assert end() == end(1) == end(0, 2, 3)
