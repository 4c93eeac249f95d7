"""How the teams of a scenario share their robots: under the published limits, or without them.

The published scheme is `reasoning.sharing`, the general one `reasoning.exchanges`; the set-up's constants say which.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import permutations

from ops.compile import DELAY, SHARING
from reasoning import exchanges, sharing
from reasoning.checker import Exchange
from reasoning.domain import Domain
from reasoning.horizons import Asking, Loan, Shared
from reasoning.ledger import Known, Ledger
from reasoning.loans import Market
from reasoning.prospects import prospects
from reasoning.setup import Setup
from reasoning.solver import quoted
from reasoning.values import Answer, Plan, Problem, Question, promised

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
    stocks = [prospects(problem).stock for problem in alone.values()]
    kinds = [kind for kind, number in _most(setup, stocks).items() for _ in range(number)]
    guests = {team: _guests(domain, setup, team, kinds) for team in states}
    return {
        team: Problem(problem.domain, problem.static, problem.state, guests=guests[team])
        for team, problem in alone.items()
    }


def _most(setup: Setup, stocks: Iterable[Mapping[str, int]]) -> dict[str, int]:
    """So many robots of each kind does a team take at most: no more than there are."""
    there = sum(map(Counter, stocks), Counter())
    return {kind: min(int(setup.static[MOST]), number) for kind, number in sorted(there.items())}


def market(setup: Setup, stocks: Iterable[Mapping[str, int]]) -> Market:
    """Transport between teams, in general sharing; `stocks` are the robots that each team has at first."""
    static = setup.static
    delay = {
        (giver, taker): int(static.get(f"{DELAY}({quoted(giver)},{quoted(taker)})", static[DELAY]))
        for giver, taker in permutations(setup.states, 2)
    }
    return Market(delay, most=_most(setup, stocks))


def advance(ledgers: Mapping[str, Ledger], setup: Setup, before: Asking | None) -> Asking | Shared:
    """The coordinator's next questions, or the result; `before` are those that were asked last."""
    if general(setup) and len(ledgers) > 1:
        return exchanges.advance(
            ledgers, market(setup, [x.stock for x in ledgers.values()]), trail=before.trail if before else None
        )
    return sharing.advance(ledgers, int(setup.static.get(DELAY, 0)))


def learned(answer: Answer) -> Known:
    """An answer as the ledger keeps it."""
    plan = answer.plan
    if plan is None:
        return Known(answer.easiest or answer.question, answer.verdict, cost=answer.conflicts)
    at = plan.exchange[1] if plan.exchange else 0
    gave, took = promised(plan.gave), promised(plan.took)
    return Known(answer.question, answer.verdict, plan.makespan, at, answer.conflicts, gave, took)


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
    if question.kind != "share":
        return how[question.kind]
    parts = [f"giving a {kind} by step {step}" for kind, step in question.gives]
    parts += [f"taking a {kind} from {step} on" for kind, step in question.takes]
    return ", ".join(parts) or "alone"


def _with_guest(problem: Problem, domain: Domain, setup: Setup, team: str) -> Problem:
    ((name, _),) = _guests(domain, setup, team, [domain.data.exchanged])
    return Problem(problem.domain, problem.static, problem.state, name)


def _guests(domain: Domain, setup: Setup, team: str, kinds: list[str]) -> tuple[tuple[str, str], ...]:
    """A name for each borrowed robot that no robot of the team has: the prefix of its kind of body, and a number."""
    taken = {entity.name for entity in setup.entities if entity.team == team}
    guests: list[tuple[str, str]] = []
    for kind in kinds:
        prefix = str(domain.data.kinds[domain.data.shared.get(kind, kind)]["prefix"])
        numbers = [int(match[1]) for name in taken if (match := re.fullmatch(rf"{re.escape(prefix)}(\d+)", name))]
        name = f"{prefix}{max(numbers, default=0) + 1}"
        taken.add(name)
        guests.append((name, kind))
    return tuple(sorted(guests))
