"""A deadline that changes while teams are at work."""

from __future__ import annotations

from typing import Any

import pytest

from agents.autonomous.acting import Acting
from bus.messages import Order
from tests.agents.house import Home
from tests.agents.test_autonomous import BUSY, NOVEL, TO_KITCHEN, Make, kitchen, living, make

__all__ = ["make"]


def change(home: Home, units: int, team: str = "kitchen") -> None:
    home.world.node.request("coordinator", Order(team, deadline=units))


def reasons(home: Home, kind: str = "plan_dropped") -> list[Any]:
    return [event.data["reason"] for _, event in home.events if event.kind == kind]


def shown(home: Home) -> int:
    team = home.processes["kitchen"].mind
    if team is None:
        return -1
    mind = team.mind
    return int(mind.words.deadline(mind.static, mind.memory.state))


@pytest.mark.slow
def test_an_earlier_deadline_has_a_team_ask_for_help(make: Make) -> None:
    far = {"width": 9, "deposit": [8, 8, 0, 3]}
    home = make({"living": living(("novel_1", "novel", 4, 2), **TO_KITCHEN), "kitchen": kitchen(*BUSY[:3], **far)})
    home.until(lambda: home.now_s >= 2.0)
    change(home, 20)
    assert home.end().goal, home.story()
    assert shown(home) == 20
    assert reasons(home) == ["it has until 20 units"]
    kinds = home.kinds("kitchen")
    assert kinds.index("plan_dropped") < kinds.index("help_wanted") < kinds.index("helper_came")
    assert "deadline_missed" not in kinds


def test_a_later_deadline_and_none_any_more(make: Make) -> None:
    home = make({"kitchen": kitchen(*BUSY[:2], deadline=8)})
    home.until(lambda: "deadline_missed" in home.kinds())
    change(home, 60)
    home.until(lambda: shown(home) == 60)
    change(home, 0)
    change(home, 0)
    assert home.end().goal
    assert shown(home) == 0
    assert reasons(home) == ["it has until 60 units", "it has no deadline any more"]


def test_a_team_at_rest_that_was_late_is_in_time_after_all(make: Make) -> None:
    home = make({"kitchen": kitchen(NOVEL, deadline=3), "living": living(*[(n, "novel", x, y) for n, _, x, y in BUSY])})
    home.until(lambda: "team_finished" in home.kinds("kitchen"))
    change(home, 100)
    assert home.end().goal
    assert home.kinds("kitchen").count("team_finished") == 2


@pytest.mark.slow
@pytest.mark.parametrize("name", ["coordinator", "kitchen"])
def test_news_is_taken_in_once_whoever_dies_of_it(make: Make, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    taken: list[str] = []
    ordered = Acting.ordered

    def counted(self: Acting, order: Order) -> None:
        ordered(self, order)
        self.mind.node.journal.afterwards(lambda: taken.append(order.added[0]))

    monkeypatch.setattr(Acting, "ordered", counted)
    home = make({"kitchen": kitchen(NOVEL), "living": living(*[(n, "novel", x, y) for n, _, x, y in BUSY])})
    home.until(lambda: "plan_adopted" in home.kinds("living"))
    for after in range(8):
        lives = home.processes[name].lives
        home.processes[name].left = after
        home.world.node.request("coordinator", Order("kitchen", added=(f"after_{after}",)))
        home.until(lambda after=after, lives=lives: f"after_{after}" in taken and home.processes[name].lives > lives)
    assert home.end().goal
    assert taken == [f"after_{after}" for after in range(8)]


@pytest.mark.parametrize("name", ["coordinator", "kitchen"])
def test_the_news_survives_the_death_of_who_brings_and_who_hears_it(make: Make, name: str) -> None:
    home = make({"kitchen": kitchen(*BUSY[:2])})
    home.until(lambda: home.now_s >= 2.0)
    process = home.processes[name]
    for after in range(1, 6):
        process.left = after
        change(home, 50 + after)
        home.until(lambda after=after: shown(home) == 50 + after)
    assert home.end().goal
    assert process.lives > 2
    assert reasons(home)[-1] == "it has until 55 units"
