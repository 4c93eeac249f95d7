"""How the teams of a scenario share their robots: under the published limits, or without them.

The published scheme is `reasoning.sharing`, the general one `reasoning.exchanges`; the set-up's constants say which.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations

from reasoning import exchanges, sharing
from reasoning.checker import Exchange
from reasoning.domain import Domain
from reasoning.guests import guests, limits
from reasoning.horizons import Asking, Loan, Shared
from reasoning.ledger import Ledger
from reasoning.loans import Market
from reasoning.prospects import prospects
from reasoning.setup import Setup
from reasoning.solver import quoted
from reasoning.values import Plan, Problem, Question
from reasoning.words import handing

DELAY = "delay"
SHARING = "sharing"
MOST = "most"


def general(setup: Setup) -> bool:
    """Is sharing without the published limits asked for?"""
    return setup.static.get(SHARING) == "general"


def problems(domain: Domain, setup: Setup) -> dict[str, Problem]:
    """What each team wants to plan, with names for the robots that it may borrow."""
    states = setup.states
    alone = {team: Problem(domain.name, setup.static, state) for team, state in states.items()}
    if len(states) < 2 or not domain.data.exchanged:
        return alone
    if not general(setup):
        return {team: _with_guest(problem, domain, setup, team) for team, problem in alone.items()}
    numbers = most(domain, setup)
    return {
        team: Problem(problem.domain, problem.static, problem.state, guests=guests(domain, _own(setup, team), numbers))
        for team, problem in alone.items()
    }


def most(domain: Domain, setup: Setup) -> dict[str, int]:
    """So many robots of each kind does a team take at most, in general sharing."""
    stocks = (prospects(Problem(domain.name, setup.static, state)).stock for state in setup.states.values())
    return limits(stocks, int(setup.static[MOST]))


def delays(setup: Setup) -> dict[tuple[str, str], int]:
    """Steps of transport from team to team."""
    static = setup.static
    return {
        (giver, taker): int(static.get(f"{DELAY}({quoted(giver)},{quoted(taker)})", static[DELAY]))
        for giver, taker in permutations(setup.states, 2)
    }


def advance(ledgers: Mapping[str, Ledger], setup: Setup, before: Asking | None) -> Asking | Shared:
    """The coordinator's next questions, or the result; `before` are those that were asked last."""
    if general(setup) and len(ledgers) > 1:
        numbers = limits([ledger.stock for ledger in ledgers.values()], int(setup.static[MOST]))
        market = Market(delays(setup), most=numbers)
        return exchanges.advance(ledgers, market, trail=before.trail if before else None)
    return sharing.advance(ledgers, int(setup.static.get(DELAY, 0)))


def exchanged(loan: Loan, plans: Mapping[str, Plan]) -> Exchange:
    """Which robot a loan is about, and when it leaves and comes."""
    if loan.kind:
        given = [one for one in plans[loan.giver].gave if one.kind == loan.kind][loan.gives]
        taken = [one for one in plans[loan.taker].took if one.kind == loan.kind][loan.takes]
        return Exchange(given.robot, loan.giver, given.step, loan.taker, taken.step, taken.robot)
    left, came = plans[loan.giver].exchange, plans[loan.taker].exchange
    if left is None or came is None:
        raise AssertionError(f"{loan.giver} and {loan.taker} are matched, but their plans exchange nobody")
    return Exchange(left[0], loan.giver, left[1], loan.taker, came[1], came[0])


def words(question: Question) -> str:
    """A question for people."""
    how = {"alone": "alone", "lend": f"lending by step {question.step}", "borrow": f"borrowing from {question.step} on"}
    return how.get(question.kind) or handing(question.gives, question.takes)


def _with_guest(problem: Problem, domain: Domain, setup: Setup, team: str) -> Problem:
    ((name, _),) = guests(domain, _own(setup, team), {domain.data.exchanged: 1})
    return Problem(problem.domain, problem.static, problem.state, name)


def _own(setup: Setup, team: str) -> list[str]:
    return [entity.name for entity in setup.entities if entity.team == team]
