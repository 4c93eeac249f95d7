"""Teams that act for themselves, in a house without physics."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from bus.messages import Order
from tests.agents.house import Home, Thing

Make = Callable[..., Home]


@pytest.fixture
def make(tmp_path: Path) -> Iterator[Make]:
    made: list[Home] = []

    def start(teams: dict[str, Any], **house: Any) -> Home:
        made.append(Home(tmp_path / str(len(made)), teams, **house))
        return made[-1]

    yield start
    for home in made:
        home.close()


def room(name: str, robots: list[Any], things: list[Any], **more: Any) -> dict[str, Any]:
    """A room of six by four cells whose deposit is in the east, with a door in the south-west."""
    return {
        "room": name,
        "width": 6,
        "height": 4,
        "deposit": [5, 5, 0, 3],
        "robots": [
            {"name": n, "at": [x, y], **rest} for n, x, y, *extra in robots for rest in [extra[0] if extra else {}]
        ],
        "things": [{"name": n, "kind": kind, "at": [x, y]} for n, kind, x, y in things],
        **more,
    }


def living(*things: Any, robots: Any = (("r1", 0, 0),), **more: Any) -> dict[str, Any]:
    return room("living_room", list(robots), list(things), **more)


NOVEL = ("novel_1", "novel", 2, 2)


def test_a_room_is_tidied(make: Make) -> None:
    home = make({"living": living(NOVEL)})
    over = home.end()
    assert over.goal
    assert over.makespan == 4
    assert home.world.things["novel_1"].at[0] == 5
    assert home.kinds("living") == ["started", "plan_adopted", "final_look", "team_finished"]


def test_an_unknown_object_is_gone_round(make: Make) -> None:
    home = make({"living": living(("novel_1", "novel", 3, 0))})
    home.world.things["vase"] = Thing("living", "vase", "vase", (1, 0), seen=False)
    assert home.end().goal
    kinds = home.kinds("living")
    assert kinds.index("unknown_object") < kinds.index("new_way") < kinds.index("final_look")
    assert home.world.things["vase"].at[0] == 5


def test_what_is_taken_away_is_not_waited_for(make: Make) -> None:
    home = make({"living": living(NOVEL, ("comics_1", "comics", 3, 3))})
    home.world.before["living", "goto(r1,2,2)"] = lambda: _gone(home, "novel_1")
    assert home.end().goal
    assert "object_not_found" in home.kinds("living")


def _gone(home: Home, thing: str) -> None:
    del home.world.things[thing]


def test_a_person_in_the_way_is_waited_for(make: Make) -> None:
    home = make({"living": living(("novel_1", "novel", 3, 0), height=2, deposit=[5, 5, 0, 1])})
    home.world.persons |= {"anna": ("living", (2, 0), 20.0), "paul": ("living", (2, 1), 20.0)}
    assert home.end().goal
    kinds = home.kinds("living")
    assert kinds.index("person_in_way") < kinds.index("waited") < kinds.index("new_way")


RUG = ("rug", "cushion", 3, 1)
TO_KITCHEN = {"exchange": [{"to": "kitchen", "area": [0, 0, 3, 3]}]}
TO_LIVING = {"exchange": [{"to": "living_room", "area": [0, 0, 3, 3]}]}


def kitchen(*things: Any, robots: Any = (("r2", 1, 1),), **more: Any) -> dict[str, Any]:
    return room("kitchen", list(robots), list(things), **TO_LIVING, **more)


def weigh(home: Home, thing: str, end: tuple[int, int]) -> None:
    """It is heavy, and nobody knows."""
    home.world.things[thing].end, home.world.things[thing].felt = end, False


def test_two_robots_of_the_room_carry_what_is_heavy(make: Make) -> None:
    home = make({"living": living(RUG, robots=(("r1", 0, 0), ("r3", 1, 0)))})
    weigh(home, "rug", (3, 2))
    assert home.end().goal
    assert "heavy_object" in home.kinds("living")
    assert "help_wanted" not in home.kinds()


@pytest.mark.slow
def test_what_is_heavy_comes_last_and_with_help(make: Make) -> None:
    home = make({"living": living(RUG, NOVEL, **TO_KITCHEN), "kitchen": kitchen(("mug_1", "mug", 2, 2))})
    weigh(home, "rug", (3, 2))
    over = home.end()
    assert over.goal, over
    wanted = ["heavy_object", "help_wanted", "help_confirmed", "helper_came", "helper_sent_back", "team_finished"]
    found = [kind for kind in home.kinds("living") if kind in wanted]
    assert list(dict.fromkeys(found)) == wanted
    assert [k for k in home.kinds("kitchen") if k.startswith("helper")] == ["helper_left", "helper_returned"]
    assert home.world.robots["kitchen.r2"].team == "kitchen"


def test_without_anybody_to_help_the_rest_is_tidied(make: Make) -> None:
    home = make({"living": living(RUG, NOVEL)})
    weigh(home, "rug", (3, 2))
    over = home.end()
    assert not over.goal
    assert "rug" in over.reason
    assert home.world.things["novel_1"].at[0] == 5


@pytest.mark.slow
def test_two_teams_that_ask_each_other_help_each_other(make: Make) -> None:
    home = make({"living": living(RUG, **TO_KITCHEN), "kitchen": kitchen(("pot_1", "pot", 3, 1))})
    weigh(home, "rug", (3, 2))
    weigh(home, "pot_1", (3, 2))
    assert home.end().goal
    assert home.kinds("living").count("helper_left") == home.kinds("kitchen").count("helper_left") == 1
    assert home.world.robots["kitchen.r2"].team == "kitchen"
    assert home.world.robots["living.r1"].team == "living"


BUSY = [(f"mug_{n}", "mug", x, y) for n, (x, y) in enumerate([(1, 3), (2, 3), (3, 3), (3, 0)])]


@pytest.mark.slow
def test_who_finds_nobody_offers_help_and_is_helped_back(make: Make) -> None:
    """The kitchen's deadline leaves no time for others; with help it is done earlier."""
    teams = {"living": living(RUG, **TO_KITCHEN), "kitchen": kitchen(*BUSY, deadline=24)}
    home = make(teams)
    weigh(home, "rug", (3, 2))
    assert home.end().goal
    wanted = ["heavy_object", "help_wanted", "help_offered", "help_confirmed", "helper_left", "helper_returned"]
    found = [kind for kind in home.kinds("living") if kind in (*wanted, "helper_came")]
    assert list(dict.fromkeys(found)) == [*wanted, "helper_came"]
    assert "deadline_missed" not in home.kinds()


