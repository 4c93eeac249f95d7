"""Diagnoses: the published examples, every shipped case, and brute force over who may have broken when."""

from __future__ import annotations

import time
from collections.abc import Mapping
from itertools import combinations, product
from math import prod

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ops.cases import read_case, shipped_cases
from reasoning.diagnoser import broken_in, diagnose, explain, inspection_order
from reasoning.values import Case, Diagnosis, State, Step
from tests.reasoning import published
from tests.reasoning.simulator import needed, outcome

SETUP, STEPS = published.load()
SIZE = (5, 3)


def case_of(team: str, steps: list[Step], breaks: Mapping[str, int], bound: int = 2, **changed: int | str) -> Case:
    """The team's published steps (or others) from the start, seen after these breaks."""
    observed = {**outcome(SIZE, SETUP.states[team], steps, breaks)[0], **{_fluent(k): v for k, v in changed.items()}}
    return Case(published.DOMAIN, SETUP.static, SETUP.states[team], tuple(steps), observed, bound)


def _fluent(keyword: str) -> str:
    name, _, body = keyword.partition("_")
    return f"{name}({body})"


def causes(case: Case) -> list[tuple[str, ...]]:
    return [d.causes for d in diagnose(case).diagnoses]


@pytest.mark.parametrize("name", shipped_cases())
def test_every_shipped_case_comes_out_as_it_says(name: str) -> None:
    shipped = read_case(name)
    result = diagnose(shipped.case, shipped.rates)
    expected = shipped.expected
    assert expected is not None
    assert tuple(d.causes for d in result.diagnoses) == expected.diagnoses
    assert (result.executed, result.inspect) == (expected.executed, expected.inspect)
    assert result.probabilities == pytest.approx(expected.probabilities, abs=0.01)
    commanded = {action for step in shipped.case.actions for action in step}
    for diagnosis in result.diagnoses:
        happened = {action for step in diagnosis.happened for action in step}
        assert commanded - happened == set(expected.did_not_happen)
        assert {c: d for c, d in diagnosis.since.items() if c in expected.since} == {
            c: d for c, d in expected.since.items() if c in diagnosis.causes
        }


def test_the_published_run_blames_the_carrier_and_clears_the_worker() -> None:
    result = diagnose(case_of("T4", STEPS["T4"][:17], {"c1": 16}))
    assert [d.causes for d in result.diagnoses] == [("broken(c1)",)]
    assert result.diagnoses[0].since == {"broken(c1)": (16,)}
    assert result.diagnoses[0].happened[16] == ("workOn(w1,1)",)
    assert (result.executed, result.inspect) == (16, ())


def test_nothing_is_wrong_when_all_is_as_commanded() -> None:
    result = diagnose(case_of("T4", STEPS["T4"][:10], {}))
    assert result.diagnoses == (Diagnosis((), {}, tuple(STEPS["T4"][:10])),)
    assert result.executed == 10


def test_no_more_robots_are_suspected_than_the_bound_allows() -> None:
    step: list[Step] = [("move(w1,right)", "move(w2,right)", "move(c1,right)")]
    both = case_of("T2", step, {"w1": 0, "w2": 0})
    assert causes(both) == [("broken(w1)", "broken(w2)")]
    one = case_of("T2", step, {"w1": 0, "w2": 0}, bound=1)
    assert all(len([c for c in found if c.startswith("broken")]) <= 1 for found in causes(one))
    assert causes(one)


def test_a_person_who_moves_a_robot_before_it_works_is_one_cause() -> None:
    steps = STEPS["T4"][:4]
    case = case_of("T4", [*steps, ("workOn(w1,3)",)], {"w1": 4}, at_w1="(1,2)")
    assert causes(case) == [("moved(w1)",)]


def test_persons_are_blamed_only_when_broken_robots_explain_nothing() -> None:
    assert causes(case_of("T4", [("move(w1,right)",)], {}, at_w1="(1,3)")) == [("broken(w1)",)]
    assert causes(case_of("T4", [("move(w1,right)",)], {}, at_w1="(3,3)")) == [("moved(w1)",)]
    assert causes(case_of("T4", [("lineShift",)], {}, line_2=3)) == [("changed(2)",)]
    assert causes(case_of("T4", [("lineShift",)], {}, stage_1=2)) == [("changed(1)",)]
    assert causes(case_of("T4", [()], {}, effector_w1=3)) == [("changed(w1)",)]
    assert causes(case_of("T4", [()], {}, attached_c1="w1")) == [("changed(c1)",)]
    assert causes(case_of("T4", [()], {}, at_c1="none")) == [("moved(c1)",)]


