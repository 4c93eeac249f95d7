"""The set-up of a house: what it comes to, and what is refused with the key that is wrong."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoning.setup import Refused, Setup, compile_setup
from tests.encodings.housekeeping.rooms import DOMAIN, NIGHTSTAND, robot, setup, tables, thing

GOOD = tables(
    [robot("r1", 0, 0), robot("r2", 0, 1, short_arm=1)],
    [thing("a", 1, 1)],
    heavy=[{"name": "rug", "kind": "cushion", "at": [2, 0], "end": [2, 1]}],
    furniture=[NIGHTSTAND],
    exchange=[{"to": "kitchen", "area": [0, 1, 2, 2]}],
    never=[{"robot": "r1", "from": [0, 0], "to": [1, 1]}],
    late=[{"thing": "rug", "steps": 4}],
    deadline=20,
    minimise="duration",
)
TEAM = GOOD["teams"]["T1"]


def test_a_house_comes_to_constants_and_states() -> None:
    found = compile_setup(DOMAIN, GOOD)
    assert isinstance(found, Setup)
    assert found.static == {
        "geometry": "none", "radius(robot)": 25, "radius(thing)": 12, "radius(person)": 25, "delay": 2,
        "size(living_room)": "(4,3)",
        "area(living_room,living_room)": "(3,3,0,1)", "area(living_room,kitchen)": "(0,1,2,2)",
        "solid(living_room,nightstand)": "((100,0),(190,0),(190,100),(100,100))", "most(living_room,elapsed)": 20,
        "least(living_room)": "elapsed", "never(living_room,0)": "(r1,(0,0),(1,1))", "late(living_room,0)": "(rug,4)",
    }  # fmt: skip
    assert found.states["T1"] == {
        "room": "living_room", "elapsed": 0, "attaches": 0, "at(r1)": "(0,0)", "connected(r1)": "none",
        "short_arm(r1)": 0, "light_weight(r1)": 0, "at(r2)": "(0,1)", "connected(r2)": "none", "short_arm(r2)": 1,
        "light_weight(r2)": 0, "at(a)": "(1,1)", "kind(a)": "cushion", "raised(a)": 0, "at(rug)": "(2,0)",
        "end(rug)": "(2,1)", "kind(rug)": "cushion", "raised(rug)": 0,
    }  # fmt: skip
    assert [entity.name for entity in found.entities] == ["r1", "r2", "a", "rug"]
    assert found.workspaces["T1"] == {"width": 4, "height": 3}
    assert found.hidden["T1"] == {}


def test_what_nobody_knows_at_the_start_is_hidden() -> None:
    walk = [{"to": [2, 2], "after": 3}, {"to": [0, 2], "after": 5}]
    found = compile_setup(
        DOMAIN,
        tables(
            [robot("r1", 0, 0)],
            heavy=[{"name": "rug", "kind": "cushion", "at": [2, 0], "end": [2, 1], "known": 0}],
            persons=[{"name": "anna", "at": [0, 2], "stops": walk, "again": 9}],
        ),
    )
    assert isinstance(found, Setup)
    assert not {"end(rug)", "at(anna)", "kind(anna)"} & set(found.states["T1"])
    assert found.hidden["T1"] == {
        "end(rug)": "(2,1)", "at(anna)": "(0,2)", "kind(anna)": "person", "again(anna)": 9,
        "stop(anna,0)": "(3,(2,2))", "stop(anna,1)": "(5,(0,2))",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("robots", [robot("r1", 4, 0)], "a cell of the room: 0 to 3, 0 to 2"),
        ("robots", [robot("r1", 0, 0), robot("r2", 0, 0)], "a cell without another robot"),
        ("robots", [robot("a", 0, 0)], "a name that no other body of the team has"),
        ("robots", [robot("none", 0, 0)], "none is a word of the domain"),
        ("robots", [robot("not", 0, 0)], "a name: a small letter"),
        ("robots", [robot("r1", 0, 0), robot("r2", 1, 0)], "260 mm from all furniture; nightstand is 0 mm from r2"),
        ("persons", [{"name": "a", "at": [0, 2]}], "a name that no other body of the team has"),
        ("persons", [{"name": "anna", "at": [0, 3]}], "a cell of the room: 0 to 3, 0 to 2"),
        ("things", [thing("a", 2, 1)], "a cell without another thing; rug lies there"),
        ("heavy", [{"name": "rug", "kind": "rug", "at": [1, 0], "end": [3, 0]}], "a cell beside (1,0)"),
        ("deposit", [3, 2, 0, 1], "an area [west, east, south, north] inside the room"),
        ("deposit", [3, 4, 0, 1], "an area [west, east, south, north] inside the room"),
        ("deposit", [3, 3, 0], "an area [west, east, south, north] of four integers"),
        ("exchange", [{"to": "living_room", "area": [0, 0, 0, 0]}], "another room of the house"),
        ("exchange", [{"to": "den", "area": [0, 0, 0, 0]}, {"to": "den", "area": [1, 1, 0, 0]}], "another room"),
        ("furniture", [{"name": "bed", "corners": [[0, 0], [9, 0]]}], "the corners [[x, y], ...] of a polygon"),
        ("furniture", [{"name": "bed", "corners": [[0, 0], [9, 9], [9, 0], [0, 9]]}], "that does not touch itself"),
        ("furniture", [{"name": "bed", "corners": [[0, 0], [9, 0], [9, 0], [9, 9], [0, 9]]}], "does not touch itself"),
        ("furniture", [NIGHTSTAND, NIGHTSTAND], "a name that no other furniture of the room has"),
        ("minimise", "steps", "one of nothing, duration, attaches; found steps"),
        ("late", [{"thing": "b", "steps": 4}], "a thing of the team"),
        ("never", [{"robot": "r9", "from": [0, 0], "to": [1, 1]}], "a robot of the team"),
        ("never", [{"robot": "r1", "from": [0, 0], "to": [9, 1]}], "a cell of the room"),
    ],
)
def test_a_wrong_key_is_named_with_what_was_expected(key: str, value: Any, expected: str) -> None:
    given_tables = copy.deepcopy(GOOD)
    given_tables["teams"]["T1"][key] = value
    refused = compile_setup(DOMAIN, given_tables)
    assert isinstance(refused, Refused)
    assert any(f"teams.T1.{key}" in wrong.key and expected in wrong.expected for wrong in refused.errors), refused


def test_levels_and_rooms_are_checked_across_the_house() -> None:
    refused = compile_setup(DOMAIN, {**GOOD, "house": {"geometry": "some"}})
    assert isinstance(refused, Refused)
    assert str(refused.errors[0]) == "house.geometry: expected one of none, static, interleaved, both; found some"
    untimed = compile_setup(DOMAIN, {**GOOD, "house": {"durations": "none"}})
    assert isinstance(untimed, Refused)
    assert "teams.T1.minimise: expected nothing or attaches, since house.durations is none" in str(untimed.errors[0])
    unknown = compile_setup(DOMAIN, {**GOOD, "house": {"durations": "some"}})
    assert isinstance(unknown, Refused)
    assert str(unknown.errors[0]) == "house.durations: expected one of planned, none; found some"
    twice = compile_setup(DOMAIN, {"teams": {"T1": TEAM, "T2": TEAM}})
    assert isinstance(twice, Refused)
    assert any("a room that no other team has" in wrong.expected for wrong in twice.errors)


@pytest.mark.parametrize(("east", "stands"), [(124, True), (125, False), (150, False)])
def test_robots_begin_off_the_furniture(east: int, stands: bool) -> None:
    """The middle of the robot's cell is at 150 cm, its radius 25 cm, and a centimetre is between them."""
    bed = {"name": "bed", "corners": [[0, 0], [east, 0], [east, 300], [0, 300]]}
    found = compile_setup(DOMAIN, tables([robot("r1", 1, 1)], level="both", furniture=[bed]))
    assert isinstance(found, Setup if stands else Refused)
    if isinstance(found, Refused):
        assert [str(wrong) for wrong in found.errors] == [
            "teams.T1.robots[0].at: expected a cell whose middle is at least 260 mm from all furniture; "
            f"bed is {1500 - 10 * east} mm from r1"
        ]


def test_furniture_need_not_be_convex() -> None:
    corner = {"name": "corner", "corners": [[0, 0], [300, 0], [300, 50], [50, 50], [50, 200], [0, 200]]}
    assert "solid(living_room,corner)" in setup([robot("r1", 2, 1)], furniture=[corner]).static


JUNK = st.recursive(
    st.none() | st.integers() | st.text(max_size=4) | st.floats(),
    lambda inner: st.lists(inner, max_size=4),
    max_leaves=8,
)


@settings(max_examples=40, deadline=None)
@given(key=st.sampled_from(["deposit", "corners", "area", "end"]), junk=JUNK)
def test_junk_is_refused_or_compiled_but_never_crashes(key: str, junk: Any) -> None:
    given_tables = copy.deepcopy(GOOD)
    team = given_tables["teams"]["T1"]
    table = {"deposit": team, "corners": team["furniture"][0], "area": team["exchange"][0], "end": team["heavy"][0]}[
        key
    ]
    table[key] = junk
    assert isinstance(compile_setup(DOMAIN, given_tables), (Setup, Refused))
