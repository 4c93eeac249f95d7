"""Sharing robots: the coordinator's search for the least makespan that all teams can keep.

Teams keep their models private and answer three kinds of yes/no questions (`reasoning.values.Question`). A `Ledger`
holds what is known of one team and answers what follows from it.

`advance` looks at all ledgers and says which questions to ask next, at most one a team and all of them useful
whatever the others answer, or that the search is over. It is a function of its arguments alone: a coordinator that
comes back, or one whose world changed, starts again from whatever is known.

For a horizon k a team is a lender if it can finish alone, else a borrower; nobody does both, nobody exchanges more
than one robot (Haspalamutgil 2011, chapter 4). k is feasible iff borrowers can be matched with lenders or with robots
on the bench, each its own, such that earliest lending step + delay <= latest borrowing step. Bounds on these steps
are refined only where the matching depends on them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

from reasoning.horizons import Asking, Horizon, Loan, Shared, search
from reasoning.ledger import Known, Ledger, Verdict
from reasoning.matching import match
from reasoning.values import Question

__all__ = ["Asking", "Known", "Ledger", "Loan", "Shared", "advance"]


def advance(
    teams: Mapping[str, Ledger], delay: int, bench: Mapping[str, int] | None = None, longest: int = 200
) -> Asking | Shared:
    """The next questions, or the result.

    `bench[robot]` is the step from which a robot on the bench can be taken; `longest` the horizon at which the
    search gives up (status ``unknown``). Raises nothing; deterministic.
    """
    bench = bench or {}
    needy = sorted(name for name, ledger in teams.items() if not ledger.can_alone)
    if len(needy) > len(teams) - len(needy) + len(bench) or any(not teams[name].can_borrow for name in needy):
        return Shared(
            "infeasible",
            proof=f"{', '.join(needy)} can never finish alone, and there is not a robot to borrow for each",
        )
    return search(teams, lambda k: _judge(teams, k, delay, bench), longest)


def _judge(teams: Mapping[str, Ledger], k: int, delay: int, bench: Mapping[str, int]) -> Horizon:
    """Is horizon k feasible? Cheap and decisive questions first, so that a refutation comes early."""
    alone = {name: _alone(ledger, k) for name, ledger in teams.items()}
    open_: dict[str, Question] = {name: Question("alone", k) for name, known in alone.items() if known is None}
    borrowers = sorted(name for name, known in alone.items() if known in ("no", "unknown"))
    if len(borrowers) > len(teams) - len(open_) - len(borrowers) + len(bench) and not open_:
        sure = all(alone[name] == "no" for name in borrowers)
        return Horizon(
            reason=f"{', '.join(borrowers)} cannot finish alone, and there is not a robot to borrow for each", sure=sure
        )
    if open_:  # meanwhile those that are known to need help say until when
        ranges = {name: _range(teams[name], "borrow", k) for name in borrowers}
        return Horizon(questions={**_latest(ranges, k), **open_})
    if not borrowers:
        idle = [name for name in sorted(teams) if teams[name].verdict(Question("alone", k)) is None]
        if idle:  # on course to lend, but nobody needs it any more: what then?
            return Horizon(questions={name: Question("alone", k) for name in idle})
        return Horizon(shared=_shared(teams, k, bench, {}, {}, {}))
    return _match(teams, k, delay, bench, borrowers, sorted(name for name in teams if name not in borrowers))


def _alone(ledger: Ledger, k: int) -> Verdict | None:
    """Can the team do without help? A plan that even lends says so, unless the plain question was answered no."""
    verdict = ledger.verdict(Question("alone", k))
    return "yes" if verdict is None and ledger.witness(Question("lend", k, k)) is not None else verdict


def _match(
    teams: Mapping[str, Ledger],
    k: int,
    delay: int,
    bench: Mapping[str, int],
    borrowers: Sequence[str],
    lenders: Sequence[str],
) -> Horizon:
    """Match borrowers with lenders: certainly possible, certainly not, or a question that halves the doubt."""
    lend = {name: _range(teams[name], "lend", k) for name in lenders}
    borrow = {name: _range(teams[name], "borrow", k) for name in borrowers}
    surely = match(
        {name: r.proved for name, r in lend.items() if r.proved is not None},
        {name: r.proved for name, r in borrow.items() if r.proved is not None},
        delay,
        bench,
    )
    if surely is not None and len(surely) == len(borrowers):
        idle = [n for n in lenders if n not in surely.values() and teams[n].verdict(Question("alone", k)) != "yes"]
        if idle:  # offered to lend, but nobody needs it: what then?
            return Horizon(questions={name: Question("alone", k) for name in idle})
        return Horizon(shared=_shared(teams, k, bench, surely, lend, borrow))
    # Of teams of which nothing else is known those with least to do: one hard question to a team with much to do can
    # take as long as the rest of the search.
    order = sorted(teams, key=lambda name: (teams[name].lower_bound, name))
    perhaps = match(
        {n: r.best for n, r in lend.items() if r.best <= k}, {n: r.best for n, r in borrow.items()}, delay, bench, order
    )
    if perhaps is None:
        sure = all(r.sure for r in (*lend.values(), *borrow.values()))
        doubts = "; ".join(
            [
                f"{n} cannot lend" + (f" before step {r.best}" if r.best <= k else "")
                for n, r in sorted(lend.items())
                if r.best
            ]
            + [f"{n} must borrow by step {r.best}" for n, r in sorted(borrow.items())]
            + [f"{robot} waits on the bench from step {at}" for robot, at in sorted(bench.items())]
        )
        return Horizon(reason=f"no matching ({doubts}; transport takes {delay})", sure=sure)
    # Borrowers first: their questions are cheap, and a lender need then only be asked about the very step that
    # matters. Of the lenders only the cheapest one: its no ends the matter as well as a dear one's.
    questions = _latest(borrow, k)
    if not questions:
        pairs = [(giver, borrow[taker].best) for taker, giver in perhaps.items() if giver not in bench]
        asked = {giver: Question("lend", k, latest - delay) for giver, latest in pairs}
        open_ = [giver for giver, question in asked.items() if teams[giver].verdict(question) is None]
        cheapest = min(open_, key=lambda giver: (teams[giver].cost("lend"), giver))
        return Horizon(questions={cheapest: asked[cheapest]})
    return Horizon(questions={n: q for n, q in sorted(questions.items()) if teams[n].verdict(q) is None})


def _latest(borrow: Mapping[str, _Range], k: int) -> dict[str, Question]:
    """What to ask about latest borrowing steps; those who can never borrow are not asked. As teams make their plans
    borrow as late as is easily found, the step after that of a plan is likely to settle it; without a plan, halve."""
    return {
        name: Question("borrow", k, (r.best + 1) // 2 if r.proved is None else r.proved + 1)
        for name, r in borrow.items()
        if r.proved != r.best and r.best >= 0
    }


class _Range(NamedTuple):
    """An exchange step between what is proved possible (None: nothing yet) and the best that is not refuted."""

    proved: int | None
    best: int
    sure: bool = True


def _range(ledger: Ledger, kind: Literal["lend", "borrow"], k: int) -> _Range:
    """Earliest lending or latest borrowing step at horizon k as far as it is known."""
    steps = range(k + 1) if kind == "lend" else range(k, -1, -1)
    best, sure = k + 1 if kind == "lend" else -1, True
    for step in steps:
        verdict = ledger.verdict(Question(kind, k, step))
        if verdict in (None, "yes"):
            best = step
            break
        sure = sure and verdict == "no"
    proved = next((s for s in steps if ledger.verdict(Question(kind, k, s)) == "yes"), None)
    return _Range(proved, best, sure)


def _shared(
    teams: Mapping[str, Ledger],
    k: int,
    bench: Mapping[str, int],
    matched: Mapping[str, str],
    lend: Mapping[str, _Range],
    borrow: Mapping[str, _Range],
) -> Shared:
    """The matching as roles. The plans that answered may all be shorter than the horizon: then so is the whole."""
    roles = {name: Question("alone", k) for name in teams}
    loans = []
    for taker, giver in sorted(matched.items()):
        roles[taker] = Question("borrow", k, _proved(borrow[taker]))
        if giver not in bench:
            roles[giver] = Question("lend", k, _proved(lend[giver]))
        loans.append(Loan(giver, taker))
    found = [known for name, role in roles.items() if (known := teams[name].witness(role)) is not None]
    makespan = max((known.finish for known in found), default=0)
    roles = {name: Question(role.kind, makespan, role.step) for name, role in roles.items()}
    return Shared("feasible", makespan, 0, roles, tuple(loans))


def _proved(found: _Range) -> int:
    if found.proved is None:
        raise AssertionError("a matching used a step that is not proved")
    return found.proved
