from __future__ import annotations

import gc
import math
import os
import random
import signal
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from shapely.geometry import LineString, Point

from reasoning.motion.layout import Layout
from reasoning.motion.oracle import Oracle
from reasoning.motion.payload import Answer, PayloadPlanner, WorkerError
from reasoning.motion.rigid import Body, Pose, Surroundings, at_share, between, carried, placed
from tests.reasoning.motion.rooms import drawn, obstacles

TABLE = carried(1.0, 0.25, 0.1)


def door(wide_m: float) -> Layout:
    """Two rooms of 4 x 8 m with a door between them."""
    low, high = 4 - wide_m / 2, 4 + wide_m / 2
    walls = (((3.9, 0), (4.1, 0), (4.1, low), (3.9, low)), ((3.9, high), (4.1, high), (4.1, 8), (3.9, 8)))
    return Layout(8, 8, walls)


def step_clear(layout: Layout, body: Body, path: tuple[Pose, ...]) -> bool:
    """In steps of a few millimetres, the body's outline against the furniture as it is."""
    solid = obstacles(layout, fine=64)
    for first, second in pairwise(path):
        steps = 1 + int((math.dist(first, second) + math.pi) / 0.01)
        for k in range(steps + 1):
            pose = at_share(first, second, k / steps)
            for a, b, radius in body:
                ends = [placed(a, pose), placed(b, pose)]
                core = Point(ends[0]) if a == b else LineString(ends)
                x1, y1, x2, y2 = core.bounds
                walls = min(x1, y1, layout.width_m - x2, layout.height_m - y2)
                if min(walls, core.distance(solid)) < radius:
                    return False
    return True


@pytest.fixture
def planner() -> Iterator[PayloadPlanner]:
    with PayloadPlanner(Oracle()) as planner:
        yield planner


START, GOAL = between((2.0, 3.5), (2.0, 4.5)), between((6.0, 3.5), (6.0, 4.5))


@pytest.mark.parametrize("wide_m", [2.5, 0.9, 0.6])
def test_two_robots_carry_a_table_through_a_door(planner: PayloadPlanner, wide_m: float) -> None:
    answer = planner.path(door(wide_m), TABLE, START, GOAL)
    assert answer.verdict == "yes"
    assert answer.path[0] == pytest.approx(START)
    assert answer.path[-1][:2] == pytest.approx(GOAL[:2])
    assert math.remainder(answer.path[-1][2] - GOAL[2], 2 * math.pi) == pytest.approx(0, abs=1e-9)
    assert step_clear(door(wide_m), TABLE, answer.path)
    assert planner.verdicts == {"yes": 1}


@pytest.mark.parametrize("order", [1, -1])
def test_half_a_turn_is_written_in_two_ways(planner: PayloadPlanner, order: int) -> None:
    goal = (6.0, 4.0, order * math.pi)
    answer = planner.path(door(0.9), TABLE, START, goal)
    assert answer.verdict == "yes"
    assert abs(math.remainder(answer.path[-1][2] - math.pi, 2 * math.pi)) < 1e-9
    assert step_clear(door(0.9), TABLE, answer.path)


def test_no_is_proved_by_a_robot_that_does_not_fit(planner: PayloadPlanner) -> None:
    assert planner.path(door(0.5), TABLE, START, GOAL) == Answer("no")
    assert planner.pid is None  # nobody had to search


def test_no_is_proved_by_a_goal_that_is_taken(planner: PayloadPlanner) -> None:
    chair = door(0.9).with_discs([(6.0, 4.0, 0.2)])
    assert planner.path(chair, TABLE, START, GOAL) == Answer("no")
    assert planner.path(chair, TABLE, START, between((6.4, 3.5), (6.4, 4.5))).verdict == "yes"


def test_a_search_that_finds_nothing_is_undecided_and_counted() -> None:
    """The corner is too sharp for a table of 2 m, though each robot gets round it."""
    upper = ((0.6, 0.6), (6.0, 0.6), (6.0, 6.0), (0.6, 6.0))
    corridor, long = Layout(6, 6, (upper,)), carried(2.0, 0.25, 0.1)
    with PayloadPlanner(Oracle(), budget=2000) as planner:
        start, goal = between((0.3, 5.0), (0.3, 3.0)), between((3.0, 0.3), (5.0, 0.3))
        assert planner.path(corridor, long, start, goal) == Answer("undecided")
        assert planner.path(corridor, long, start, goal) == Answer("undecided")
        assert planner.verdicts == {"undecided": 1}
        assert planner.deaths == 0


def test_a_killed_worker_is_replaced_and_the_answers_are_the_same(planner: PayloadPlanner) -> None:
    whole = planner.path(door(0.9), TABLE, START, GOAL)
    with PayloadPlanner(Oracle()) as other:
        other.path(door(0.8), TABLE, START, GOAL)
        assert other.pid is not None
        os.kill(other.pid, signal.SIGKILL)
        assert other.path(door(0.9), TABLE, START, GOAL) == whole
        assert other.deaths == 1


def test_a_query_that_costs_every_worker_its_life_is_undecided(
    planner: PayloadPlanner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mayfly = tmp_path / "mayfly"
    mayfly.write_text("#!/bin/sh\necho ready\nread query\n")
    mayfly.chmod(0o700)
    monkeypatch.setattr(sys, "executable", str(mayfly))
    assert planner.path(door(0.9), TABLE, START, GOAL) == Answer("undecided")
    assert planner.deaths == 3
    assert planner.verdicts == {"undecided": 1}


def test_a_forgotten_planner_ends_its_worker() -> None:
    planner = PayloadPlanner(Oracle())
    planner.path(door(0.9), TABLE, START, GOAL)
    pid = planner.pid
    assert pid is not None
    del planner
    gc.collect()
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_a_worker_that_does_not_start_is_an_error(planner: PayloadPlanner, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(WorkerError, match="does not start"):
        planner.path(door(0.9), TABLE, START, GOAL)


@pytest.mark.slow
def test_paths_in_drawn_rooms_are_clear_in_small_steps() -> None:
    found = 0
    with PayloadPlanner(Oracle(), budget=3000) as planner:
        for seed in range(8):
            layout, rng = drawn(seed), random.Random(seed)
            around = Surroundings(layout)
            poses = [
                (rng.uniform(0, layout.width_m), rng.uniform(0, layout.height_m), rng.uniform(-3, 3)) for _ in range(16)
            ]
            free = [pose for pose in poses if around.clearance(TABLE, pose) > 0.01]
            for start, goal in zip(free[::2], free[1::2], strict=False):
                answer = planner.path(layout, TABLE, start, goal)
                if answer.verdict == "yes":
                    found += 1
                    assert step_clear(layout, TABLE, answer.path), (seed, start, goal)
        assert found == planner.verdicts["yes"] > 3
