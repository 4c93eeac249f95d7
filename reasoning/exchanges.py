"""Sharing robots without the published limits: any number of robots of any kind, given and taken by the same team at
different times, with transport that depends on the pair of teams.

A team's part is a *profile*: the robots that it gives, each by a step, and those that it takes, each from a step on.
Teams are asked whether they can finish within k steps under a profile (``share`` in `reasoning.values.Question`); they
keep their models private. The coordinator's problem at a horizon is an answer set program (`reasoning.loans`): a
profile for each team and a supplier for each robot that is taken, such that no profile is refuted by what is known. If
there is none, the horizon is refuted, and the answers are its proof. If all profiles of one are known to be possible,
it is a shared plan. Else the teams are asked about theirs, and the answers forbid or establish it:

- takers before givers, so that a giver is asked about the very step that matters, and of the givers the cheapest;
- whether robots help at all, taken as early as can be, before until when they do;
- that by halving what is open between a known yes and the profile.

The search first allows each team one exchange (the published special case), which finds a good plan fast if there is
one; what can be said beyond is then asked with that plan at hand. In the end as many teams as possible keep the plans
that they follow already, as long as that costs no step.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

from reasoning.horizons import STRIDE, Asking, Horizon, Loan, Shared, Trail, begin, search
from reasoning.ledger import Known, Ledger
from reasoning.loans import Market, Take, choose
from reasoning.probes import as_planned, probe, put_off
from reasoning.values import Question, steps

KEEPING = 2
"""The last round of a search, after those with one exchange a team and with any number."""
FEW = 8 * STRIDE
"""With one exchange a team, no more than so many steps beyond the bound are looked at: it may never suffice."""


def advance(
    teams: Mapping[str, Ledger], market: Market, longest: int = 200, trail: Trail | None = None
) -> Asking | Shared:
    """The next questions, or the result. `longest` is the horizon at which the search gives up (status ``unknown``).
    With the `trail` of the last questions it goes on from there, which is faster; nothing but answers may have come
    since. Raises nothing; deterministic."""
    stuck = sorted(name for name, ledger in teams.items() if not ledger.can_alone and not ledger.can_borrow)
    if stuck:
        never = f"{', '.join(stuck)} can never finish, neither alone nor with borrowed robots"
        return Shared("infeasible", proof=never)
    needy = sorted(name for name, ledger in teams.items() if not ledger.can_alone)
    if needy and not market.bench and not any(sum(ledger.stock.values()) for ledger in teams.values()):
        return Shared("infeasible", proof=f"{', '.join(needy)} can never finish alone, and there is no robot to borrow")
    if trail is not None and trail.round == KEEPING and trail.best is not None:
        return _keeping(teams, market, trail.best)
    if trail is None or trail.round == 0:
        few = min(longest, max((ledger.lower_bound for ledger in teams.values()), default=0) + FEW)
        first = search(teams, lambda k: _judge(teams, market, k, 1), few, trail)
        if isinstance(first, Asking):
            return first
        if first.status == "optimal":
            return _keeping(teams, market, first)
        trail = begin(teams, first if first.roles else None, 1)
    result = search(teams, lambda k: _judge(teams, market, k, None), longest, trail)
    return result if isinstance(result, Asking) else _keeping(teams, market, result)


def _keeping(teams: Mapping[str, Ledger], market: Market, found: Shared) -> Asking | Shared:
    """The plan that was found, or another one of the same length in which more teams go on as they do."""
    offers = {name: ledger.offer for name, ledger in teams.items() if ledger.offer is not None}
    if not found.roles or all(teams[name].witness(found.roles[name]) == offer for name, offer in offers.items()):
        return found
    k, bound = found.makespan, found.lower_bound
    horizon = _judge(teams, market, k, None, keep=True)
    if horizon.shared is not None:
        return replace(found, roles=horizon.shared.roles, loans=horizon.shared.loans)
    trail = Trail(k, bound, STRIDE, bound, found.proof, found, KEEPING)
    return Asking(k, bound, k, horizon.questions, found, trail)


def _judge(teams: Mapping[str, Ledger], market: Market, k: int, most: int | None, *, keep: bool = False) -> Horizon:
    helped = {} if most or keep else {name: _helped(name, teams, market, k) for name in sorted(teams)}
    if open_ := {name: best for name, best in helped.items() if teams[name].verdict(best) is None}:
        return Horizon(questions=open_)
    takes = choose(teams, market, k, most=most, against=("no", "unknown"), keep=keep)
    if takes is None:
        return Horizon(reason=_reason(teams, k), sure=choose(teams, market, k) is None)
    late = list(takes)
    for name in sorted(teams):
        plan = teams[name].witness(_profile(name, market, k, late))
        if plan is not None:
            late = as_planned(plan, late, name)
        else:
            late = put_off(teams[name], late, name, partial(_profile, name, market, k))
    profiles = {name: _profile(name, market, k, late) for name in sorted(teams)}
    open_ = {name: wanted for name, wanted in profiles.items() if teams[name].verdict(wanted) != "yes"}
    if open_:
        return Horizon(questions=_questions(teams, market, late, open_))
    return Horizon(shared=_shared(teams, market, k, late))


def _helped(name: str, teams: Mapping[str, Ledger], market: Market, k: int) -> Question:
    """Could the team do with all the help that there may ever be? If not, no exchange makes the horizon feasible."""
    kinds = sorted({kind for ledger in teams.values() for kind in ledger.stock})
    givers = [other for other in teams if other != name]
    takes = [(kind, market.first(name, kind, givers)) for kind in kinds for _ in range(market.limit(kind))]
    allowed = tuple(take for take in takes if take[1] < k) if teams[name].can_borrow else ()
    return Question("share", k, 0, (), allowed)


def _reason(teams: Mapping[str, Ledger], k: int) -> str:
    said = sum(a.verdict == "no" and a.question.within >= k for ledger in teams.values() for a in ledger.answers)
    return f"whatever the teams exchange, it is more than one of them can do, by {said} answers"


def _profile(name: str, market: Market, k: int, takes: Sequence[Take]) -> Question:
    """A team's part in some exchanges. It gives as late as transport allows."""
    gives = [
        (take.kind, take.step - travel)
        for take in takes
        if take.giver == name and (travel := market.steps(name, take.taker)) is not None
    ]
    mine = [(take.kind, take.step) for take in takes if take.taker == name]
    return Question("share", k, 0, tuple(sorted(gives)), tuple(sorted(mine)))


