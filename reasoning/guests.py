"""Names for robots that a team may borrow without the published limits."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping

from reasoning.domain import Domain


def limits(stocks: Iterable[Mapping[str, int]], most: int) -> dict[str, int]:
    """So many robots of each kind does a team take at most: no more than there are. `stocks` are those of all teams."""
    there = sum(map(Counter, stocks), Counter())
    return {kind: min(most, number) for kind, number in sorted(there.items())}


def guests(domain: Domain, taken: Iterable[str], numbers: Mapping[str, int]) -> tuple[tuple[str, str], ...]:
    """A name and a kind for each of so many robots of each kind, by the kind: the prefix of its body, and a number that
    is beyond those of the names that are `taken`."""
    used, found = set(taken), []
    for kind, number in numbers.items():
        prefix = str(domain.data.kinds[domain.data.shared.get(kind, kind)]["prefix"])
        for _ in range(number):
            known = [int(match[1]) for name in used if (match := re.fullmatch(rf"{re.escape(prefix)}(\d+)", name))]
            name = f"{prefix}{max(known, default=0) + 1}"
            used.add(name)
            found.append((name, kind))
    return tuple(sorted(found))
