"""Teams that share robots, for the benchmarks: as published, in the middle of the published run, and drawn."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from random import Random
from typing import NamedTuple

from ops.compile import start
from ops.scenario import load as load_scenario
from reasoning.domain import load
from reasoning.planner import predict
from reasoning.sharing import Known, Ledger
from reasoning.values import Problem, Question, State, Value

DOMAIN = "factory"
STATIC: Mapping[str, Value] = {"width": 5, "height": 3, "line": 5, "delay": 2}
BROKEN_AT = 16
"""The step of the published run in which T4's carrier breaks, while it attaches."""


class Teams(NamedTuple):
    """What a search starts from: each team's problem, answers that it offers, and the steps from which robots on the
    bench can be taken."""

    problems: Mapping[str, Problem]
    offers: Mapping[str, tuple[Known, ...]] = {}
    bench: Mapping[str, int] = {}

    def ledger(self, team: str, lower_bound: int) -> Ledger:
        return Ledger(lower_bound, self.offers.get(team, ()))


def published() -> Teams:
    """The published set-up."""
    states = start(load_scenario(f"{DOMAIN}/four_teams")).states
    return Teams({team: _problem(state) for team, state in states.items()})


def broken_carrier() -> Teams:
    """The published run after T4's carrier has failed to attach, known to be broken: the others are on course and offer
    the rest of their plans, and the robot that T4 was to take two steps later is on the bench."""
    data = json.loads(load(DOMAIN).plans["published"].read_text())
    problems, offers, now = {}, {}, BROKEN_AT + 1
    for team, problem in published().problems.items():
        steps = [tuple(step) for step in data["steps"][team.removeprefix("T")]]
        broken = team == "T4"
        done = [*steps[:BROKEN_AT], tuple(a for a in steps[BROKEN_AT] if not (broken and "c1" in a))]
        state: State = predict(problem, done)[0].states[-1]
        problems[team] = _problem({**state, "broken(c1)": 1} if broken else state)
        if not broken:
            rest = len(steps) - now
            offers[team] = (Known(Question("alone", rest), "yes", rest),)
    return Teams(problems, offers, {"T3.w1": 0})


def drawn(seed: int, count: int) -> Teams:
    """So many teams, every fourth of them with one worker and much to do, which must borrow; the others have two or
    three workers. Where they stand and what they carry is drawn; team n of a seed is the same in every count."""
    problems = {}
    for number in range(1, count + 1):
        random = Random(f"{seed} {number}")
        needy = number % 4 == 1
        workers = 1 if needy else random.choice((2, 3))
        boxes = 3 if needy else random.choice((2, 3)) if workers == 2 else random.choice((3, 4))
        cells = [(x, y) for x in range(1, 6) for y in range(1, 4)]
        places = random.sample(cells, workers)
        problems[f"T{number}"] = team([(place, random.randint(1, 3)) for place in places], boxes)
    return Teams(problems)


def team(workers: Sequence[tuple[tuple[int, int], int]], boxes: int, guest: bool = True) -> Problem:
    """Workers as (cell, effector), a carrier at (1,1), and so many new boxes."""
    state: dict[str, Value] = {"at(c1)": "(1,1)", "attached(c1)": "none"}
    for number, ((x, y), effector) in enumerate(workers, 1):
        state |= {f"at(w{number})": f"({x},{y})", f"effector(w{number})": effector}
    for box in range(1, boxes + 1):
        state |= {f"line({box})": 5 + box, f"stage({box})": 0, f"wet({box})": 0}
    return _problem(state) if guest else Problem(DOMAIN, STATIC, state)


def _problem(state: State) -> Problem:
    """With the next worker's name for a guest."""
    workers = sum(fluent.startswith("effector(") for fluent in state)
    return Problem(DOMAIN, STATIC, state, f"w{workers + 1}")
