"""The least horizon that all teams can keep, and the results of the search for it.

What a horizon takes is judged elsewhere (`reasoning.sharing`, `reasoning.exchanges`): it is feasible with a shared
plan, or refuted, or there are questions to ask first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from reasoning.ledger import Ledger
from reasoning.values import Question
from reasoning.words import count

STRIDE = 4
"""The search leaps ahead from the bound in strides that double, until a shared plan is found, and then halves the gap:
a question refuted for a long horizon need not be asked for a shorter one."""


@dataclass(frozen=True)
class Loan:
    """`giver` is a team, or the built name of a robot that waits on the bench. The robot is the one that the giver's
    plan gives, and the taker's plan takes, as number `gives` and `takes` of this `kind`, counted from 0."""

    giver: str
    taker: str
    kind: str = ""
    gives: int = 0
    takes: int = 0


@dataclass(frozen=True)
class Shared:
    """The end of the search. `roles[team]` is the answered question whose plan the team is to adopt."""

    status: Literal["optimal", "feasible", "infeasible", "unknown"]
    makespan: int = 0
    lower_bound: int = 0
    roles: Mapping[str, Question] = field(default_factory=dict)
    loans: tuple[Loan, ...] = ()
    proof: str = ""


class Trail(NamedTuple):
    """How far a search has come: horizon `k` is next, everything below `low` is out of the question, and below `proven`
    for a `reason`; the next leap is `stride`. `round` counts the searches that follow one another."""

    k: int
    low: int
    stride: int
    proven: int
    reason: str
    best: Shared | None
    round: int = 0


@dataclass(frozen=True)
class Asking:
    """The search goes on: `questions[team]`, about the horizon `within`. Everything below `low` is refuted; `high` is
    the makespan of the best shared plan so far (None: none yet). `so_far` is the result, should it end here, and
    `trail` where it can go on, as long as nothing but answers has come since."""

    within: int
    low: int
    high: int | None
    questions: Mapping[str, Question]
    so_far: Shared
    trail: Trail


class Horizon(NamedTuple):
    """What is to be said of one horizon: feasible with `shared`, refuted for a `reason`, or `questions` to ask."""

    shared: Shared | None = None
    reason: str = ""
    sure: bool = True
    questions: Mapping[str, Question] = {}


def search(
    teams: Mapping[str, Ledger], judge: Callable[[int], Horizon], longest: int, trail: Trail | None = None
) -> Asking | Shared:
    """The next questions, or the result. `longest` is the horizon at which the search gives up (status ``unknown``),
    `trail` where it goes on."""
    k, low, stride, proven, reason, best, number = trail or begin(teams)
    while best is None or low < best.makespan:
        if best is not None:
            k = (low + best.makespan) // 2
        elif low > longest:
            return Shared("unknown", 0, proven, {}, (), f"no shared plan of at most {count(longest, 'step')} was found")
        k = min(k, max(longest, low))
        horizon = judge(k)
        if horizon.questions:
            so_far = replace(best or Shared("unknown"), lower_bound=proven, proof=reason)
            left = Trail(k, low, stride, proven, reason, best, number)
            return Asking(k, proven, best.makespan if best else None, horizon.questions, so_far, left)
        if horizon.shared is not None:
            best = horizon.shared
            continue
        low, stride = k + 1, 2 * stride
        if horizon.sure:
            proven, reason = low, f"{count(k, 'step')} refuted: {horizon.reason}"
        k += stride
    status: Literal["optimal", "feasible"] = "optimal" if proven == best.makespan else "feasible"
    return replace(best, status=status, lower_bound=proven, proof=reason)


def begin(teams: Mapping[str, Ledger], best: Shared | None = None, number: int = 0) -> Trail:
    """The start of a search, perhaps with a shared plan that is known before."""
    low = max((ledger.lower_bound for ledger in teams.values()), default=0)
    return Trail(low + STRIDE, low, STRIDE, low, _bound_reason(teams, low), best, number)


def _bound_reason(teams: Mapping[str, Ledger], k: int) -> str:
    if k == 0:
        return "nothing is left to do"
    tight = sorted(name for name, ledger in teams.items() if ledger.lower_bound == k)
    return f"{count(k - 1, 'step')} refuted: {', '.join(tight)} needs at least {count(k, 'step')} by counting"
