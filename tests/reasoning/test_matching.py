"""The matching of lenders and borrowers, against brute force."""

from __future__ import annotations

from itertools import permutations

from hypothesis import given, settings
from hypothesis import strategies as st

from reasoning.matching import match

STEPS = st.integers(0, 8)
LENDERS = st.dictionaries(st.sampled_from(["T1", "T2", "T3"]), STEPS)
BORROWERS = st.dictionaries(st.sampled_from(["T4", "T5", "T6"]), STEPS)
BENCH = st.dictionaries(st.sampled_from(["T7.w1", "T8.w2"]), STEPS)
PAIRS = st.dictionaries(
    st.tuples(st.sampled_from(["T1", "T2", "T3"]), st.sampled_from(["T4", "T5", "T6"])), st.integers(0, 4)
)


@settings(max_examples=150, deadline=None)
@given(LENDERS, BORROWERS, st.integers(0, 4) | PAIRS, BENCH)
def test_a_matching_is_found_if_brute_force_finds_one_and_uses_the_bench_as_much(
    lenders: dict[str, int], borrowers: dict[str, int], delay: int | dict[tuple[str, str], int], bench: dict[str, int]
) -> None:
    def in_time(giver: str, taker: str) -> bool:
        if giver in bench:
            return bench[giver] <= borrowers[taker]
        steps = delay if isinstance(delay, int) else delay.get((giver, taker))
        return steps is not None and lenders[giver] + steps <= borrowers[taker]

    all_ways = [
        dict(zip(borrowers, givers, strict=True))
        for givers in permutations([*lenders, *bench], len(borrowers))
        if all(in_time(giver, taker) for giver, taker in zip(givers, borrowers, strict=True))
    ]
    found = match(lenders, borrowers, delay, bench)
    if found is None:
        assert not all_ways
        return
    assert found in all_ways

    def worth(way: dict[str, str]) -> tuple[int, int]:
        return -sum(giver in bench for giver in way.values()), sum(lenders.get(giver, 0) for giver in way.values())

    assert worth(found) == min(map(worth, all_ways))


def test_many_teams_are_matched_or_refuted_without_trying_all_ways() -> None:
    lenders = {f"T{n}": 5 * n % 13 for n in range(48)}
    assert len(match(lenders, {f"B{n}": 5 + n % 7 for n in range(16)}, 2) or {}) == 16
    late = {name: step if n < 15 else 14 for n, (name, step) in enumerate(sorted(lenders.items()))}
    assert match(late, {f"B{n}": 14 + n % 2 for n in range(16)}, 2) is None


def test_the_published_exchange() -> None:
    assert match({"T2": 11, "T3": 13}, {"T1": 13, "T4": 18}, delay=2) == {"T1": "T2", "T4": "T3"}
    assert match({"T2": 11, "T3": 17}, {"T1": 13, "T4": 18}, delay=2) is None
    assert match({"T2": 11, "T3": 17}, {"T1": 13, "T4": 18}, delay=2, bench={"T9.w1": 18}) == {
        "T1": "T2",
        "T4": "T9.w1",
    }


def test_the_order_of_the_input_makes_no_difference() -> None:
    one = match({"T1": 0, "T2": 0, "T3": 0}, {"T4": 5, "T5": 5}, 1)
    assert one == match({"T3": 0, "T1": 0, "T2": 0}, {"T5": 5, "T4": 5}, 1)


def test_lenders_that_are_alike_serve_in_the_order_wanted_or_by_name() -> None:
    alike = {f"T{n}": 3 for n in range(1, 12)}
    assert match(alike, {"B": 5}, 1) == {"B": "T1"}
    assert match(alike, {"B": 5}, 1, order=["T11", "T2"]) == {"B": "T11"}
    assert match({**alike, "T11": 4}, {"B": 5}, 1, order=["T11", "T2"]) == {"B": "T2"}
    assert match(alike, {"B": 5, "C": 5}, 1, order=["T11", "T2"]) == {"B": "T11", "C": "T2"}


def test_nobody_to_serve_is_served() -> None:
    assert match({}, {}, 2) == {}
    assert match({"T1": 3}, {}, 2) == {}
    assert match({}, {"T1": 3}, 2) is None
