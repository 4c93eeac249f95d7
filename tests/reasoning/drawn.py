"""Drawn runs: robots that wander and work at random but legally, some of which break; judged by the simulator alone.

A seed gives one run, the same on every machine. `Run.truth` are the broken robots that had an effect: the smallest
part of the drawn breaks that leads to what is seen. A robot that broke and was not used since, or only for what was
impossible already, has none, and nobody can tell. `run` draws until every break has an effect.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from itertools import combinations
from random import Random

from reasoning.values import Case, State, Step
from tests.reasoning.simulator import Cell, Floor, Judge, needed, outcome

DOMAIN = "factory"


@dataclass(frozen=True)
class Run:
    """`breaks[robot]` is the step from which a robot was broken; `drawn` how many draws it took."""

    case: Case
    breaks: Mapping[str, int]
    truth: frozenset[str]
    drawn: int = 1


def run(seed: int, workers: int, carriers: int, steps: int, broken: int, *, size: Cell = (5, 3)) -> Run:
    """A run with so many robots on a floor of this size in which exactly `broken` breaks had an effect."""
    random, drawn = Random(seed), 0
    while True:
        drawn += 1
        start = _start(random, workers, carriers, size)
        plan = tuple(_walk(random, start, size, steps))
        robots = sorted({robot for step in plan for action in step for robot in needed(action)})
        if len(robots) < broken:
            continue
        breaks = {robot: random.randrange(steps) for robot in random.sample(robots, broken)}
        seen = outcome(size, start, plan, breaks)[0]
        if len(truth := effective(size, start, plan, breaks, seen)) == broken:
            static = {"width": size[0], "height": size[1], "line": size[0]}
            return Run(Case(DOMAIN, static, start, plan, seen, max(broken, 1)), breaks, truth, drawn)


def effective(size: Cell, start: State, plan: Sequence[Step], breaks: Mapping[str, int], seen: State) -> frozenset[str]:
    """The smallest part of the breaks with the same outcome."""
    for count in range(len(breaks) + 1):
        for part in combinations(sorted(breaks), count):
            if outcome(size, start, plan, {robot: breaks[robot] for robot in part})[0] == seen:
                return frozenset(part)
    raise AssertionError("all of the breaks have the outcome of all of the breaks")


def _start(random: Random, workers: int, carriers: int, size: Cell) -> State:
    cells = [(x, y) for x in range(1, size[0] + 1) for y in range(1, size[1] + 1)]
    floor = Floor(workers={f"w{n}" for n in range(1, workers + 1)})
    for worker, cell in zip(sorted(floor.workers), random.sample(cells, workers), strict=True):
        floor.at[worker], floor.effector[worker] = cell, random.randint(1, 3)
    for number in range(1, carriers + 1):
        floor.at[f"c{number}"], floor.attached[f"c{number}"] = random.choice(cells), "none"
    for box in range(1, max(workers, 3) + 1):
        floor.line[box], floor.stage[box] = box + size[0] // 2, random.randint(0, 1)
    return floor.state()


def _walk(random: Random, start: State, size: Cell, steps: int) -> Iterator[Step]:
    """Each robot tries one thing at random a step; what the simulator finds wrong is left out, until nothing is."""
    referee, now = Judge(size, 0, None, {}), _floor(start)
    for time in range(steps):
        wanted = [action for robot in sorted(now.at) if (action := _wish(random, now, robot))]
        if random.random() < 0.1:
            wanted = [a for a in wanted if not a.startswith("workOn")] + ["lineShift"]
        while True:
            trial = deepcopy(now)
            done = referee.step("", trial, time, tuple(wanted))
            if set(done) == set(wanted):
                break
            wrong = {action for _, _, action, _ in referee.found} - {""}
            wanted = [a for a in wanted if a not in wrong] if wrong else []
            referee.found.clear()
        referee.found.clear()
        now = trial
        yield tuple(sorted(wanted))


def _wish(random: Random, now: Floor, robot: str) -> str:
    """Something that this robot may be able to do; nothing in one case of four."""
    x, y = now.at[robot]
    if random.random() < 0.25:
        return ""
    if robot in now.attached:
        partner = now.attached[robot]
        if partner != "none":
            return random.choice([f"detach({robot})", f"push({robot})", f"pull({robot})"])
        here = [w for w in sorted(now.workers) if now.at[w] == (x, y) and not now.tied(w)]
        if here:
            return f"attach({robot},{here[0]})"
        return f"move({robot},{random.choice(['left', 'right', 'up', 'down'])})"
    fitting = [b for b, place in now.line.items() if place == x and now.stage[b] + 1 == now.effector[robot]]
    if fitting and x > 1:
        return f"workOn({robot},{fitting[0]})"
    if x == 1 and random.random() < 0.3:
        return f"swapEndEffector({robot},{random.choice([e for e in (1, 2, 3) if e != now.effector[robot]])})"
    return f"move({robot},{random.choice(['left', 'right'])})"


def _floor(start: State) -> Floor:
    from tests.reasoning.simulator import floor

    return floor(start, ())
