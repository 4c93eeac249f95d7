"""Sharing without the published limits against exhaustive search, over drawn teams with hidden, monotone abilities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoning.exchanges import advance
from reasoning.horizons import Asking, Shared
from reasoning.ledger import Known, Ledger
from reasoning.loans import Market, Waiting
from reasoning.values import Promises, Question, steps

LONGEST = 8
KINDS = ("carrier", "worker")


class Team:
    """A team as the coordinator never sees it: some plans, each with its length, the robots it gives and takes. It can
    do what one of them does, and whatever is easier."""

    def __init__(self, *plans: tuple[int, Promises, Promises], stock: Mapping[str, int]) -> None:
        self.stock = stock
        self.plans = [Known(Question("share", k), "yes", k, gave=gave, took=took) for k, gave, took in plans]

    def answer(self, q: Question) -> Known:
        """As `reasoning.planner` would. The published questions are about exactly one robot of the first kind drawn."""
        if q.kind == "share":
            found = Ledger(answers=tuple(self.plans)).witness(q)
            return Known(q, "no") if found is None else found._replace(question=q)
        kind = KINDS[-1]
        gives = ((kind, q.step),) if q.kind == "lend" else ()
        takes = ((kind, q.step),) if q.kind == "borrow" else ()
        found = Ledger(answers=tuple(self.plans)).witness(Question("share", q.within, 0, gives, takes))
        return Known(q, "yes" if found else "no", found.finish if found else 0, q.step)


def promises(most: int) -> st.SearchStrategy[Promises]:
    one = st.tuples(st.sampled_from(KINDS), st.integers(0, LONGEST - 2))
    return st.lists(one, max_size=most).map(lambda some: tuple(sorted(some)))


@st.composite
def teams(draw: st.DrawFn) -> Team:
    plans = draw(st.lists(st.tuples(st.integers(0, LONGEST - 1), promises(3), promises(2)), min_size=1, max_size=4))
    inside = [(k, tuple(g for g in gave if g[1] < k), tuple(t for t in took if t[1] < k)) for k, gave, took in plans]
    stock = {kind: draw(st.integers(0, 2)) for kind in KINDS}
    return Team(*((k, afforded(gave, took, stock), took) for k, gave, took in inside), stock=stock)


def afforded(gave: Promises, took: Promises, stock: Mapping[str, int]) -> Promises:
    """What can be given of that: robots that the team has, or that it took in a step before."""
    kept: Promises = ()
    for kind, step in sorted(gave, key=lambda give: give[1]):
        has = stock[kind] + sum(since < step for since in steps(took, kind))
        kept += ((kind, step),) * (len(steps(kept, kind)) < has)
    return tuple(sorted(kept))


def least(named: Mapping[str, Team], market: Market) -> int | None:
    """Exhaustive search: every choice of a plan for each team, every supplier for each robot that is taken."""
    best = None
    for plans in product(*(team.plans for team in named.values())):
        k = max(plan.finish for plan in plans)
        chosen = dict(zip(named, plans, strict=True))
        wanted = [(name, *take) for name, plan in chosen.items() for take in plan.took]
        offered = [(name, *give) for name, plan in chosen.items() for give in plan.gave]
        if (best is None or k < best) and served(wanted, offered, list(market.bench), market):
            best = k
    return best


def served(
    wanted: Sequence[tuple[str, str, int]], offered: list[tuple[str, str, int]], bench: list[str], market: Market
) -> bool:
    if not wanted:
        return True
    (taker, kind, step), *others = wanted
    for offer in offered:
        travel = market.steps(offer[0], taker)
        if offer[1] == kind and travel is not None and offer[2] + travel <= step:
            left = offered.copy()
            left.remove(offer)
            if served(others, left, bench, market):
                return True
    for robot in bench:
        ready = market.ready(robot, taker)
        fits = market.bench[robot].kind == kind and ready is not None and ready <= step
        if fits and served(others, offered, [b for b in bench if b != robot], market):
            return True
    return False


def solve(named: Mapping[str, Team], market: Market) -> tuple[Shared, int]:
    ledgers = {name: Ledger(stock=team.stock) for name, team in named.items()}
    asked = 0
    while isinstance(step := advance(ledgers, market, LONGEST - 1), Asking):
        assert step.questions, "a search that goes on must ask something"
        for name, question in step.questions.items():
            assert ledgers[name].verdict(question) is None, "asked although the answer follows"
            ledgers[name] = ledgers[name].learn(named[name].answer(question))
            asked += 1
    return step, asked


NAMES = ("T0", "T1", "T2")
PAIRS = st.fixed_dictionaries({pair: st.integers(0, 3) for pair in product(NAMES, NAMES) if pair[0] != pair[1]})
WAITING = st.builds(Waiting, st.sampled_from(KINDS), st.sampled_from((*NAMES, "T9")), st.integers(-3, 0))
BENCH = st.dictionaries(st.sampled_from(["T8.w1", "T9.w2"]), WAITING, max_size=1)


DRAWN = st.tuples(st.lists(teams(), min_size=1, max_size=3), st.integers(1, 3) | PAIRS, BENCH)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(DRAWN)
def test_the_least_horizon_is_that_of_exhaustive_search(
    drawn: tuple[list[Team], int | dict[tuple[str, str], int], dict[str, Waiting]],
) -> None:
    agree(*drawn)


def agree(drawn: list[Team], delay: int | dict[tuple[str, str], int], bench: dict[str, Waiting]) -> None:
    named = dict(zip(NAMES, drawn, strict=False))
    market = Market(delay, bench)
    expected = least(named, market)
    shared, _ = solve(named, market)
    if expected is None:
        assert shared.status in ("unknown", "infeasible")
        return
    assert (shared.status, shared.makespan, shared.lower_bound) == ("optimal", expected, expected)
    hold(named, market, shared)


def hold(named: Mapping[str, Team], market: Market, shared: Shared) -> None:
    """Can all teams play their roles, and do the loans serve every robot that is taken in time?"""
    plans = {name: team.answer(shared.roles[name]) for name, team in named.items()}
    assert all(plan.verdict == "yes" and plan.finish <= shared.makespan for plan in plans.values())
    for loan in shared.loans:
        taken = steps(plans[loan.taker].took, loan.kind)[loan.takes]
        if loan.giver in market.bench:
            ready = market.ready(loan.giver, loan.taker)
        else:
            travel = market.steps(loan.giver, loan.taker)
            ready = None if travel is None else steps(plans[loan.giver].gave, loan.kind)[loan.gives] + travel
        assert ready is not None
        assert ready <= taken
    taken_by = [(loan.taker, loan.kind, loan.takes) for loan in shared.loans]
    given_by = [(loan.giver, loan.kind, loan.gives) for loan in shared.loans]
    assert len(set(given_by)) == len(given_by)
    assert sorted(taken_by) == sorted(
        (name, kind, n) for name, plan in plans.items() for kind in KINDS for n in range(len(steps(plan.took, kind)))
    )
