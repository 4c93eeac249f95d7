"""In ``realtime`` a team goes on hearing while it thinks: what it has thought of a room that has changed is dropped."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from agents.autonomous.mind import Mind
from bus.messages import HelpSettled
from tests.agents.house import Home
from tests.agents.test_autonomous_kills import quick, thoughts
from tests.agents.test_autonomous_recall import home

__all__ = ["home", "quick", "thoughts"]


def test_a_plan_with_a_guest_that_was_called_home_meanwhile_is_not_followed(
    home: Home, monkeypatch: pytest.MonkeyPatch
) -> None:
    ready: list[Callable[[], None]] = []
    think = Mind.think

    def slowly(self: Mind, work: Callable[[], Any], then: Callable[[Any], None]) -> None:
        if self.team != "living" or "helper_gone" in home.kinds() or "helper_came" not in home.kinds():
            think(self, work, then)
        else:
            result = work()
            ready.append(lambda: then(result))

    monkeypatch.setattr(Mind, "think", slowly)
    home.until(lambda: ready)
    living = home.processes["living"].mind.mind
    assert living.memory.help.phase == "here"
    node = home.processes["kitchen"].node
    assert node is not None
    node.request("living", HelpSettled(living.memory.help.caller, living.memory.help.call, False))
    home.until(lambda: "helper_gone" in home.kinds())
    for deliver in ready:
        deliver()
    assert living.memory.course is None
    home.until(lambda: living.memory.course is not None)
    assert not any("r2" in action for step in living.memory.course.steps for action in step)
    assert home.processes["living"].lives == 1
