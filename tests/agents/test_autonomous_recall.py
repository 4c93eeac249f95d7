"""A helper is with a team that dies for good, or is out of contact for too long: its own team calls it home, nobody
waits for ever, and who comes back is told in plain words."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from tests.agents.house import UNIT_S, Home
from tests.agents.test_autonomous import NOVEL, RUG, TO_KITCHEN, kitchen, living, room, weigh
from tests.agents.test_autonomous_kills import quick, thoughts

__all__ = ["quick", "thoughts"]


@pytest.fixture
def home(tmp_path: Path) -> Iterator[Home]:
    """The kitchen helps the living room to carry the rug."""
    made = Home(tmp_path, {"living": living(RUG, NOVEL, **TO_KITCHEN), "kitchen": kitchen(("mug_1", "mug", 2, 2))})
    weigh(made, "rug", (3, 2))
    yield made
    made.close()


def helper(home: Home) -> list[str]:
    return [kind for kind in home.kinds("kitchen") if kind.startswith("helper")]


def says(home: Home, kind: str) -> list[str]:
    return [str(event.data["text"]) for _, event in home.events if event.kind == kind]


@pytest.mark.parametrize("after", ["helper_left", "helper_came"])
def test_who_is_stopped_keeps_nobodys_robot(home: Home, after: str) -> None:
    home.until(lambda: after in home.kinds())
    home.contact("living", "stopped")
    over = home.end()
    assert (over.goal, over.reason) == (False, "living was stopped, and nobody knows how its room is")
    assert helper(home) == ["helper_left", "helper_called", "helper_returned"]
    assert home.world.robots["kitchen.r2"].team == "kitchen"
    assert home.world.things["mug_1"].at[0] == 5
    (text,) = says(home, "helper_called")
    assert "living has been out of contact for" in text


def test_who_is_out_of_contact_may_be_stopped_as_well(home: Home) -> None:
    home.until(lambda: "helper_came" in home.kinds())
    home.contact("living", "lost_contact")
    home.until(lambda: "helper_returned" in home.kinds())
    called_s = home.now_s
    home.until(lambda: home.now_s >= called_s + 60.0)
    assert home.over is None
    home.contact("living", "stopped")
    assert home.end().reason.startswith("living was stopped")


def test_what_the_guest_holds_is_let_go(home: Home) -> None:
    home.until(lambda: (r := home.world.robots["kitchen.r2"]).team == "living" and r.holds)
    assert home.world.robots["kitchen.r2"].team == "living"
    home.contact("living", "stopped")
    home.end()
    assert home.world.robots["kitchen.r2"].team == "kitchen"
    assert home.world.robots["kitchen.r2"].holds is None


def test_an_asker_that_comes_back_soon_keeps_its_helper(home: Home) -> None:
    home.until(lambda: "helper_came" in home.kinds())
    home.contact("living", "lost_contact")
    left_s = home.now_s
    home.until(lambda: home.now_s >= left_s + 2 * UNIT_S)
    home.contact("living", "back")
    assert home.end().goal, home.story()
    assert "helper_called" not in home.kinds()


@pytest.mark.slow
def test_the_time_until_a_robot_is_called_home_runs_from_the_loss_whoever_else_comes_and_goes(tmp_path: Path) -> None:
    rooms = {
        "living": living(RUG, NOVEL, **TO_KITCHEN),
        "kitchen": kitchen(("mug_1", "mug", 2, 2)),
        "bedroom": room("bedroom", [("r3", 0, 0)], []),
    }
    with closing(Home(tmp_path, rooms)) as home:
        weigh(home, "rug", (3, 2))
        home.until(lambda: "helper_came" in home.kinds())
        home.contact("living", "lost_contact")
        lost_s = home.now_s
        home.until(lambda: home.now_s >= lost_s + 3 * UNIT_S)
        home.contact("bedroom", "lost_contact")
        home.until(lambda: "helper_called" in home.kinds())
        assert home.now_s <= lost_s + 5 * UNIT_S


@pytest.mark.parametrize("later_s", [0.0, 1.0, 4.0, 7.0, 12.0])
def test_an_asker_that_comes_back_too_late_plans_anew_and_asks_again(home: Home, later_s: float) -> None:
    home.until(lambda: "helper_came" in home.kinds())
    home.contact("living", "lost_contact")
    home.until(lambda: "helper_called" in home.kinds())
    called_s = home.now_s
    home.until(lambda: home.now_s >= called_s + later_s)
    home.contact("living", "back")
    assert home.end().goal, home.story()
    assert says(home, "helper_gone") == ["living has lost r2, which its own team has called home, and plans anew"]
    assert "robot_broken" not in home.kinds()
    assert helper(home)[-3:] == ["helper_returned", "helper_left", "helper_returned"]


@pytest.mark.parametrize("team", ["kitchen", "living"])
def test_who_is_lost_while_the_robot_goes_through_the_door(home: Home, team: str) -> None:
    """Its own team's robot has left when the other one is known to be out of contact, and the guest likewise."""

    def leaving() -> bool:
        begun = home.processes[team].mind.mind.memory.begun
        return begun is not None and begun.purpose == "leave"

    other = "living" if team == "kitchen" else "kitchen"
    home.until(leaving)
    home.contact(other, "lost_contact")
    lost_s = home.now_s
    home.until(lambda: home.now_s >= lost_s + 40.0)
    assert home.processes[team].lives == 1
    home.contact(other, "back")
    assert home.end().goal, home.story()
    assert home.world.robots["kitchen.r2"].team == "kitchen"


@pytest.mark.slow
@pytest.mark.parametrize("after", range(1, 14, 3))
def test_a_helper_that_is_killed_while_it_calls_its_robot_home(home: Home, after: int) -> None:
    home.until(lambda: "helper_came" in home.kinds())
    home.contact("living", "lost_contact")
    home.processes["kitchen"].left = after
    home.until(lambda: "helper_returned" in home.kinds("kitchen"))
    assert home.processes["kitchen"].lives == 2
    home.contact("living", "back")
    assert home.end().goal, home.story()
    assert home.world.robots["kitchen.r2"].team == "kitchen"


def test_who_does_not_come_home_is_given_up(home: Home) -> None:
    home.until(lambda: "helper_came" in home.kinds())
    home.world.robots["kitchen.r2"].there_s = 1e9
    home.contact("living", "stopped")
    home.until(lambda: home.world.robots["kitchen.r2"].team == "bench")
    home.world.robots["kitchen.r2"].there_s = 1e9
    over = home.end()
    assert "gives up r2" in says(home, "robot_broken")[0]
    assert not over.goal


def test_a_helper_that_is_stopped_is_not_waited_for(home: Home) -> None:
    home.until(lambda: "helper_came" in home.kinds())
    home.contact("kitchen", "stopped")
    over = home.end()
    assert over.reason.startswith("kitchen was stopped")
    assert "helper_sent_back" in home.kinds("living")
    assert home.world.things["rug"].at[0] == 5


def test_help_of_who_was_stopped_is_not_hoped_for(home: Home) -> None:
    home.until(lambda: "plan_adopted" in home.kinds("kitchen"))
    home.contact("kitchen", "stopped")
    over = home.end()
    assert "nobody_helps" in home.kinds("living")
    assert "living leaves rug as it is" in over.reason
    assert home.world.things["novel_1"].at[0] == 5


def test_a_house_of_one_that_is_stopped_is_over(tmp_path: Path) -> None:
    home = Home(tmp_path, {"living": living(NOVEL)})
    home.until(lambda: "plan_adopted" in home.kinds())
    home.contact("living", "stopped")
    assert not home.end().goal
    home.close()
