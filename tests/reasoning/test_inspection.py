"""Inspections: the tree is the best there is, ends in every explanation, and beats looking about at random."""

from __future__ import annotations

from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoning import inspection
from reasoning.diagnoser import broken_in, diagnose, explain, inspection_order
from reasoning.inspection import Inspect, Settled, Tree, arbitrary, order, tree
from reasoning.values import Diagnosis
from tests.reasoning.drawn import run
from tests.reasoning.simulator import needed

SETS = st.lists(st.frozensets(st.sampled_from("abcde"), max_size=4), min_size=1, max_size=6, unique=True)


def ends(inspections: Tree) -> list[Settled]:
    if isinstance(inspections, Settled):
        return [inspections]
    return [*ends(inspections.if_broken), *ends(inspections.if_sound)]


def fewest(sets: list[frozenset[str]], weights: list[float]) -> float:
    """Every tree: the expected number of inspections, times the weight of these sets."""
    if len(sets) == 1:
        return 0.0
    costs = []
    for robot in set().union(*sets):
        parts = [[n for n, robots in enumerate(sets) if (robot in robots) is found] for found in (True, False)]
        if all(parts):
            after = sum(fewest([sets[n] for n in part], [weights[n] for n in part]) for part in parts)
            costs.append(sum(weights) + after)
    return min(costs)


@given(SETS, st.data())
def test_the_tree_is_the_best_and_ends_in_every_explanation(sets: list[frozenset[str]], data: st.DataObject) -> None:
    weights = [data.draw(st.floats(0.01, 1.0)) for _ in sets]
    made = tree([sorted(robots) for robots in sets], weights)
    assert made.expected == pytest.approx(fewest(sets, weights) / sum(weights))
    assert sorted(end.broken for end in ends(made)) == sorted(tuple(sorted(robots)) for robots in sets)
    assert sum(end.chance for end in ends(made)) == pytest.approx(1.0)
    first = order([sorted(robots) for robots in sets], weights)
    assert bool(first) == isinstance(made, Inspect)


@given(SETS)
def test_no_order_is_worse_than_the_tree(sets: list[frozenset[str]]) -> None:
    suspected = [sorted(robots) for robots in sets]
    assert tree(suspected).expected <= arbitrary(suspected) + 1e-9
    assert arbitrary(suspected) <= arbitrary(suspected, among=9)


def test_the_greedy_choice_ends_in_every_explanation_too(monkeypatch: pytest.MonkeyPatch) -> None:
    suspected = [f"{a}{b}" for a in "abcdef" for b in "uvwxyz"]
    best = tree(suspected).expected
    monkeypatch.setattr(inspection, "EXACT_SETS", 1)
    monkeypatch.setattr(inspection, "EXACT_ROBOTS", 1)
    greedy = tree(suspected)
    assert len(ends(greedy)) == len(suspected)
    assert best <= greedy.expected <= 1.2 * best


def test_a_hundred_explanations_do_not_take_long() -> None:
    suspected = [f"{a}{b}" for a in "abcdefghij" for b in "qrstuvwxyz"]
    assert len(ends(tree(suspected))) == 100
    assert tree(suspected).expected < arbitrary(suspected)


def test_the_probable_is_inspected_first() -> None:
    assert order(["a", "b", "c"], [0.1, 0.2, 0.7])[0] == "c"
    unlikely = tree(["a", "b", "c"], [0.1, 0.2, 0.7])
    assert unlikely.expected == pytest.approx(0.7 * 1 + 0.3 * 2)


def test_nothing_to_tell_apart() -> None:
    assert tree(["ab"]) == Settled(("a", "b"), 1.0)
    assert order(["ab"]) == order(["ab", "ba"]) == order([]) == ()
    assert arbitrary(["ab"]) == 0.0
    with pytest.raises(ValueError, match="no explanations"):
        tree([])


def by_hand(suspected: list[str], among: str) -> float:
    """All orders of these robots, one by one."""
    total, orders = 0, list(permutations(among))
    for turns in orders:
        for truth in suspected:
            left = list(suspected)
            for robot in turns:
                if len(left) == 1:
                    break
                total += 1
                left = [robots for robots in left if (robot in robots) == (robot in truth)]
    return total / len(orders) / len(suspected)


@pytest.mark.parametrize("suspected", [["a", "b"], ["ab", "ac", "bd"], ["a", "bc", "bd", "d"]])
def test_an_arbitrary_order_is_the_mean_of_all_orders(suspected: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    useful = "".join(order(suspected))
    assert arbitrary(suspected) == pytest.approx(by_hand(suspected, useful))
    assert arbitrary(suspected, among=6) == pytest.approx(by_hand(suspected, useful + "uvwxyz"[: 6 - len(useful)]))
    monkeypatch.setattr(inspection, "SUBSETS_ROBOTS", 0)
    assert arbitrary(suspected) == pytest.approx(by_hand(suspected, useful), rel=0.1)


@pytest.mark.slow
def test_on_drawn_runs_three_of_five_inspections_are_enough() -> None:
    """Against a person who knows the explanations, but inspects the team's robots in any order until one is left."""
    ours = theirs = 0.0
    for seed in range(25):
        case = run(seed, 5, 3, 16, 3, size=(6, 3)).case
        suspected = [broken_in(d) for d in diagnose(case).least]
        robots = {robot for step in case.actions for action in step for robot in needed(action)}
        ours += tree(suspected).expected
        theirs += arbitrary(suspected, among=len(robots))
    assert 0 < ours <= 0.6 * theirs


@pytest.mark.parametrize("suspected", [["ab", "ac", "bd"], ["a", "bc", "bd", "d", "abc"], ["ab", "cd", "ef", "ace"]])
def test_one_inspection_after_the_other_is_the_tree(suspected: list[str]) -> None:
    """As a team goes about it: inspect the first of the order, drop what disagrees, ask for the order again."""
    explanations = [Diagnosis(tuple(f"broken({robot})" for robot in robots), {}, ()) for robots in suspected]
    inspected = 0
    for truth in explanations:
        left = tuple(explanations)
        while ranked := inspection_order(map(broken_in, left)):
            finding = "broken" if ranked[0] in broken_in(truth) else "sound"
            left = explain(left, {ranked[0]: finding})
            inspected += 1
        assert left == (truth,)
    assert inspected / len(explanations) == pytest.approx(tree(suspected).expected)
