from __future__ import annotations

from collections import Counter

import pytest

from bus import impair
from bus.impair import Fate, Impairments
from bus.messages import Impair


def fates(impair: Impair, count: int = 1000) -> list[Fate]:
    impairments = Impairments()
    impairments.set(impair)
    return [impairments.fate("T1", f"T2.1.{number}") for number in range(count)]


def test_without_impairment_everything_arrives_once() -> None:
    assert Impairments().fate("T1", "x") == Fate(now=1, later=0)


def test_shares_are_as_asked() -> None:
    counts = Counter(fates(Impair(drop=0.2, repeat=0.25, late=0.5, late_s=2.0, seed=3)))
    dropped = counts[Fate(now=0)]
    late = sum(count for fate, count in counts.items() if fate.later)
    twice = sum(count for fate, count in counts.items() if fate.now + fate.later == 2)
    assert 150 < dropped < 250
    assert 330 < late < 470
    assert 140 < twice < 260
    assert all(fate.late_s == 2.0 for fate in counts if fate.later)


def test_fate_hangs_on_seed_id_and_attempt_alone() -> None:
    impair = Impair(drop=0.5, seed=1)
    assert fates(impair) == fates(impair)
    assert fates(impair) != fates(Impair(drop=0.5, seed=2))
    forwards, backwards = Impairments(), Impairments()
    forwards.set(impair)
    backwards.set(impair)
    names = [f"T2.1.{number}" for number in range(100)]
    ahead = {name: forwards.fate("T1", name) for name in names}
    assert ahead == {name: backwards.fate("T1", name) for name in reversed(names)}


def test_another_attempt_gets_another_chance() -> None:
    impairments = Impairments()
    impairments.set(Impair(drop=0.5))
    assert {impairments.fate("T1", "same").now for _ in range(50)} == {0, 1}


def test_a_receiver_of_its_own_goes_before_everybody() -> None:
    impairments = Impairments()
    impairments.set(Impair("*", drop=1.0))
    impairments.set(Impair("T1", repeat=1.0))
    assert impairments.fate("T1", "x") == Fate(now=2)
    assert impairments.fate("T2", "x") == Fate(now=0)
    impairments.set(Impair("T1"))
    assert impairments.fate("T1", "x") == Fate(now=0), "ended: what counts for everybody counts again"
    impairments.set(Impair("*"))
    assert impairments.fate("T1", "x") == Fate(now=1)


def test_a_long_run_on_a_bad_link_does_not_eat_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(impair, "REMEMBERED", 100)
    impairments = Impairments()
    impairments.set(Impair(drop=0.5))
    first = [impairments.fate("T1", "late").now for _ in range(3)]
    for number in range(1000):
        impairments.fate("T1", f"T2.1.{number}")
        if number % 40 == 0:
            first.append(impairments.fate("T1", "late").now)
    assert len(impairments._sent) <= 100
    whole = Impairments()
    whole.set(Impair(drop=0.5))
    assert first == [whole.fate("T1", "late").now for _ in first], "who is sent again and again is not forgotten"
