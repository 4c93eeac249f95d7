from __future__ import annotations

import random
from itertools import combinations, count

import pytest

from reasoning.motion.connectivity import Connectivity
from reasoning.motion.layout import Layout
from tests.reasoning.motion.rooms import drawn, lined_up, part_of, rooms_parts

GROWN_M = 0.26  # a robot of 25 cm and the margin
FINE = 2048


def agreement(questions: int, first: int) -> int:
    """Ask one question in each of as many rooms, half of them without a path. Gives how many of the latter are
    between two free points."""
    left = {True: questions // 2, False: questions // 2}
    separated = 0
    seeds = count(first)
    while any(left.values()):
        seed = next(seeds)
        layout = drawn(seed)
        parts = rooms_parts(layout, GROWN_M)
        rng = random.Random(seed)
        points = [(rng.uniform(0.2, layout.width_m - 0.2), rng.uniform(0.2, layout.height_m - 0.2)) for _ in range(8)]
        where = {p: part_of(parts, p) for p in points}
        free = [p for p in points if where[p] is not None]
        wanted = left[True] >= left[False]
        pairs = [(p, q) for p, q in combinations(free, 2) if (where[p] == where[q]) == wanted]
        p, q = pairs[0] if pairs else points[:2]
        expected = where[p] is not None and where[p] == where[q]
        if not left[expected]:
            continue
        got = Connectivity(layout, 0.25).path_exists(p, q)
        if got != expected:
            # Arcs of the second opinion are chords: where that may matter, ask it again with finer ones.
            parts = rooms_parts(layout, GROWN_M, FINE)
            expected = part_of(parts, p) is not None and part_of(parts, p) == part_of(parts, q)
            assert got == expected, (seed, p, q)
        left[expected] -= 1
        separated += not expected and None not in (where[p], where[q])
    return separated


@pytest.mark.slow
def test_connectivity_agrees_with_polygons_in_500_rooms() -> None:
    assert agreement(500, 100_000) > 125  # most are not just points where the robot cannot be


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_connectivity_agrees_with_polygons_in_10_000_rooms() -> None:
    assert agreement(10_000, 0) > 2500


@pytest.mark.parametrize("seed", range(60))
def test_blockers_leave_no_path_and_each_of_them_is_needed(seed: int) -> None:
    layout = lined_up(seed)
    connectivity = Connectivity(layout, 0.25)
    rng = random.Random(seed)
    for _ in range(10):
        p, q = ((rng.uniform(0.2, 7.8), rng.uniform(0.2, 7.8)) for _ in range(2))
        blockers = connectivity.blockers(p, q)
        assert (blockers is None) == connectivity.path_exists(p, q)
        if blockers is None:
            continue
        kept = [layout.discs[i] for i in sorted(blockers)]
        assert not connectivity.with_discs(kept).path_exists(p, q)
        for disc in kept:
            assert connectivity.with_discs([d for d in kept if d is not disc]).path_exists(p, q)


def test_blockers_are_as_few_as_can_be() -> None:
    """A row of six closes the room; in front of it, one closes the passage beside a cupboard."""
    cupboard = ((0.0, 2.0), (3.0, 2.0), (3.0, 2.5), (0.0, 2.5))
    row = [(x, 3.5, 0.1) for x in (0.5, 1.2, 1.9, 2.6, 3.2, 3.6)]
    connectivity = Connectivity(Layout(4, 5, (cupboard,), (*row, (3.4, 2.2, 0.1))), 0.25)
    assert connectivity.blockers((2, 1), (2, 4.5)) == {6}
    assert connectivity.with_discs(row).blockers((2, 1), (2, 4.5)) == {0, 1, 2, 3, 4, 5}
    assert connectivity.with_discs(row[1:]).blockers((2, 1), (2, 4.5)) is None


def test_furniture_alone_is_no_blocker() -> None:
    barrier = ((0.0, 2.0), (4.0, 2.0), (4.0, 2.2), (0.0, 2.2))
    connectivity = Connectivity(Layout(4, 5, (barrier,), ((1.0, 1.0, 0.1),)), 0.25)
    assert connectivity.blockers((2, 1), (2, 4)) == frozenset()
    assert connectivity.blockers((1, 1), (2, 4)) == frozenset()  # a disc stands there, but need not be moved away
    assert connectivity.blockers((1.1, 1), (3, 1)) == {0}


def test_a_gap_as_wide_as_the_disc_with_its_margin_is_a_path() -> None:
    def gap(wide_m: float) -> Connectivity:
        left = ((0.0, 2.0), (2 - wide_m / 2, 2.0), (2 - wide_m / 2, 2.2), (0.0, 2.2))
        right = ((2 + wide_m / 2, 2.0), (4.0, 2.0), (4.0, 2.2), (2 + wide_m / 2, 2.2))
        return Connectivity(Layout(4, 5, (left, right)), 0.25)

    assert gap(0.522).path_exists((2, 1), (2, 4))
    assert not gap(0.518).path_exists((2, 1), (2, 4))


def test_other_discs_are_the_same_as_another_layout() -> None:
    for seed in range(20):
        layout, other = lined_up(seed), lined_up(seed + 1000)
        rng = random.Random(seed)
        moved = Connectivity(layout, 0.25).with_discs(other.discs)
        fresh = Connectivity(Layout(8, 8, layout.polygons, other.discs), 0.25)
        for _ in range(20):
            p, q = ((rng.uniform(0.2, 7.8), rng.uniform(0.2, 7.8)) for _ in range(2))
            assert moved.path_exists(p, q) == fresh.path_exists(p, q)
            assert moved.blockers(p, q) == fresh.blockers(p, q)


@pytest.mark.parametrize(("radius", "margin"), [(-0.1, 0.01), (float("nan"), 0.01), (0.25, 0.0), (0.25, float("inf"))])
def test_a_wrong_radius_or_margin_is_refused(radius: float, margin: float) -> None:
    with pytest.raises(ValueError, match=r"radius|margin"):
        Connectivity(Layout(4, 5), radius, margin)
