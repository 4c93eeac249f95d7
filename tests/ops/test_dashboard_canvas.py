"""Pictures out of braille, dot by dot, and where the rooms of a house go."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from ops.dashboard.canvas import Canvas
from ops.dashboard.rooms import Door, Room, arranged, extent


def drawn(canvas: Canvas) -> list[str]:
    return [text.plain for text in canvas.block()]


def test_dots_have_their_places_in_a_cell() -> None:
    canvas = Canvas(3, 1)
    for x, y in ((0, 0), (3, 3), (4, 1), (5, 2), (-1, 0), (6, 0), (0, 4)):
        canvas.dot(x, y, "red")
    assert drawn(canvas) == ["⠁⢀⠢"]


def test_areas_are_filled_to_their_edges_at_any_angle() -> None:
    canvas = Canvas(10, 3)
    canvas.polygon([(2, 1), (12, 3), (10, 11), (4, 9)], "")
    canvas.polygon([(14, 2), (20, 2), (20, 10), (14, 10)], "", sparse=True)
    assert drawn(canvas) == [" ⢶⣦⣤⣄⣀ ⣤⢤⢤", " ⠸⣿⣿⣿⡏ ⣗⢕⢽", "  ⠙⠛⠿⠁ ⠓⠓⠛"]


def test_discs_are_round_and_never_vanish() -> None:
    canvas = Canvas(12, 3)
    for x, radius in ((4, 4.0), (13, 2.5), (19, 1.25), (22.5, 0.1)):
        canvas.disc((x, 6), radius, "")
    assert drawn(canvas) == ["⢀⣤⣤⡀        ", "⣿⣿⣿⣿ ⢸⣿⡇ ⠶ ⠄", "⠈⠛⠛⠁        "]


def test_lines_may_be_dotted_and_letters_replace_dots() -> None:
    canvas = Canvas(10, 3)
    canvas.line((0, 11), (19, 0), "green")
    canvas.path([(0, 0), (12, 0), (12, 11)], "blue", every=3)
    canvas.text(7, 1, "r1", "bold")
    canvas.text(9, 2, "cut", "bold")
    assert drawn(canvas) == ["⠁⠈ ⠁⠈ ⣁⡠⠔⠊", "   ⢀⠤⠒⠅r1 ", "⡠⠔⠊⠁  ⠂  c"]
    assert canvas.written(8, 1)
    assert not canvas.written(6, 1)
    assert canvas.written(10, 0)


def test_a_cell_has_the_colour_of_what_was_drawn_last() -> None:
    canvas = Canvas(4, 1)
    canvas.line((0, 0), (7, 0), "red")
    canvas.dot(2, 3, "blue")
    row = canvas.block()[0]
    assert [(row.plain[s.start : s.end], s.style) for s in row.spans] == [("⠉", "red"), ("⡉", "blue"), ("⠉⠉", "red")]


def test_a_ground_shows_where_nothing_is_drawn_and_never_vanishes() -> None:
    canvas = Canvas(8, 3)
    canvas.ground((2, 0), (9, 8), "·", "dim")
    canvas.ground((13, 9), (13.5, 10), ":", "dim")
    canvas.ground((-9, -9), (-1, -1), "x", "dim")
    canvas.dot(4, 5, "red")
    canvas.text(3, 1, "r", "bold")
    assert drawn(canvas) == [" ···    ", " ·⠂r    ", "      : "]
    assert not canvas.written(1, 0)


NUMBERS = st.floats(-200, 200)
POINTS = st.tuples(NUMBERS, NUMBERS)


@given(st.lists(POINTS, min_size=3, max_size=6), POINTS, st.floats(0, 50))
def test_nothing_is_drawn_outside(corners: list[tuple[float, float]], centre: tuple[float, float], r: float) -> None:
    canvas = Canvas(7, 5)
    canvas.polygon(corners, "")
    canvas.disc(centre, r, "")
    canvas.path(corners, "", every=2)
    canvas.text(round(centre[0]), round(centre[1]), "name", "")
    assert [cell_len(line) for line in drawn(canvas)] == [7] * 5


# The published house: living room and kitchen, living room and bedroom face each other, kitchen and bedroom do not.
BEDROOM = Room("bedroom", 8, 8, (Door("kitchen", "north", 3, 5), Door("living_room", "east", 3, 5)))
KITCHEN = Room("kitchen", 8, 8, (Door("bedroom", "west", 3, 5), Door("living_room", "north", 3, 5)))
LIVING = Room("living_room", 16, 8, (Door("kitchen", "south", 11, 13), Door("bedroom", "west", 3, 5)))
HOUSE = (BEDROOM, KITCHEN, LIVING)


def test_rooms_are_in_a_row_where_it_is_low_and_a_floor_plan_where_it_is_high() -> None:
    low = arranged(HOUSE, 80, 11)
    assert [(v.room.name, v.column) for v in low.views] == [("bedroom", 0), ("living_room", 20), ("kitchen", 58)]
    assert {v.row for v in low.views} == {0}
    high = arranged(HOUSE, 112, 34)
    views = {v.room.name: v for v in high.views}
    door = views["living_room"].dots(12, 0)
    assert views["kitchen"].dots(4, 8)[0] == pytest.approx(door[0], abs=1)
    assert views["kitchen"].row == views["living_room"].row + views["living_room"].rows
    assert views["bedroom"].row == views["living_room"].row
    assert views["bedroom"].column + views["bedroom"].columns == views["living_room"].column


@given(st.integers(1, 250), st.integers(1, 90), st.integers(0, 3))
def test_rooms_fit_and_keep_apart(columns: int, rows: int, number: int) -> None:
    found = arranged(HOUSE[:number], columns, rows)
    wide, tall = extent(found.views)
    assert wide <= columns
    assert tall <= rows
    assert len({v.scale for v in found.views}) <= 1
    cells = [(x, y) for v in found.views for x in range(v.column, v.column + v.columns)
             for y in range(v.row, v.row + v.rows)]  # fmt: skip
    assert len(set(cells)) == len(cells)