def test_robots_that_should_not_be_there_or_should() -> None:
    give: list[Step] = [("giveRobot(w1)",)]
    start = SETUP.states["T4"]
    gone = {f: v for f, v in start.items() if "w1" not in f}
    assert causes(case_of("T4", give, {"w1": 0})) == [("broken(w1)",)]
    assert causes(Case("factory", SETUP.static, start, ((),), gone)) == [("gone(w1)",)]
    take: list[Step] = [("takeRobot(w2,1,2)",)]
    assert causes(Case("factory", SETUP.static, start, tuple(take), start)) == [("missing(w2)",)]
    arrived = {**start, "at(w2)": "(1,2)", "effector(w2)": 2}
    assert causes(Case("factory", SETUP.static, start, tuple(take), arrived)) == [()]


def test_a_repaired_robot_may_break_again_and_only_since_then() -> None:
    steps: list[Step] = [(), ("repair(c1)",), (), ("move(c1,right)",)]
    before = {**SETUP.states["T4"], "broken(c1)": 1}
    result = diagnose(Case("factory", SETUP.static, before, tuple(steps), SETUP.states["T4"]))
    assert [(d.causes, d.since) for d in result.diagnoses] == [(("broken(c1)",), {"broken(c1)": (2, 3)})]


def test_an_observation_without_steps_is_explained_too() -> None:
    start = SETUP.states["T4"]
    assert causes(Case("factory", SETUP.static, start, (), {**start, "at(w1)": "(4,3)"})) == [("moved(w1)",)]


def test_inspections_narrow_and_are_ordered_by_how_many_explanations_they_touch() -> None:
    diagnoses = tuple(Diagnosis(tuple(f"broken({r})" for r in robots), {}, ()) for robots in ("a", "bc", "bd"))
    assert inspection_order(map(broken_in, diagnoses)) == ("b", "a", "c", "d")
    assert inspection_order(["ab", "ac"]) == ("b", "c")
    assert inspection_order([]) == inspection_order(["a"]) == ()
    assert [broken_in(d) for d in explain(diagnoses, {"b": "broken"})] == [("b", "c"), ("b", "d")]
    assert [broken_in(d) for d in explain(diagnoses, {"b": "broken", "c": "sound"})] == [("b", "d")]
    assert explain(diagnoses, {"a": "sound", "b": "sound"}) == ()


def test_four_robots_and_a_whole_run_take_less_than_a_second() -> None:
    case = case_of("T2", STEPS["T2"][:26], {"c1": 25, "w2": 24}, bound=3)
    begun = time.process_time()
    assert causes(case)
    assert time.process_time() - begun < 1.0


def test_what_the_preference_drops_is_told_as_set_aside() -> None:
    result = diagnose(read_case("factory/push_did_not_happen").case)
    assert [d.causes for d in result.diagnoses] == [("broken(c1)",)]
    assert [d.causes for d in result.set_aside] == [("broken(w3)",)]
    assert [d.causes for d in result.least] == [("broken(c1)",), ("broken(w3)",)]


def test_an_explanation_is_found_even_when_its_ways_are_too_many(monkeypatch: pytest.MonkeyPatch) -> None:
    case = read_case("factory/three_pairs").case
    monkeypatch.setattr("reasoning.diagnoser.WAYS", 3)
    assert len(diagnose(case).least) == 8


@pytest.mark.parametrize("rates", [{"c1": 0.0}, {"c1": 1.0}, {"c1": -0.1}, {"c1": float("nan")}, {"c1. bad": 0.1}])
def test_rates_are_between_0_and_1(rates: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="rates"):
        diagnose(read_case("factory/push_did_not_happen").case, rates)


def test_a_robot_without_a_rate_has_the_mean_of_the_others() -> None:
    case = read_case("factory/carrier_or_worker").case
    assert diagnose(case, {"c1": 0.1, "w9": 0.3}) == diagnose(case, {"c1": 0.1, "w9": 0.3, "w1": 0.2})


def test_rates_do_not_matter_to_what_persons_did() -> None:
    shipped = read_case("factory/robot_moved")
    result = diagnose(shipped.case, {"w1": 0.1})
    assert [d.causes for d in result.diagnoses] == [("moved(w1)",)]
    assert result.probabilities == (1.0,)


