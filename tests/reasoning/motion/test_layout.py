from __future__ import annotations

import math
import random

import pytest
import shapely
from shapely.geometry import Polygon

from reasoning.motion.convex import canonical, convex_parts, turn
from reasoning.motion.layout import Layout

SQUARE = ((1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0))


def test_equal_rooms_are_equal_keys() -> None:
    turned = (*SQUARE[2:], *SQUARE[:2])
    idle = (SQUARE[0], (1.5, 1.0), *SQUARE[1:])
    one = Layout(8, 8, (SQUARE,), ((3.0, 3.0, 0.1),))
    for polygon in (turned, SQUARE[::-1], idle):
        other = Layout(8.0, 8.0004, (polygon,), ((3.0001, 2.9999, 0.1),))
        assert other == one
        assert hash(other) == hash(one)
    assert Layout(8, 8, (SQUARE,), ((3.001, 3.0, 0.1),)) != one
    assert one.with_discs([]) == one.bare


def test_a_corner_that_is_told_twice_is_a_corner() -> None:
    for times in range(2, 4):
        assert canonical((*SQUARE[:2], *SQUARE[1:2] * (times - 1), *SQUARE[2:])) == canonical(SQUARE)
    assert canonical((*SQUARE, SQUARE[0])) == canonical(SQUARE)
    spike = (*SQUARE[:3], (3.0, 3.0), *SQUARE[2:])
    assert canonical(spike) == canonical(SQUARE)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ((0, 8), "width_m"),
        ((8, float("nan")), "height_m"),
        ((8, 8, (SQUARE[:2],)), "three corners"),
        ((8, 8, (((0.0, 0.0), (1.0, 1.0), (2.0, 2.0)),)), "three corners"),
        ((8, 8, (((0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)),)), "crosses or touches itself"),
        ((8, 8, (((0.0, 0.0), (float("inf"), 2.0), (2.0, 0.0)),)), "not finite"),
        ((8, 8, (), ((1.0, 1.0, 0.0),)), "positive radius"),
        ((8, 8, (), ((1.0, float("nan"), 0.1),)), "finite coordinates"),
    ],
)
def test_wrong_layouts_are_refused(arguments: tuple, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        Layout(*arguments)


@pytest.mark.parametrize("seed", range(200))
def test_parts_are_convex_and_cover_the_polygon(seed: int) -> None:
    """Stars with up to 12 corners, a corner in each of as many sectors; most of them are not convex."""
    rng = random.Random(seed)
    count = rng.randint(4, 12)
    form = canonical(tuple(_polar((k + rng.uniform(0.1, 0.9)) / count, rng.uniform(0.3, 2)) for k in range(count)))
    parts = convex_parts(form)
    for part in parts:
        around = zip(part[-2:] + part[:-2], part[-1:] + part[:-1], part, strict=True)
        assert all(turn(*three) >= -1e-12 for three in around)
    pieces = [Polygon(part) for part in parts]
    assert sum(piece.area for piece in pieces) == pytest.approx(Polygon(form).area)
    assert shapely.union_all(pieces).symmetric_difference(Polygon(form)).area < 1e-9


def test_what_is_convex_stays_whole() -> None:
    assert convex_parts(canonical(SQUARE)) == (canonical(SQUARE),)


def _polar(turns: float, length: float) -> tuple[float, float]:
    return 4 + length * math.cos(2 * math.pi * turns), 4 + length * math.sin(2 * math.pi * turns)