@pytest.mark.slow
def test_a_deadline_that_can_be_met_with_help_only(make: Make) -> None:
    far = {"width": 9, "deposit": [8, 8, 0, 3], "deadline": 20}
    teams = {"living": living(("novel_1", "novel", 4, 2), **TO_KITCHEN), "kitchen": kitchen(*BUSY[:3], **far)}
    home = make(teams)
    over = home.end()
    assert over.goal, home.story()
    assert "help_wanted" in home.kinds("kitchen")
    assert "helper_came" in home.kinds("kitchen")


def test_a_deadline_that_nobody_can_meet_is_missed_and_named(make: Make) -> None:
    home = make({"kitchen": kitchen(*BUSY, deadline=10)})
    over = home.end()
    assert not over.goal
    assert "kitchen missed its deadline" in over.reason
    assert all(thing.at[0] == 5 for thing in home.world.things.values())


def test_a_broken_robot_is_done_without(make: Make) -> None:
    home = make({"living": living(NOVEL, ("comics_1", "comics", 1, 3), robots=(("r1", 0, 0), ("r3", 0, 3)))})
    home.world.robots["living.r1"].broken = True
    assert home.end().goal, home.story()
    assert {"robot_broken", "diagnosis"} <= set(home.kinds("living"))
    assert home.world.things["novel_1"].at[0] == home.world.things["comics_1"].at[0] == 5


def test_without_a_robot_that_works_everything_is_left_and_named(make: Make) -> None:
    home = make({"living": living(NOVEL)})
    home.world.before["living", "attach(r1)"] = lambda: setattr(home.world.robots["living.r1"], "broken", True)
    over = home.end()
    assert not over.goal
    assert "no robot is left that works" in over.reason


def test_a_changed_order_has_a_team_at_rest_look_again(make: Make) -> None:
    home = make({"living": living(NOVEL, **TO_KITCHEN), "kitchen": kitchen(*BUSY[:2])})
    home.until(lambda: "team_finished" in home.kinds("living"))
    assert home.over is None
    home.world.things["comics_1"] = Thing("living", "comics_1", "comics", (2, 1))
    home.world.node.request("coordinator", Order("living", ("comics_1",)))
    assert home.end().goal
    assert home.world.things["comics_1"].at[0] == 5


def test_nobody_helps_who_could_not_let_a_helper_in(make: Make) -> None:
    """Of two rooms one may know a door to the other, and not the other way round."""
    study = room("study", [("r3", 1, 1, {"light_weight": 1})], [], **TO_LIVING)
    to_study = {"exchange": [{"to": "study", "area": [0, 0, 3, 3]}]}
    home = make({"living": living(RUG, **to_study), "kitchen": kitchen(("mug_1", "mug", 2, 2)), "study": study})
    weigh(home, "rug", (3, 2))
    over = home.end()
    assert "living leaves rug as it is" in over.reason
    assert "helper_left" not in home.kinds()
    answers = [event.data for _, event in home.events if event.kind == "help_answered"]
    assert {(a["team"], a["reason"]) for a in answers} == {
        ("kitchen", "no door leads from living_room to kitchen"),
        ("study", "it has no robot that can"),
    }


@pytest.mark.slow
def test_who_stands_in_the_door_steps_aside_for_a_helper(make: Make) -> None:
    """The door is a cell wide, and nothing in their plans has them leave it: out, in, and home again."""
    weak = {"light_weight": 1}
    askers, helpers = (("r1", 0, 0), ("r3", 2, 0, weak)), (("r2", 1, 1), ("r4", 0, 3, weak))
    home = make({"living": living(RUG, robots=askers, **TO_KITCHEN), "kitchen": kitchen(robots=helpers)})
    weigh(home, "rug", (3, 2))
    home.until(lambda: "helper_left" in home.kinds())
    home.world.robots["living.r3"].at = (0, 3)
    home.until(lambda: "helper_came" in home.kinds())
    home.world.robots["kitchen.r4"].at = (0, 3)
    assert home.end().goal
    assert [home.kinds(team).count("made_way") for team in ("living", "kitchen")] == [1, 2]
    assert "helper_returned" in home.kinds("kitchen")
