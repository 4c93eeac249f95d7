"""Whatever is commanded: nothing crashes, everybody is somewhere, nobody stands inside another."""

from __future__ import annotations

import os
import subprocess
import sys
from copy import deepcopy
from hashlib import sha256
from itertools import combinations, pairwise
from math import dist

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bus.messages import SkillCall
from tests.world.stage import ACTIONS, PERIOD_S, Stage, hand, piece, scene, tug
from world.sensors import sense
from world.truth import Truth

ROBOTS = ["A.h1", "A.h2", "A.h3", "A.t1", "A.t2", "B.h1", "B.h2", "B.t1"]
WORDS = st.sampled_from(
    ["h1", "h2", "h3", "t1", "up", "down", "left", "right", 1, 2, 3, 4, "x", "", -1, "A.h1", "A.h2", "B.h1", "B.h2"]
)
LIKELY = {
    "robot": st.sampled_from(["h1", "h2", "h3", "t1", "t2"]),
    "partner": st.sampled_from(["h1", "h2", "h3", "t1", "t2"]),
    "object": st.sampled_from([1, 2]),
    "direction": st.sampled_from(["up", "down", "left", "right"]),
    "value": st.sampled_from([1, 2, 3]),
    "x": st.just(1),
    "y": st.sampled_from([1, 2, 3]),
}
DETAIL = st.dictionaries(st.sampled_from(["tool", "odd"]), st.sampled_from([1, 2, "x"]), max_size=1)


@st.composite
def calls(draw: st.DrawFn) -> SkillCall:
    name = draw(st.sampled_from([*ACTIONS, *ACTIONS, *ACTIONS, "nothing"]))
    robot = draw(st.sampled_from(ROBOTS))
    detail = {"robot": robot, **draw(DETAIL)} if name == "take" else {}
    if name == "nothing" or draw(st.integers(0, 9)) == 0:
        return SkillCall(name, tuple(draw(st.lists(WORDS, max_size=3))), detail)
    return SkillCall(name, tuple(draw(LIKELY[role]) for role in ACTIONS[name].args), detail)


MISHAPS = st.one_of(
    st.tuples(st.just("break"), st.sampled_from(ROBOTS), st.just({})),
    st.tuples(
        st.just("move"),
        st.sampled_from(ROBOTS),
        st.fixed_dictionaries({"x": st.integers(1, 5), "y": st.integers(1, 3)}),
    ),
    st.tuples(
        st.just("move"), st.sampled_from(["A.1", "A.2", "B.1"]), st.fixed_dictionaries({"to": st.integers(0, 8)})
    ),
    st.tuples(st.just("order"), st.sampled_from("AB"), st.just({"add": 1})),
    st.tuples(st.just("cancel"), st.sampled_from("AB"), st.just({"objects": 1})),
)
STEPS = st.lists(
    st.tuples(st.lists(calls(), max_size=6), st.lists(calls(), max_size=6), st.lists(MISHAPS, max_size=2)), max_size=8
)


@pytest.mark.slow
@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
@given(STEPS)
def test_any_commands(
    story: list[tuple[list[SkillCall], list[SkillCall], list[tuple[str, str, dict[str, int]]]]],
) -> None:
    stage = Stage(
        scene(
            hand("A", "h1", 1, 3),
            hand("A", "h2", 3, 3),
            hand("A", "h3", 1, 1),
            tug("A", "t1", 1, 1),
            tug("A", "t2", 2, 1),
            hand("B", "h1", 1, 2),
            hand("B", "h2", 2, 3),
            tug("B", "t1", 2, 3, holds="h2"),
            piece("A", 1, 3),
            piece("A", 2, 6),
            piece("B", 1, 2),
            teams=2,
        )
    )
    for number, (for_a, for_b, mishaps) in enumerate(story):
        for kind, target, args in mishaps:
            stage.inject(kind, target, **args)
        told = stage.step(number, A=for_a, B=for_b)
        assert set(told) == {"A", "B"}
        check(stage)
    assert stage.now_s == PERIOD_S * len(story)
    left = Truth(stage.scene)
    left.tick = stage.world.truth.tick
    left.restore(deepcopy(stage.world.truth.save()))
    assert left.save() == stage.world.truth.save()
    assert [sense(left, team) for team in "AB"] == [stage.state(team) for team in "AB"]


def check(stage: Stage) -> None:
    robots = stage.events("membership")[-1]["robots"]
    assert sorted(robots) == sorted(ROBOTS)
    named = [tuple(pair) for pair in robots.values()]
    assert len(set(named)) == len(named)
    assert {place for place, _ in named} <= {"A", "B", "bench"}
    sensed = {(team, key[3:-1]) for team in "AB" for key in stage.state(team) if key.startswith("at(")}
    assert sensed == {pair for pair in named if pair[0] != "bench"}
    truth = stage.world.truth
    for team in "AB":
        solid = [thing for thing in truth.of(team) if truth.kind(thing).role == "robot" or truth.line(thing) > 0]
        for a, b in combinations(solid, 2):
            if truth.kind(a).layer == truth.kind(b).layer:
                apart_m = dist(truth.floor.where(a.id), truth.floor.where(b.id))
                assert apart_m > truth.kind(a).radius_m + truth.kind(b).radius_m - 0.01, (a.id, b.id)
        for thing in solid:
            x, y = truth.cell(thing)
            assert truth.kind(thing).track == "line" or truth.layout.in_grid(team, x, y)


def fingerprint() -> str:
    """Everything that a world has said and done in a short life."""
    robots = [hand(team, f"h{i}", i, i % 3 + 1) for team in "AB" for i in (1, 2, 3)]
    stage = Stage(scene(*robots, tug("A", "t1", 1, 2), piece("B", 1, 6), teams=2))
    story = ["give(h1)", "go(h2,left) go(t1,up)", "shift", "go(t1,right) go(h2,up)", "go(h3,down)", "go(t1,down) shift"]
    for number, (a, b) in enumerate(pairwise(story)):
        stage.step(number, A=a, B=b)
    text = repr((stage.world.truth.save(), stage.sent))
    return sha256(text.encode()).hexdigest()


@pytest.mark.slow
def test_a_world_is_the_same_to_the_last_bit_in_every_process() -> None:
    found = {fingerprint(), fingerprint()}
    for seed in ("1", "2"):
        code = "from tests.world.test_random import fingerprint; print(fingerprint())"
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)}
        done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
        found.add(done.stdout.strip())
    assert len(found) == 1