# ---------------------------------------------------------------- against brute force
def by_force(team: str, steps: list[Step], observed: State, bound: int) -> set[tuple[str, ...]]:
    """Every set of at most `bound` robots and every time of each break, simulated; the best grade of the least size."""
    robots = sorted({robot for step in steps for action in step for robot in needed(action)})
    for size in range(bound + 1):
        graded: dict[tuple[int, int], set[tuple[str, ...]]] = {}
        for suspects in combinations(robots, size):
            for times in product(range(len(steps)), repeat=size):
                breaks = dict(zip(suspects, times, strict=True))
                state, done = outcome(SIZE, SETUP.states[team], steps, breaks)
                if state == observed:
                    graded.setdefault(grade(steps, done, breaks), set()).add(tuple(f"broken({r})" for r in suspects))
        if graded:
            return graded[max(graded)]
    return set()


def grade(steps: list[Step], done: list[list[str]], breaks: Mapping[str, int]) -> tuple[int, int]:
    """First step with a failure, and first step with a failure of whole robots; later is better."""
    failed = [(t, a) for t, step in enumerate(steps) for a in step if a not in done[t]]
    puzzling = [t for t, a in failed if not any(breaks.get(robot, len(steps)) <= t for robot in needed(a))]
    return min((t for t, _ in failed), default=len(steps)), min(puzzling, default=len(steps))


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(st.data())
def test_diagnoses_are_those_of_brute_force(data: st.DataObject) -> None:
    team = data.draw(st.sampled_from(sorted(STEPS)))
    steps = STEPS[team][: data.draw(st.integers(1, 12))]
    robots = sorted({robot for step in steps for action in step for robot in needed(action)} or {"w1"})
    breaks = data.draw(st.dictionaries(st.sampled_from(robots), st.integers(0, len(steps) - 1), max_size=2))
    case = case_of(team, list(steps), breaks)
    assert set(causes(case)) == by_force(team, list(steps), case.observed, case.bound)


def odds_by_force(
    team: str, steps: list[Step], observed: State, rates: Mapping[str, float]
) -> dict[frozenset[str], float]:
    """The chances of all least sets of broken robots: every break in every step, simulated."""
    robots = sorted({robot for step in steps for action in step for robot in needed(action)})
    for size in range(3):
        odds: dict[frozenset[str], float] = {}
        for broken in combinations(robots, size):
            for times in product(range(len(steps)), repeat=size):
                breaks = dict(zip(broken, times, strict=True))
                if outcome(SIZE, SETUP.states[team], steps, breaks)[0] == observed:
                    chance = prod(rates[r] * (1 - rates[r]) ** t for r, t in breaks.items())
                    chance *= prod((1 - rates[r]) ** len(steps) for r in robots if r not in broken)
                    odds[frozenset(broken)] = odds.get(frozenset(broken), 0.0) + chance
        if odds:
            return {broken: chance / sum(odds.values()) for broken, chance in odds.items()}
    return {}


PUZZLING = [
    ("T2", 2, {"c1": 1}, 2),
    ("T2", 6, {"w2": 2}, 3),
    ("T2", 8, {"c1": 1}, 2),
    ("T2", 8, {"w2": 6}, 2),
    ("T3", 8, {"c1": 6}, 2),
    ("T2", 3, {"c1": 1, "w1": 2}, 2),
]
"""So many steps of a team, with these breaks, have so many explanations: of drawn breaks few have more than one."""


@pytest.mark.parametrize(("team", "length", "breaks", "count"), PUZZLING)
@settings(max_examples=3, deadline=None)
@given(data=st.data())
def test_probabilities_are_those_of_brute_force(
    team: str, length: int, breaks: dict[str, int], count: int, data: st.DataObject
) -> None:
    steps = list(STEPS[team][:length])
    robots = sorted({robot for step in steps for action in step for robot in needed(action)})
    rates = {robot: data.draw(st.floats(0.001, 0.5)) for robot in robots}
    case = case_of(team, steps, breaks)
    result = diagnose(case, rates)
    told = {frozenset(broken_in(d)): chance for d, chance in zip(result.diagnoses, result.probabilities, strict=True)}
    assert len(told) == count
    assert told == pytest.approx(odds_by_force(team, steps, case.observed, rates), rel=0.005, abs=1e-5)


def test_what_happened_is_told_by_the_latest_break_or_with_rates_by_the_most_probable_one() -> None:
    """A worker that is where it began was broken all the time, or since it came back."""
    steps: list[Step] = [("move(w1,right)",), ("move(w1,left)",), ("move(w1,right)",)]
    case = case_of("T2", steps, {"w1": 0})
    ((latest,), (likely,)) = (diagnose(case, rates).diagnoses for rates in (None, {"w1": 0.5}))
    assert latest.causes == likely.causes == ("broken(w1)",)
    assert (latest.since, likely.since) == ({"broken(w1)": (2,)}, {"broken(w1)": (0, 2)})
    assert latest.happened == (*steps[:2], ())
    assert likely.happened == ((), (), ())
