"""Geometry for planner and checker: rooms from constants, facts, and the replay of ways against the polygons."""

from __future__ import annotations

import math
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoning.domain import domains, load
from reasoning.geometry import WALL, Room, between, cell, facts, middle, room, room_facts
from reasoning.motion.oracle import Oracle
from reasoning.motion.trajectory import Trajectory
from reasoning.replay import collision
from reasoning.solver import parse
from reasoning.values import Problem

BED = ("bed", ((1.0, 0.0), (1.9, 0.0), (1.9, 1.0), (1.0, 1.0)))
SHELF = ("shelf", ((1.0, 1.1), (1.9, 1.1), (1.9, 3.0), (1.0, 3.0)))
STOOL = ("stool", ((3.4, 2.4), (3.6, 2.4), (3.6, 2.6), (3.4, 2.6)))


def of(*furniture: tuple[str, tuple[tuple[float, float], ...]], level: str = "static") -> Room:
    return Room(level, (4, 3), furniture, 0.25, 0.12)


def told(known: Room) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for fact in room_facts(known):
        found.setdefault(fact.partition("(")[0], []).append(fact)
    return found


def test_a_room_is_what_the_constants_of_its_domain_say() -> None:
    name = next(name for name in domains() if load(name).data.geometry)
    names = load(name).data.geometry
    static = {
        names["level"]: "both", f"{names['size']}(den)": "(4,3)", f"{names['radius']}(robot)": 25,
        f"{names['radius']}(thing)": 12, f"{names['solid']}(den,bed)": "((100,0),(190,0),(190,100),(100,100))",
        f"{names['solid']}(attic,bed)": "((0,0),(10,0),(10,10))",
    }  # fmt: skip
    assert room(name, static, {names["room"]: "den"}) == of(BED, level="both")
    assert room(name, static, {}) is None
    assert room(name, static, {names["room"]: "attic"}) is None
    assert facts(Problem(name, static, {})) == []


def test_a_domain_without_geometry_is_told_nothing() -> None:
    name = next(name for name in domains() if not load(name).data.geometry)
    assert room(name, {}, {}) is None
    assert facts(Problem(name, {}, {})) == []


@pytest.mark.parametrize("level", ["none", "static", "interleaved", "both"])
def test_which_facts_a_level_wants(level: str) -> None:
    found = told(of(BED, level=level))
    assert found["covered"] == ["covered((1,0))."]
    assert ("part" in found, "path" in found) == (level != "none", level in ("static", "both"))


def test_ways_are_told_with_their_lengths_in_both_directions() -> None:
    lengths = {tuple(parse(fact[:-1])[1][:2]): parse(fact[:-1])[1][2] for fact in told(of(BED))["path"]}
    assert lengths["(0,1)", "(3,1)"] == lengths["(3,1)", "(0,1)"] == 3000
    assert lengths["(0,0)", "(0,0)"] == 0
    inside = math.hypot(0.5, 0.76) + 0.9 + math.hypot(0.6, 0.76)  # over the bed's corners, and round them
    outside = math.hypot(0.24, 0.76) + 1.42 + math.hypot(0.34, 0.76)
    assert 1000 * inside < lengths["(0,0)", "(2,0)"] < 1000 * outside
    assert ("(0,0)", "(1,0)") not in lengths


def test_parts_of_the_floor_and_what_is_between_them() -> None:
    found = told(of(BED, SHELF, STOOL))
    assert sorted(found["apart"]) == ['apart(0,1,"bed and shelf").', 'apart(1,0,"bed and shelf").']
    assert 'touches((3,2),"stool").' in found["touches"]
    assert 'touches((1,1),"shelf").' in found["touches"] or 'touches((1,1),"bed and shelf").' in found["touches"]
    assert {fact for fact in found["part"] if ",0)." in fact} == {f"part((0,{y}),0)." for y in range(3)}


def test_only_furniture_that_is_needed_is_named() -> None:
    long = ("counter", ((1.0, 0.0), (1.5, 0.0), (1.5, 2.7), (1.0, 2.7)))
    assert between(of(long, STOOL), (0, 0), (3, 0)) == f"counter and {WALL}"
    assert between(of(BED, SHELF, STOOL), (0, 0), (3, 0)) == "bed and shelf"


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        (((0.5, 0.5), (0.5, 2.5)), ""),
        (((0.5, 0.5), (3.5, 0.5)), "bed"),
        (((0.5, 0.5), (0.76, 0.5)), "bed"),
        (((0.5, 0.5), (0.74, 0.5)), ""),
        (((0.5, 0.5), (0.5, 2.8)), WALL),
        (((0.5, 1.5), (1.5, 1.5), (2.5, 1.4)), ""),
        (((0.5, 2.0), (3.0, 2.0)), "book"),
        (((0.5, 2.0), (1.62, 2.0)), ""),
        (((0.5, 2.0), (1.64, 2.0)), "book"),
    ],
)
def test_a_way_is_replayed_against_walls_furniture_and_things(
    points: tuple[tuple[float, float], ...], expected: str
) -> None:
    assert collision(of(BED), {"book": (2.0, 2.0, 0.12)}, Trajectory(points, 0.0)) == expected


def test_a_polygon_need_not_be_convex_to_be_replayed() -> None:
    corner = ("corner", ((1.0, 0.0), (3.0, 0.0), (3.0, 2.0), (2.6, 2.0), (2.6, 0.4), (1.0, 0.4)))
    assert collision(of(corner), {}, Trajectory(((1.5, 1.5), (2.0, 1.2)), 0.0)) == ""
    assert collision(of(corner), {}, Trajectory(((2.8, 1.0),), 0.0)) == "corner"
    assert collision(of(corner), {}, Trajectory(((2.0, 1.2), (3.5, 1.2)), 0.0)) == "corner"


def test_who_begins_far_inside_a_piece_touches_it_as_well() -> None:
    stage = ("stage", ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)))
    assert collision(of(stage), {}, Trajectory(((2.0, 1.5),), 0.0)) == "stage"


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_what_the_motion_planner_finds_is_clear_in_the_replay(seed: int) -> None:
    draw = random.Random(seed)
    pieces = []
    for number in range(draw.randint(0, 4)):
        x, y, turn = draw.uniform(0.5, 7.5), draw.uniform(0.5, 7.5), draw.uniform(0, math.pi)
        corners = [(a * draw.uniform(0.2, 0.9), b * draw.uniform(0.2, 0.9)) for a, b in ((1, 1), (-1, 1), (-1, -1))]
        turned = [
            (
                round(x + u * math.cos(turn) - v * math.sin(turn), 2),
                round(y + u * math.sin(turn) + v * math.cos(turn), 2),
            )
            for u, v in corners
        ]
        pieces.append((f"piece_{number}", tuple(turned)))
    known = Room("static", (8, 8), tuple(pieces), 0.25, 0.12)
    cells = draw.sample(known.cells, 6)
    things = {f"thing_{n}": known.thing(c) for n, c in enumerate(cells[2:])}
    layout = known.layout.with_discs(things.values())
    way = Oracle().shortest(layout, known.robot_m, middle(cells[0]), middle(cells[1]))
    if way is not None:
        assert collision(known, things, way) == ""


@pytest.mark.parametrize("wrong", ["(1,2,3)", "cell", "(a,b)", 7, "("])
def test_what_is_no_cell_is_refused(wrong: int | str) -> None:
    assert cell("(1,2)") == (1, 2)
    with pytest.raises(ValueError, match="not a"):
        cell(wrong)
