"""Teams that follow a plan already keep it where that costs no step: general sharing against exhaustive search."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import product

import pytest
from hypothesis import given, settings

from reasoning.exchanges import advance
from reasoning.horizons import Asking, Shared
from reasoning.ledger import Known, Ledger
from reasoning.loans import Market
from reasoning.values import Question
from tests.reasoning.test_exchanges import DRAWN, LONGEST, NAMES, Team, served


def offered(team: Team) -> Known:
    """The plan that the team follows: the first of those that it has, as what it says to the coordinator."""
    plan = team.plans[0]
    return Known(
        Question("share", plan.finish, 0, plan.gave, plan.took), "yes", plan.finish, 0, 0, plan.gave, plan.took
    )


def most_kept(named: Mapping[str, Team], market: Market, k: int) -> int:
    """Exhaustive search: in how many teams can the plan that they follow be part of a shared one of k steps?"""
    best = -1
    for plans in product(*(team.plans for team in named.values())):
        chosen = dict(zip(named, plans, strict=True))
        wanted = [(name, *take) for name, plan in chosen.items() for take in plan.took]
        gave = [(name, *give) for name, plan in chosen.items() for give in plan.gave]
        if max(plan.finish for plan in plans) <= k and served(wanted, gave, list(market.bench), market):
            best = max(best, sum(plan == named[name].plans[0] for name, plan in chosen.items()))
    return best


def solve(named: Mapping[str, Team], market: Market, *, keep: bool) -> tuple[Shared, dict[str, Ledger]]:
    ledgers = {name: Ledger(stock=team.stock) for name, team in named.items()}
    if keep:
        offers = {name: offered(team) for name, team in named.items()}
        ledgers = {name: replace(ledger.learn(offers[name]), offer=offers[name]) for name, ledger in ledgers.items()}
    trail = None
    while isinstance(step := advance(ledgers, market, LONGEST - 1, trail), Asking):
        trail = step.trail
        for name, question in step.questions.items():
            ledgers[name] = ledgers[name].learn(named[name].answer(question))
    return step, ledgers


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(DRAWN)
def test_as_many_plans_are_kept_as_cost_no_step(
    drawn: tuple[list[Team], int | dict[tuple[str, str], int], object],
) -> None:
    agree(drawn[0], drawn[1])


def agree(teams: list[Team], delay: int | dict[tuple[str, str], int]) -> None:
    named, market = dict(zip(NAMES, teams, strict=False)), Market(delay)
    plain, _ = solve(named, market, keep=False)
    shared, ledgers = solve(named, market, keep=True)
    assert (shared.status, shared.makespan) == (plain.status, plain.makespan)
    if shared.status != "optimal":
        return
    kept = sum(ledger.witness(shared.roles[name]) == ledger.offer for name, ledger in ledgers.items())
    assert kept == most_kept(named, market, shared.makespan)
