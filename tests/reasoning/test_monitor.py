"""What differs between what was predicted and what is seen, and whose coming and going it is."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from reasoning.monitor import appeared, differing, vanished

BEFORE = {"at(w1)": "(1,3)", "effector(w1)": 1, "line(1)": 2, "stage(1)": 0}


def test_equal_states_do_not_differ_and_what_is_not_sensed_is_not_compared() -> None:
    assert differing({**BEFORE, "broken(w1)": 1}, BEFORE) == ()


def test_values_and_missing_fluents_differ() -> None:
    observed = {"at(w1)": "(2,3)", "effector(w1)": 1, "line(1)": 2, "wet(1)": 1}
    assert differing(BEFORE, observed) == ("at(w1)", "stage(1)", "wet(1)")


def test_a_grown_order_appears_and_a_cancelled_one_vanishes() -> None:
    grown = {**BEFORE, "line(2)": 7, "stage(2)": 0}
    assert appeared(BEFORE, grown, BEFORE) == ("line(2)", "stage(2)")
    assert vanished(grown, BEFORE, grown) == ("line(2)", "stage(2)")
    assert vanished(BEFORE, grown) == appeared(grown, BEFORE) == ()


def test_a_robot_that_did_not_leave_or_arrive_is_nothing_new() -> None:
    left = {fluent: value for fluent, value in BEFORE.items() if "w1" not in fluent}
    assert appeared(left, BEFORE, BEFORE) == ()
    assert vanished(BEFORE, left, left) == ()
    assert appeared(left, BEFORE) == ("at(w1)", "effector(w1)")


def test_a_fluent_that_is_about_no_body_neither_appears_nor_vanishes() -> None:
    assert appeared({"elapsed": 3}, {"elapsed": 4}) == vanished({"elapsed": 3}, {}) == ()


FLUENTS = st.sampled_from(["at(w1)", "at(w2)", "line(1)", "stage(1)", "attached(c1)", "broken(w1)"])
STATES = st.dictionaries(FLUENTS, st.integers(0, 2))


@given(STATES, STATES)
def test_differing_is_symmetric_sorted_and_covers_who_came_and_went(one: dict[str, int], other: dict[str, int]) -> None:
    found = differing(one, other)
    assert found == differing(other, one) == tuple(sorted(found))
    assert {*appeared(one, other), *vanished(one, other)} - {"broken(w1)"} <= set(found)
