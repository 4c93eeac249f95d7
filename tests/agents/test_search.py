"""The coordinator's knowledge during one search."""

from __future__ import annotations

import random
from typing import Literal

import pytest

from agents.search import Search
from bus import messages as m
from bus.messages import Handover
from reasoning.sharing import Asking, Loan, Shared
from reasoning.values import Question


def standing(team: str, **more: object) -> m.Standing:
    return m.Standing(1, team, 5, False, **{"lower_bound": 2, **more})  # type: ignore[arg-type]


def test_robots_on_the_bench_are_those_given_and_not_taken_since() -> None:
    """T2.w1 went to and fro and waits again; T2.w2 is with T1; T2.w3 was given just now."""
    gave = (Handover("T2.w1", 0), Handover("T2.w2", 1), Handover("T2.w3", 4))
    borrower = standing("T1", took=(Handover("T2.w1", 2), Handover("T2.w2", 3)), gave=(Handover("T2.w1", 3),))
    search = Search({"T1": borrower, "T2": standing("T2", gave=gave)}, delay=2, start=5)
    assert search.given == {"T2.w1": 3, "T2.w3": 4}


def test_a_robot_on_its_way_to_the_bench_can_be_taken_when_it_has_arrived() -> None:
    needy = standing("T1", hopeless="nobody to work", lower_bound=3)
    search = Search({"T1": needy, "T2": standing("T2", gave=(Handover("T2.w1", 4),))}, delay=3, start=5)
    while isinstance(asked := search.next(), Asking):
        for team, q in asked.questions.items():
            # T1 must have its robot by step 2. It was given in step 4, is three steps under way, and now is step 5.
            able = q.within >= 6 and (team == "T2" or q.step <= 2)
            answer = m.Answer(1, m.Question(*q), "yes" if able else "no", q.within if able else 0, q.step)
            search.learn(team, answer)
    assert (asked.status, asked.makespan) == ("optimal", 6)
    assert asked.loans == (Loan("T2.w1", "T1"),)


def test_the_offer_of_a_team_on_course_is_its_first_answer() -> None:
    """A shared plan and its proof, without a single question."""
    offer = m.Offer(m.Question("alone", 4), (m.Question("alone", 3),))
    result = Search({"T1": standing("T1", offer=offer)}, delay=2, start=5).next()
    assert isinstance(result, Shared)
    assert (result.status, result.makespan, result.lower_bound) == ("optimal", 4, 4)


def test_an_offer_to_lend_is_asked_about_when_nobody_borrows() -> None:
    """The borrower is out of contact. What the lender can do alone does not follow from its plan to lend."""
    search = Search({"T2": standing("T2", offer=m.Offer(m.Question("lend", 5, 0)))}, delay=1, start=5)
    asked = search.next()
    assert isinstance(asked, Asking)
    assert asked.questions["T2"].kind == "alone"
    while isinstance(asked, Asking):
        q = asked.questions["T2"]
        search.learn("T2", m.Answer(1, m.Question(*q), "yes" if q.within >= 3 else "no", max(3, 0)))
        asked = search.next()
    assert (asked.status, asked.makespan, asked.roles["T2"]) == ("optimal", 3, Question("alone", 3))


def test_who_has_no_hope_is_told_with_its_reason() -> None:
    search = Search({"T1": standing("T1", hopeless="no worker", hopeless_with_guest="no line")}, delay=2, start=5)
    result = search.next()
    assert isinstance(result, Shared)
    assert result.status == "infeasible"
    assert search.hopeless() == ["T1: no worker"]


def test_a_single_team_has_nobody_to_borrow_from_unless_a_robot_waits_on_the_bench() -> None:
    alone = standing("T1", hopeless="no worker")
    result = Search({"T1": alone}, delay=2, start=5).next()
    assert isinstance(result, Shared)
    assert result.status == "infeasible"
    search = Search({"T1": standing("T1", hopeless="no worker", gave=(Handover("T1.w1", 0),))}, delay=2, start=5)
    asked = search.next()
    assert isinstance(asked, Asking)
    while isinstance(asked, Asking):
        (q,) = asked.questions.values()
        yes = q.within >= 4 and q.step <= q.within - 4
        search.learn("T1", m.Answer(1, m.Question(*q), "yes" if yes else "no", q.within, q.within - 4))
        asked = search.next()
    assert (asked.makespan, asked.loans) == (4, (Loan("T1.w1", "T1"),))


@pytest.mark.slow
def test_a_bound_that_was_shown_never_falls_during_a_search() -> None:
    """Answers that leave a question open can send the search back to a horizon below one that was refuted."""
    fell = [seed for seed in range(30, 48) if (shown := bounds(random.Random(seed))) != sorted(shown)]
    assert not fell


def bounds(dice: random.Random) -> list[int]:
    """The bounds shown while drawn teams answer one at a time, some of them that they do not know."""
    names = [f"T{n}" for n in range(dice.randint(2, 5))]
    alone = {name: dice.randint(0, 16) for name in names}
    exchange = {name: sorted(dice.randint(0, 9) for _ in range(20)) for name in names}  # by horizon
    search = Search({name: standing(name) for name in names}, delay=2, start=5)
    shown: list[int] = []
    while isinstance(asked := search.next(), Asking):
        shown.append(search.bound)
        team, q = dice.choice(sorted(asked.questions.items()))
        able = q.within >= alone[team] if q.kind != "borrow" else True
        at = exchange[team][min(q.within, 19)]
        able = able and {"alone": True, "lend": 9 - at <= q.step, "borrow": at >= q.step}[q.kind]
        verdict: Literal["yes", "no", "unknown"] = "yes" if able else "no"
        verdict = verdict if dice.random() > 0.15 else "unknown"
        search.learn(team, m.Answer(1, m.Question(*q), verdict, q.within * able, q.step * able))
    return [*shown, search.bound]
