"""Actions that take units of a robot's store, and chargers that fill it."""

from __future__ import annotations

import msgspec
import pytest

from bus.scene import Action, Entity
from tests.world.stage import ACTIONS, KINDS, Stage, hand, piece, scene, tug

FILL = Action("charge", ("robot",), attribute="fuel", gain=3, most=5)
DRAINING = {
    name: msgspec.structs.replace(ACTIONS[name], drains="fuel") for name in ("go", "fit", "work", "give", "join")
}
HAND = msgspec.structs.replace(KINDS["hand"], attributes=("tool", "fuel"))


def stage(*entities: Entity) -> Stage:
    world = scene(*entities)
    actions = {**ACTIONS, **DRAINING, "fill": FILL}
    return Stage(msgspec.structs.replace(world, kinds={**KINDS, "hand": HAND}, actions=actions))


def fuelled(name: str, x: int, y: int, fuel: int, broken: bool = False) -> Entity:
    robot = hand("A", name, x, y, broken=broken)
    return msgspec.structs.replace(robot, attributes={**robot.attributes, "fuel": fuel})


def test_each_action_takes_a_unit_and_with_none_left_nothing_comes_of_it() -> None:
    played = stage(fuelled("h1", 2, 3, 2), piece("A", 1, 3))
    assert played.step(0, A="go(h1,right)")["A"].state["fuel(h1)"] == 1
    assert played.step(1, A="work(h1,1)")["A"].state["fuel(h1)"] == 0
    before = played.state()
    assert played.step(2, A="go(h1,right)")["A"].state["at(h1)"] == before["at(h1)"]
    assert played.reasons() == ["h1 has no fuel left"]


@pytest.mark.parametrize(
    ("entities", "actions"),
    [
        ((fuelled("h1", 2, 1, 2, broken=True),), "go(h1,right)"),
        ((fuelled("h1", 2, 1, 2), fuelled("h2", 3, 1, 2)), "go(h1,right)"),
        ((fuelled("h1", 2, 1, 2),), "go(h1,down)"),
        ((fuelled("h1", 2, 1, 2),), "work(h1,1)"),
    ],
)
def test_what_has_no_effect_takes_nothing(entities: tuple[Entity, ...], actions: str) -> None:
    played = stage(*entities)
    assert played.step(0, A=actions)["A"].state["fuel(h1)"] == 2
    assert len(played.reasons()) == 1


def test_who_leaves_takes_its_store_along_less_a_unit() -> None:
    played = stage(fuelled("h1", 1, 1, 2))
    played.step(0, A="give(h1)")
    assert played.world.truth.things["A.h1"].attributes["fuel"] == 1


def test_robots_without_the_store_act_for_nothing() -> None:
    played = stage(fuelled("h1", 2, 1, 0), tug("A", "t1", 2, 1))
    state = played.step(0, A="join(t1,h1)")["A"].state
    assert (state["holds(t1)"], state["fuel(h1)"]) == ("h1", 0)


def test_a_charger_fills_whom_it_is_coupled_to_up_to_the_most() -> None:
    played = stage(fuelled("h1", 2, 1, 1), tug("A", "t1", 2, 1, holds="h1"))
    assert [played.step(k, A="fill(t1)")["A"].state["fuel(h1)"] for k in range(3)] == [4, 5, 5]


@pytest.mark.parametrize(
    ("charger", "actions", "reason"),
    [
        (tug("A", "t1", 2, 1), "fill(t1)", "t1 is not coupled"),
        (tug("A", "t1", 2, 1, holds="h1", broken=True), "fill(t1)", "t1 is broken"),
        (tug("A", "t1", 2, 1, holds="h1"), "fill(h1)", "h1 cannot be coupled to others"),
        (tug("A", "t1", 2, 1, holds="h1"), "fill(t9)", "there is no robot t9"),
        (tug("A", "t1", 2, 1, holds="h1"), "part(t1) fill(t1)", "t1 is busy with part(t1)"),
    ],
)
def test_what_no_charge_comes_of(charger: Entity, actions: str, reason: str) -> None:
    played = stage(fuelled("h1", 2, 1, 1), charger)
    assert played.step(0, A=actions)["A"].state["fuel(h1)"] == 1
    assert played.reasons() == [reason]


def test_only_whole_numbers_are_filled() -> None:
    played = stage(hand("A", "h1", 2, 1), tug("A", "t1", 2, 1, holds="h1"))
    played.step(0, A="fill(t1)")
    assert played.reasons() == ["h1 has no fuel"]