def _questions(
    teams: Mapping[str, Ledger], market: Market, takes: Sequence[Take], open_: Mapping[str, Question]
) -> dict[str, Question]:
    """What to ask of the open profiles, at most one question a team, none whose answer follows."""
    cheap = sorted(open_, key=lambda name: (teams[name].cost("share"), name))
    alone = {name: wanted for name, wanted in open_.items() if not wanted.gives and not wanted.takes}
    waiting = {take.giver for take in takes if take.taker in open_}
    ready = [name for name in cheap if name not in waiting and name not in alone]
    if not ready and not alone:  # they wait for one another in a circle
        ready = [name for name in cheap if open_[name].takes][:1]
    takers = {name: open_[name] for name in ready if open_[name].takes}
    if not alone and not takers:
        return {ready[0]: open_[ready[0]]}
    asked = dict(alone)
    for name, wanted in takers.items():
        givers = [other for other in teams if other != name]
        first = {kind: market.first(name, kind, givers) for kind, _ in wanted.takes}
        asked[name] = probe(teams[name], wanted, first)
    return asked


def _shared(teams: Mapping[str, Ledger], market: Market, k: int, takes: Sequence[Take]) -> Shared:
    """The exchanges as roles and loans. A plan may take fewer robots than it might: then fewer are to be given."""
    while True:
        roles = {name: _profile(name, market, k, takes) for name in teams}
        plans = {name: _plan(teams[name], role) for name, role in roles.items()}
        taken = _numbers(takes, lambda take: take.taker, lambda take: take.step)
        needed = [t for t, n in zip(takes, taken, strict=True) if n < len(steps(plans[t.taker].took, t.kind))]
        if len(needed) == len(takes):
            break
        takes = needed
    given = _numbers(
        takes, lambda take: take.giver, lambda take: take.step - (market.steps(take.giver, take.taker) or 0)
    )
    loans = [
        Loan(take.giver, take.taker, take.kind, give, number)
        for take, give, number in zip(takes, given, taken, strict=True)
    ]
    makespan = max((known.finish for known in plans.values()), default=0)
    roles = {name: role._replace(within=makespan) for name, role in roles.items()}
    return Shared("feasible", makespan, 0, roles, tuple(loans))


def _plan(ledger: Ledger, role: Question) -> Known:
    known = ledger.witness(role)
    if known is None:
        raise AssertionError("a role was given out that is not known to be possible")
    return known


def _numbers(takes: Sequence[Take], who: Callable[[Take], str], when: Callable[[Take], int]) -> list[int]:
    """Each take's place in time among those of the same team and kind."""
    numbers = [0] * len(takes)
    seen: Counter[tuple[str, str]] = Counter()
    for index in sorted(range(len(takes)), key=lambda i: (when(takes[i]), i)):
        port = (who(takes[index]), takes[index].kind)
        numbers[index] = seen[port]
        seen[port] += 1
    return numbers
