from __future__ import annotations

import heapq
import math
import random

import numpy
import pytest
import shapely

from reasoning.motion.connectivity import Connectivity
from reasoning.motion.layout import Layout
from reasoning.motion.trajectory import roadmap, shortest
from tests.reasoning.motion.rooms import clearance, drawn, lined_up, rooms_parts

RADIUS_M = 0.25
CELL_M = 0.1


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(0, 300, 5))
def test_there_is_a_clear_trajectory_if_and_only_if_there_is_a_path(seed: int) -> None:
    for layout in (drawn(seed), lined_up(seed)):
        connectivity = Connectivity(layout, RADIUS_M)
        rng = random.Random(seed)
        for _ in range(10):
            p, q = ((rng.uniform(0.2, layout.width_m), rng.uniform(0.2, layout.height_m)) for _ in range(2))
            found = shortest(layout, RADIUS_M, p, q)
            assert (found is not None) == connectivity.path_exists(p, q)
            if found is None:
                continue
            assert (found.points[0], found.points[-1]) == (p, q)
            assert found.length_m == pytest.approx(sum(map(math.dist, found.points, found.points[1:])))
            assert clearance(layout, list(found.points)) > RADIUS_M


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(25))
def test_trajectories_are_as_short_as_a_grid_allows(seed: int) -> None:
    """Ways on a grid, of a somewhat larger disc, are not shorter. Those of a somewhat smaller one are not much longer:
    a grid with diagonals makes a way longer by 8.24 % at most."""
    layout = drawn(seed)
    larger, smaller = grid(layout, RADIUS_M + 0.06), grid(layout, RADIUS_M - 0.08)
    rng = random.Random(seed)
    cells = sorted(larger)
    compared = 0
    for start in rng.sample(cells, 4):
        upper, lower = lengths(larger, start), lengths(smaller, start)
        for goal in rng.sample(cells, 10):
            if goal not in upper:
                continue
            found = shortest(layout, RADIUS_M, *(((x + 0.5) * CELL_M, (y + 0.5) * CELL_M) for x, y in (start, goal)))
            assert found is not None
            assert found.length_m <= upper[goal] + 1e-9
            assert lower[goal] <= 1.0824 * found.length_m + 0.3
            compared += 1
    assert compared


def grid(layout: Layout, radius_m: float) -> set[tuple[int, int]]:
    """The cells in whose middle a disc can be."""
    width, height = int(layout.width_m / CELL_M), int(layout.height_m / CELL_M)
    x, y = numpy.meshgrid((numpy.arange(width) + 0.5) * CELL_M, (numpy.arange(height) + 0.5) * CELL_M)
    free = shapely.contains_xy(shapely.union_all(rooms_parts(layout, radius_m)), x, y)
    return {(int(column), int(row)) for row, column in zip(*numpy.nonzero(free), strict=True)}


def lengths(cells: set[tuple[int, int]], start: tuple[int, int]) -> dict[tuple[int, int], float]:
    """Dijkstra's lengths in metres from one cell to all others, to the eight next to each."""
    length, queue = {start: 0.0}, [(0.0, start)]
    while queue:
        reached, (x, y) = heapq.heappop(queue)
        if reached > length[x, y]:
            continue
        for dx, dy in ((a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b):
            cell, further = (x + dx, y + dy), reached + CELL_M * math.hypot(dx, dy)
            if cell in cells and further < length.get(cell, math.inf):
                length[cell] = further
                heapq.heappush(queue, (further, cell))
    return length


def test_a_trajectory_goes_round_the_nearer_corner() -> None:
    box = ((3.0, 0.0), (5.0, 0.0), (5.0, 4.0), (3.0, 4.0))
    found = shortest(Layout(8, 8, (box,)), RADIUS_M, (1, 3), (7, 3))
    assert found is not None
    # Tangents from both ends to arcs of 26 cm around the upper corners, and what is left of the quarter turns.
    leg, arc = math.hypot(2, 1), 0.26
    left = math.pi / 2 + math.atan2(1, 2) - math.acos(arc / leg)
    assert found.length_m == pytest.approx(2 + 2 * math.sqrt(leg**2 - arc**2) + 2 * arc * left, abs=0.005)


def test_the_same_question_has_the_same_answer_whatever_was_asked_before() -> None:
    layout = drawn(7)
    rng = random.Random(0)
    points = [(rng.uniform(0.2, layout.width_m), rng.uniform(0.2, layout.height_m)) for _ in range(12)]
    pairs = [(p, q) for p in points for q in points]
    one = [shortest(layout, RADIUS_M, *pair) for pair in pairs]
    roadmap.cache_clear()
    other = [shortest(layout, RADIUS_M, *pair) for pair in reversed(pairs)]
    assert one == other[::-1]
