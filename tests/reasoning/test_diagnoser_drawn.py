"""Diagnoses of drawn runs: the truth is among the least explanations, the published enumeration says the same, and
the size of a team and a run is bearable. Figures are in ``muster bench diagnose``."""

from __future__ import annotations

import time

import pytest

from reasoning.diagnoser import broken_in, diagnose
from reasoning.enumeration import agrees, enumerated
from tests.reasoning.drawn import run


def test_a_seed_gives_the_same_run_and_every_break_has_an_effect() -> None:
    one = run(5, 3, 1, 27, 3)
    assert one == run(5, 3, 1, 27, 3) != run(6, 3, 1, 27, 3)
    assert one.truth == set(one.breaks)
    assert one.case.observed != one.case.before


@pytest.mark.slow
@pytest.mark.parametrize("broken", [0, 1, 2, 3])
def test_four_robots_and_27_steps(broken: int) -> None:
    """A set of fewer robots may explain the same: then it is told, and the truth cannot be."""
    smaller = 0
    for seed in range(8):
        drawn = run(seed, 3, 1, 27, broken)
        begun = time.process_time()
        found = [frozenset(broken_in(d)) for d in diagnose(drawn.case).least]
        assert time.process_time() - begun < 1.0
        if len(found[0]) < broken:
            smaller += 1
        else:
            assert drawn.truth in found
    assert smaller <= 1


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_twenty_robots_and_50_steps(seed: int) -> None:
    drawn = run(seed, 14, 6, 50, 3, size=(12, 6))
    begun = time.process_time()
    found = diagnose(drawn.case).least
    assert time.process_time() - begun < 10.0
    assert drawn.truth in [frozenset(broken_in(d)) for d in found]


@pytest.mark.slow
def test_the_published_enumeration_says_the_same_in_short_runs() -> None:
    for seed in range(4):
        case = run(seed, 2, 1, 4, 1 + seed % 2).case
        assert agrees(case, diagnose(case), enumerated(case)), seed


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_the_published_enumeration_says_the_same(seed: int) -> None:
    case = run(seed, 3, 1, 7, 1 + seed % 3).case
    assert agrees(case, diagnose(case), enumerated(case))


def test_an_enumeration_that_was_stopped_agrees_with_nothing() -> None:
    case = run(0, 3, 1, 9, 2).case
    stopped = enumerated(case, calls=3)
    assert (stopped.calls, stopped.finished, stopped.executed) == (3, False, {})
    assert not agrees(case, diagnose(case), stopped)
