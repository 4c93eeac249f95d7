"""Deadlines that are changed while teams are at work, as the world takes and tells them."""

from __future__ import annotations

import msgspec
import pytest

from bus.messages import Ok, Order
from tests.world.house import House, house, pot
from tests.world.stage import Stage, scene


def test_a_deadline_is_changed_and_told_one_after_the_other() -> None:
    stage = House(house(pot("A", "1", 2, 2)))
    for units in (20, 30, 0):
        assert stage.inject("deadline", "A", units=units).accepted
    assert stage.bodies(Order, "coordinator") == [Order("A", deadline=20)]
    assert [e["text"] for e in stage.events("order")] == [
        "A has until 20 units of time from now on",
        "A has until 30 units of time from now on",
        "A has no deadline from now on",
    ]
    (first,) = [m.id for _, m in stage.sent if isinstance(m.body, Order)]
    stage.deliver(msgspec.structs.replace(stage.mail("coordinator", Ok()), re=first))
    assert stage.bodies(Order, "coordinator")[-1] == Order("A", deadline=30)


@pytest.mark.parametrize(
    ("target", "units", "reason"),
    [
        ("A", 2, "3 units of time have passed already"),
        ("A", -1, "a deadline is a whole number of units of time, or 0 for none; not -1"),
        ("A", "soon", "a deadline is a whole number of units of time, or 0 for none; not soon"),
        ("Z", 9, "there is no team Z that keeps deadlines"),
    ],
)
def test_a_deadline_that_makes_no_sense_is_refused(target: str, units: int | str, reason: str) -> None:
    stage = House(house(pot("A", "1", 2, 2)))
    stage.advance(7.0)
    assert stage.inject("deadline", target, units=units).reason == reason
    assert "keeps deadlines" in Stage(scene()).inject("deadline", "A", units=9).reason
