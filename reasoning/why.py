"""Why not? A smallest set of members that clash, found and checked by the solver.

A domain's programs ``why*.lp`` put a guard, ``use(G)``, before each of the goals, robots, facts and rules that a
question is about, and say which there are: ``group(G,K)``. Guards stand in constraints alone, so what is possible stays
possible when fewer of them are assumed, and a set that cannot be assumed together, but can without any one of its
members, is an explanation. It is found by leaving out: from the solver's own core of what clashes, several members at a
time are left out as long as the others clash, those with the least K first. The result is then checked by a solver that
knows nothing of this search: all members clash, and without any one of them there is a way.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from reasoning.solver import Assumption, Model, Program, Solved

LEAST = 20_000
"""Conflicts that each search for a smaller clash may take in any case."""
EFFORT = 3
"""Else so many times as many as the first refutation took."""
SHARES = (64, 8, 1)
"""What is cheap comes first: all members are tried to be left out with these shares of the effort, one after the
other, and each time those that are in doubt still."""

Clock = Callable[[], float]
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Clash:
    """`members` cannot hold together. `without[G]` is what is possible when G alone is left out: they are as many as
    the members, unless the search ended before, and then it is open whether the others are needed. `checked`: a solver
    of its own has found the same."""

    members: tuple[str, ...]
    without: Mapping[str, Model] = field(default_factory=dict)
    checked: bool = False
    searches: int = 0
    conflicts: int = 0
    seconds: float = 0.0

    @property
    def open(self) -> tuple[str, ...]:
        """Members of which it is not known that they are needed."""
        return tuple(member for member in self.members if member not in self.without)


@dataclass(frozen=True)
class Possible:
    """Nothing clashes: `model` is a way."""

    model: Model


@dataclass(frozen=True)
class Unknown:
    """The search ended before anything was refuted."""

    conflicts: int
    seconds: float


def explain(
    make: Callable[[], Program],
    *,
    seconds: float | None = None,
    clock: Clock = lambda: 0.0,
    on_progress: Progress = lambda _: None,
) -> Clash | Possible | Unknown:
    """A minimal clash among all groups of a program, or a way if there is none. `make` loads and grounds it.

    `seconds` of the clock bound all searches together; searches for smaller clashes are bounded by conflicts too.
    Raises ValueError when the program has no model even without any group: then there is nothing that could be told.
    """
    return _Search(make, seconds, clock, on_progress).run()


class _Search:
    """One question: its budgets, and what was counted."""

    def __init__(
        self,
        make: Callable[[], Program],
        seconds: float | None,
        clock: Clock,
        on_progress: Progress,
    ) -> None:
        self._make, self._clock, self._tell = make, clock, on_progress
        self._each: int | None = None
        self._began = clock()
        self._end = None if seconds is None else self._began + seconds
        self._searches = self._conflicts = 0
        self._groups: tuple[str, ...] = ()

    def run(self) -> Clash | Possible | Unknown:
        program = self._make()
        free = program.solve([])
        if free.model is None:
            raise ValueError("the program has no model, whatever is left out")
        self._groups = _groups(free.model)
        first = self._try(program, self._groups, None)
        if first.model is not None:
            return Possible(first.model)
        if first.satisfiable is None:
            return Unknown(self._conflicts, self._clock() - self._began)
        self._each = max(LEAST, EFFORT * first.conflicts)
        members, ways = _core(self._groups, first), dict[str, Model]()
        for share in SHARES:
            members = self._shrink(program, members, ways, self._each // share)
        members, without, checked = (members, ways, False) if self._over() else self._check(members, ways)
        return Clash(members, without, checked, self._searches, self._conflicts, self._clock() - self._began)

    def _shrink(
        self, program: Program, members: tuple[str, ...], ways: dict[str, Model], conflicts: int
    ) -> tuple[str, ...]:
        """Leave out as many as possible of those without a way, in their order: a quarter of them to begin with, then
        half as many where that is too many, and twice as many where it went well. A way without one of many members is
        one of fewer too, and is added to `ways`."""
        doubtful = [member for member in members if member not in ways]
        at, size = 0, max(len(doubtful) // 4, 1)
        while at < len(doubtful) and not self._over():
            size = min(size, len(doubtful) - at)
            self._tell(f"{len(members)} members clash, {len(ways.keys() & members)} of them are needed")
            left_out = doubtful[at : at + size]
            rest = tuple(member for member in members if member not in left_out)
            solved = self._try(program, rest, conflicts)
            if solved.satisfiable is False:
                members, size = _core(rest, solved), size * 2
                at = sum(member in members for member in doubtful[:at])
                doubtful = [member for member in doubtful if member in members]
            elif size > 1:
                size //= 2
            else:
                ways |= {doubtful[at]: solved.model} if solved.model is not None else {}
                at += 1
        return members

    def _check(
        self, members: tuple[str, ...], ways: dict[str, Model]
    ) -> tuple[tuple[str, ...], dict[str, Model], bool]:
        """Refute all of the members once more, and look for a way without each; of fewer, if a search that ended
        without an answer before succeeds now. Where the time is over, the ways that were found before must do."""
        program = self._make()
        refuted = self._try(program, members, None)
        if refuted.model is not None:
            raise AssertionError(f"these members do not clash: {', '.join(members)}")
        without: dict[str, Model] = {}
        for number, member in enumerate(members):
            if self._over():
                break
            self._tell(f"{len(members)} members clash, {number} of them were checked")
            rest = tuple(m for m in members if m != member)
            solved = self._try(program, rest, self._each)
            if solved.satisfiable is False:
                return self._check(_core(rest, solved), ways)
            if solved.model is not None:
                without[member] = solved.model
        checked = refuted.satisfiable is False and len(without) == len(members)
        return members, {m: way for m, way in {**ways, **without}.items() if m in members}, checked

    def _try(self, program: Program, members: tuple[str, ...], conflicts: int | None) -> Solved:
        chosen = set(members)
        assumed: list[Assumption] = [("use", (group,), group in chosen) for group in self._groups]
        left = None if self._end is None else max(self._end - self._clock(), 0.0)
        solved = program.solve(assumed, conflicts=conflicts, seconds=left)
        self._searches += 1
        self._conflicts += solved.conflicts
        return solved

    def _over(self) -> bool:
        return self._end is not None and self._clock() >= self._end


def _core(members: tuple[str, ...], solved: Solved) -> tuple[str, ...]:
    """Those of the members that the solver used. That others were left out cannot have been a reason."""
    core = {args[0] for _, args, truth in solved.core if truth}
    return tuple(member for member in members if member in core)


def _groups(model: Model) -> tuple[str, ...]:
    ranked = sorted((int(a.args[1]), str(a.args[0])) for a in model.atoms if a.name == "group")
    return tuple(name for _, name in ranked)
