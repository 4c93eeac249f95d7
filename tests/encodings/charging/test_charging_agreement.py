"""Planner and checker, which share no law, say the same of drawn steps: which of them are possible."""

from __future__ import annotations

import random

import pytest

from reasoning.checker import check
from reasoning.planner import predict
from reasoning.values import Problem, Step
from tests.encodings.charging.teams import DOMAIN, team

SIDES = ("left", "right", "up", "down")
GOALS = {"goal_stage", "goal_line"}


def problem_of(rng: random.Random) -> Problem:
    cells = [(x, y) for x in (1, 2, 3) for y in (1, 2)]
    places = rng.sample(cells, 2)
    workers = [(place, rng.randint(1, 3), rng.choice((0, 1, 2, 12, 12, 12))) for place in places]
    docked = rng.choice(("none", "w1"))
    charger = places[0] if docked == "w1" else rng.choice((places[0], places[1], cells[0]))
    boxes = [(p, stage := rng.randint(0, 2), int(stage == 1 and rng.random() < 0.3)) for p in (2, 3)]
    broken = rng.choice(([], [], [], ["c1"], ["w1"]))
    return team(workers, boxes, charger=charger, docked=docked, broken=broken)


def step_of(rng: random.Random) -> Step:
    w, b = rng.choice(("w1", "w2")), rng.randint(1, 2)
    pool = [
        f"move({w},{rng.choice(SIDES)})",
        f"move(c1,{rng.choice(SIDES)})",
        f"dock(c1,{w})",
        "undock(c1)",
        "charge(c1)",
        f"swapEndEffector({w},{rng.randint(1, 3)})",
        f"workOn({w},{b})",
        "lineShift",
        f"giveRobot({w})",
        f"repair({rng.choice(('c1', w))})",
    ]
    return tuple(sorted({rng.choice(pool) for _ in range(rng.choice((1, 1, 1, 1, 2)))}))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_a_step_is_possible_when_the_checker_finds_nothing_wrong_with_it(seed: int) -> None:
    rng, possible = random.Random(seed), 0
    for _ in range(25):
        problem, step = problem_of(rng), step_of(rng)
        _, kept = predict(problem, [step])
        told = check(DOMAIN, problem.static, {"T": problem.state}, {"T": [step]})
        wrong = [v for v in told if v.rule not in GOALS]
        assert (kept == 1) == (not wrong), (problem.state, step, wrong)
        possible += kept
    assert possible >= 2
