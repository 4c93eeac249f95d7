"""Which robots to inspect, one after the other, until one explanation is left: a decision tree with the fewest
expected inspections.

An inspection tells of one robot whether it is broken. Explanations are sets of broken robots with weights (alike,
where no failure rates are known); explanations with the same robots are one. Up to `EXACT_SETS` explanations, or
`EXACT_ROBOTS` robots to choose from, the tree is the best there is (dynamic programming over the explanations that
are left); beyond, the robot is chosen that splits their weight most evenly.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb
from random import Random

EXACT_SETS = 14
EXACT_ROBOTS = 8
SUBSETS_ROBOTS = 10
"""Up to so many robots `arbitrary` is exact; beyond, the mean of `ORDERS` orders, always the same ones."""
ORDERS = 500
DIGITS = 6
"""Prices that differ less than this are equal, and the names decide."""


@dataclass(frozen=True)
class Settled:
    """One explanation is left: these robots are broken."""

    broken: tuple[str, ...]
    chance: float

    @property
    def expected(self) -> float:
        return 0.0


@dataclass(frozen=True)
class Inspect:
    """Inspect `robot`, then go on as it is found. `chance` is that of coming here, `expected` the number of
    inspections from here on."""

    robot: str
    if_broken: Inspect | Settled
    if_sound: Inspect | Settled
    chance: float

    @property
    def expected(self) -> float:
        after = self.if_broken, self.if_sound
        return 1 + sum(tree.chance * tree.expected for tree in after) / self.chance


Tree = Inspect | Settled


def tree(suspected: Sequence[Sequence[str]], weights: Sequence[float] = ()) -> Tree:
    """The inspections for these explanations. Raises ValueError without any."""
    search = _Search(suspected, weights)
    return search.tree(search.all)


def order(suspected: Sequence[Sequence[str]], weights: Sequence[float] = ()) -> tuple[str, ...]:
    """Robots worth an inspection, the best to begin with first: those in some explanations but not in all. Of equally
    good ones those in most explanations come first."""
    if not suspected:
        return ()
    search = _Search(suspected, weights)
    useful = [robot for robot in search.blames if 0 < search.blames[robot] & search.all < search.all]
    rank = {r: (round(search.price(search.all, r), DIGITS), -search.blames[r].bit_count(), r) for r in useful}
    return tuple(sorted(useful, key=rank.__getitem__))


def arbitrary(suspected: Sequence[Sequence[str]], weights: Sequence[float] = (), among: int = 0) -> float:
    """The expected number of inspections when robots are inspected in random order, each one in turn, until one
    explanation is left: only the robots that are worth it or, when the team has `among` robots, any of them."""
    robots = order(suspected, weights)
    search = _Search(suspected, weights)
    # Those worth it come in random order whatever stands between them; the n-th of r stands at n (all + 1) / (r + 1).
    spread = (max(among, len(robots)) + 1) / (len(robots) + 1)
    if len(robots) <= SUBSETS_ROBOTS:
        expected = sum(
            search.unsettled(chosen) / comb(len(robots), size)
            for size in range(len(robots))
            for chosen in combinations(robots, size)
        )
    else:
        random = Random(0)
        orders = [random.sample(robots, len(robots)) for _ in range(ORDERS)]
        expected = sum(search.unsettled(turns[:size]) for turns in orders for size in range(len(robots))) / ORDERS
    return expected * spread


class _Search:
    """Explanations as bits of a mask: `blames[robot]` are those in which it is broken."""

    def __init__(self, suspected: Sequence[Sequence[str]], weights: Sequence[float]) -> None:
        if not suspected:
            raise ValueError("no explanations to tell apart")
        merged: dict[frozenset[str], float] = {}
        for robots, weight in zip(suspected, weights or [1.0] * len(suspected), strict=True):
            merged[frozenset(robots)] = merged.get(frozenset(robots), 0.0) + weight
        total = sum(merged.values())
        self.sets = sorted(merged, key=sorted)
        self.weight = [merged[robots] / total for robots in self.sets]
        self.all = (1 << len(self.sets)) - 1
        names = sorted(frozenset().union(*self.sets))
        self.blames = {
            robot: sum(1 << place for place, robots in enumerate(self.sets) if robot in robots) for robot in names
        }
        first = {blamed: robot for robot, blamed in reversed(self.blames.items())}  # alike robots: one will do
        self.choices = {robot: blamed for blamed, robot in first.items() if blamed != self.all}
        self.exact = len(self.sets) <= EXACT_SETS or len(self.choices) <= EXACT_ROBOTS
        self.known: dict[int, tuple[float, str]] = {}

    def tree(self, left: int) -> Tree:
        chance = self.chance(left)
        if left.bit_count() == 1:
            return Settled(tuple(sorted(self.sets[left.bit_length() - 1])), chance)
        robot = self.best(left)[1]
        blamed = self.blames[robot]
        return Inspect(robot, self.tree(left & blamed), self.tree(left & ~blamed), chance)

    def chance(self, left: int) -> float:
        return sum(weight for place, weight in enumerate(self.weight) if left >> place & 1)

    def unsettled(self, inspected: Sequence[str]) -> float:
        """The chance that after these inspections more than one explanation is left."""
        alike: dict[frozenset[str], list[float]] = {}
        seen = frozenset(inspected)
        for robots, weight in zip(self.sets, self.weight, strict=True):
            alike.setdefault(robots & seen, []).append(weight)
        return sum(sum(some) for some in alike.values() if len(some) > 1)

    def price(self, left: int, robot: str) -> float:
        """Expected inspections when this robot comes first, times the chance of coming here; of the greedy choice,
        how uneven the split is."""
        blamed = self.blames[robot]
        if not self.exact:
            return abs(self.chance(left & blamed) - self.chance(left & ~blamed))
        return self.chance(left) + self.best(left & blamed)[0] + self.best(left & ~blamed)[0]

    def best(self, left: int) -> tuple[float, str]:
        """The price of what is best to inspect, and that robot; nothing when one explanation is left."""
        if left.bit_count() == 1:
            return 0.0, ""
        if left not in self.known:
            prices = {robot: self.price(left, robot) for robot in self._splitting(left)}
            robot = min(prices, key=lambda robot: (round(prices[robot], DIGITS), robot))
            self.known[left] = prices[robot], robot
        return self.known[left]

    def _splitting(self, left: int) -> Iterator[str]:
        return (robot for robot, blamed in self.choices.items() if 0 < left & blamed < left)
