"""Robots that stand in one another's way, or too near to something: what geometry refuses, no agent dies of."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from agents.autonomous import recovering
from agents.autonomous.ways import NoWay, Ways
from agents.autonomous.words import words
from bus.messages import State
from reasoning.geometry import Room
from tests.agents.house import DOMAIN, UNIT_S, Home, Thing

SHELF = ((0.0, 1.0), (4.0, 1.0), (4.0, 2.0), (0.0, 2.0))
"""It leaves a corridor, which is a cell wide, and a square of four cells in the east."""


def ways(*furniture: Any, size: tuple[int, int] = (6, 2)) -> Ways:
    pieces = tuple((f"piece_{number}", corners) for number, corners in enumerate(furniture))
    return Ways(words(DOMAIN), Room("none", size, pieces, 0.25, 0.12), 3.0, 2.0)


def robots(**at: str) -> State:
    return {key: v for r, place in at.items() for key, v in ((f"at({r})", place), (f"connected({r})", "none"))}


def test_ways_lead_round_robots_that_stand_about() -> None:
    state = robots(r1="(2,0)", r2="(0,0)")
    way = ways().way(state, "r2", {"r2": (5, 0)})
    assert all(math.dist(at, (2.5, 0.5)) >= 0.5 for at in way)
    assert len(way) > 2
    assert ways().way(state, "r2", {"r2": (5, 0), "r1": (2, 1)}) == ((0.5, 0.5), (5.5, 0.5))


def test_who_stands_in_the_way_is_named_and_finds_a_place_to_step_aside() -> None:
    state, goals = robots(r1="(3,0)", r2="(0,0)", r3="(5,1)"), {"r2": (5, 0)}
    with pytest.raises(NoWay, match=r"r2 has no way to \(5,0\) past r1$") as refused:
        ways(SHELF).way(state, "r2", goals)
    assert refused.value.behind == ("r1",)
    assert ways(SHELF).aside(state, "r1", refused.value, ()) == (4, 1)
    assert ways(SHELF).aside(state, "r1", refused.value, [(4.5, 1.5, 0.35)]) is None
    beam = {"at(beam)": "(3,0)", "end(beam)": "(2,0)", "kind(beam)": "beam", "connected(r1)": "grip(beam,1)"}
    assert ways(SHELF).aside({**state, **beam}, "r1", refused.value, ()) is None


def test_who_faces_a_person_finds_a_place_off_the_line_on_which_that_one_comes() -> None:
    person, discs, state = (2.7, 0.5), [(2.7, 0.5, 0.35)], {**robots(r1="(3,0)"), "pose(r1)": "(3300,630)"}
    assert ways(SHELF).passing(state, "r1", person, discs) == (4, 1)
    assert ways(SHELF).passing({**state, **robots(r2="(4,1)")}, "r1", person, discs) == (5, 1)
    assert ways(SHELF).passing(state, "r1", (4.5, 0.5), [(4.5, 0.5, 0.35)]) is None
    beam = {"at(beam)": "(3,0)", "end(beam)": "(2,0)", "kind(beam)": "beam", "connected(r1)": "grip(beam,1)"}
    assert ways(SHELF).passing({**state, **beam}, "r1", person, discs) is None


def test_robots_go_from_where_they_are_too_near_to_something() -> None:
    corner = {**robots(r1="(4,0)", r2="(3,0)"), "pose(r1)": "(4180,820)", "pose(r2)": "(3730,660)"}
    assert math.dist((4.18, 0.82), (4.0, 1.0)) < 0.26
    assert math.dist((4.18, 0.82), (3.73, 0.66)) < 0.51
    way = ways(SHELF).way(corner, "r1", {"r1": (5, 1)})
    assert way[0] == (4.18, 0.82)
    assert math.dist(way[0], way[1]) < 0.05
    assert ways(SHELF).nearest_cell(corner, "r1", (), ()) == (4, 0)


def test_two_robots_put_down_what_they_carry_where_both_can_stand() -> None:
    held = {"connected(r1)": "grip(beam,1)", "connected(r2)": "grip(beam,2)", "kind(beam)": "beam"}
    state = {**robots(r1="(1,0)", r2="(2,0)"), **held, "at(beam)": "(1,0)", "end(beam)": "(2,0)"}
    between = {**state, "pose(r1)": "(1700,500)", "pose(r2)": "(2700,500)"}
    assert ways(SHELF).nearest_cells(between, "r1", "r2", (), ()) == {"r1": (1, 0), "r2": (2, 0)}


ROOM = {
    "room": "living_room",
    "width": 6,
    "height": 2,
    "deposit": [5, 5, 0, 0],
    "furniture": [{"name": "shelf", "corners": [[round(100 * x), round(100 * y)] for x, y in SHELF]}],
}
"""A corridor beside a shelf."""


@pytest.fixture
def corridor(tmp_path: Path) -> Iterator[Home]:
    """r1 stands in the corridor and cannot take the novel behind it, which r2 is to bring past it; plans never have r1
    go away by itself."""
    living = {
        **ROOM,
        "robots": [{"name": "r1", "at": [3, 0], "short_arm": 1}, {"name": "r2", "at": [0, 0]}],
        "things": [{"name": "novel", "kind": "novel", "at": [1, 0]}],
        "never": [
            {"robot": "r1", "from": [3, 0], "to": to} for to in ([0, 0], [1, 0], [2, 0], [4, 0], [5, 0], [4, 1], [5, 1])
        ],
    }
    home = Home(tmp_path, {"living": living})
    yield home
    home.close()


def test_a_robot_steps_aside_for_another_one(corridor: Home) -> None:
    assert corridor.end().goal
    kinds = corridor.kinds("living")
    assert kinds.index("made_way") < kinds.index("new_way") < kinds.index("team_finished")
    assert "set_aside" not in kinds


def test_who_has_no_way_to_any_cell_stays_and_the_run_ends_in_words(corridor: Home) -> None:
    def shut_in() -> None:
        corridor.world.things["vase"] = Thing("living", "vase", "vase", (3, 0), seen=False)
        corridor.world.things["bowl"] = Thing("living", "bowl", "vase", (2, 0))

    corridor.world.robots["living.r1"].at = (5, 1)
    corridor.world.before["living", "goto(r2,5,0)"] = shut_in
    over = corridor.end()
    assert not over.goal
    assert "novel" in over.reason
    assert "stays" in corridor.kinds("living")


@pytest.fixture
def faced(tmp_path: Path) -> Iterator[Home]:
    """Only one robot, at the end of the corridor, and a person in it."""
    living = {
        **ROOM,
        "robots": [{"name": "r1", "at": [5, 0]}],
        "things": [{"name": "novel", "kind": "novel", "at": [0, 0]}],
    }
    home = Home(tmp_path / "faced", {"living": living})
    home.world.persons["anna"] = ("living", (1, 0), math.inf)
    yield home
    home.close()


def test_who_faces_a_person_in_a_corridor_lets_that_one_by(faced: Home) -> None:
    """Neither of the two can go on before the other one has gone."""
    robot = faced.world.robots["living.r1"]
    faced.until(lambda: "made_way" in faced.kinds("living") and robot.pose is None)
    assert robot.at == (4, 1)
    del faced.world.persons["anna"]
    assert faced.end().goal
    assert faced.now_s < recovering.PATIENCE_UNITS * UNIT_S
    assert faced.kinds("living").count("made_way") == 1


def test_a_person_who_stands_there_for_ever_is_given_up_all_the_same(faced: Home) -> None:
    faced.until(lambda: "plan_dropped" in faced.kinds("living"))
    assert faced.kinds("living").count("made_way") == recovering.MOST_GIVEN_WAY
    waiting = recovering.FACING_UNITS + recovering.PASSING_UNITS
    assert faced.now_s < (recovering.MOST_GIVEN_WAY * (waiting + 3) + recovering.PATIENCE_UNITS + 3) * UNIT_S
