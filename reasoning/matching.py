"""Which lender serves which borrower: the assignment at the heart of sharing robots (program ``core/match.lp``)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

from reasoning.domain import core_program
from reasoning.solver import models


def match(
    lenders: Mapping[str, int],
    borrowers: Mapping[str, int],
    delay: int | Mapping[tuple[str, str], int],
    bench: Mapping[str, int] | None = None,
    order: Sequence[str] = (),
) -> dict[str, str] | None:
    """A lender or a robot on the bench for each borrower, each serving one at most; None: there is no such assignment.

    `lenders[team]` is the earliest step to give, `borrowers[team]` the latest step to take, `bench[robot]` the step
    from which a waiting robot can be taken, `delay` the steps of transport, of all or of each pair (lender,
    borrower); a pair without one cannot exchange. Uses as many robots of the bench as possible,
    then lenders that can give early, and of those the first in `order`, or without one by name; of borrowers that
    could exchange theirs, the first has the first. Deterministic.
    """
    bench = bench or {}
    if not borrowers:
        return {}
    numbers = {
        name: number for number, name in enumerate(dict.fromkeys((*order, *sorted({*lenders, *borrowers, *bench}))))
    }
    pairs = {(giver, taker): delay for giver in lenders for taker in borrowers} if isinstance(delay, int) else delay
    facts = [f"lender({numbers[name]},{step})." for name, step in sorted(lenders.items())]
    facts += [f"borrower({numbers[name]},{step})." for name, step in sorted(borrowers.items())]
    facts += [f"bench({numbers[name]},{step})." for name, step in sorted(bench.items())]
    facts += [
        f"delay({numbers[giver]},{numbers[taker]},{steps})."
        for (giver, taker), steps in sorted(pairs.items())
        if giver in lenders and taker in borrowers
    ]
    found = _least(tuple(facts))
    named = list(numbers)
    return None if found is None else {named[taker]: named[giver] for taker, giver in found}


@lru_cache(maxsize=256)
def _least(facts: tuple[str, ...]) -> tuple[tuple[int, int], ...] | None:
    """Pairs (borrower, giver). A search looks at its horizons anew after every answer, and two of three matchings are
    among those that it has seen before."""
    found = models([core_program("match")], facts, optimum=True)
    return tuple(sorted((int(taker), int(giver)) for _, (taker, giver) in found[0].atoms)) if found else None
