"""Helpers that break: promised, on their way out, while they help, on their way back. Nobody waits for ever."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.agents.house import Home
from tests.agents.test_autonomous_kills import quick, thoughts
from tests.agents.test_autonomous_recall import home

__all__ = ["home", "quick", "thoughts"]


def at_work(home: Home, team: str, purpose: str) -> Callable[[], bool]:
    """Is the team about to do such a step?"""

    def holds() -> bool:
        begun = home.processes[team].mind.mind.memory.begun
        return begun is not None and begun.purpose == purpose

    return holds


@pytest.mark.parametrize("purpose", ["door", "leave"])
def test_who_breaks_before_it_has_left_is_not_waited_for(home: Home, purpose: str) -> None:
    home.until(at_work(home, "kitchen", purpose))
    home.world.robots["kitchen.r2"].broken = True
    over = home.end()
    assert "living leaves rug as it is" in over.reason
    assert "robot_broken" in home.kinds("kitchen")
    assert "nobody_helps" in home.kinds("living")
    assert {home.processes[team].lives for team in ("living", "kitchen")} == {1}


@pytest.mark.slow
def test_a_guest_that_breaks_is_given_back_as_it_is(home: Home) -> None:
    home.until(lambda: "helper_came" in home.kinds())
    home.world.robots["kitchen.r2"].broken = True
    over = home.end()
    assert "living leaves rug as it is" in over.reason
    assert "robot_broken" in home.kinds("living")
    assert "helper_called" in home.kinds("kitchen")
    assert "robot_broken" in home.kinds("kitchen")
    assert {home.processes[team].lives for team in ("living", "kitchen")} == {1}


@pytest.mark.parametrize(("team", "purpose"), [("living", "door"), ("living", "leave"), ("kitchen", "home")])
def test_who_breaks_on_its_way_back_is_done_without(home: Home, team: str, purpose: str) -> None:
    home.until(lambda: "helper_came" in home.kinds())
    home.until(at_work(home, team, purpose))
    home.world.robots["kitchen.r2"].broken = True
    over = home.end()
    assert over.goal, over
    assert "robot_broken" in home.kinds(team)
    assert {home.processes[team].lives for team in ("living", "kitchen")} == {1}
