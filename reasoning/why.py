"""Why not? A smallest set of members that clash, found and checked by the solver.

A domain's programs ``why*.lp`` put a guard, ``use(G)``, before each of the goals, robots, facts and rules that a
question is about, and say which there are: ``group(G,K)``. Guards stand in constraints alone, so what is possible stays
possible when fewer of them are assumed, and a set that cannot be assumed together, but can without any one of its
members, is an explanation. It is found by leaving out: from the solver's own core of what clashes, several members at a
time are left out as long as the others clash, those with the least K first. In the end every member is tried again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from reasoning.solver import Assumption, Model, Program, Solved

Clock = Callable[[], float]
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Clash:
    """`members` cannot hold together. `without[G]` is what is possible when G alone is left out: they are as many as
    the members, unless the search ended before, and then it is open whether the others are needed."""

    members: tuple[str, ...]
    without: Mapping[str, Model] = field(default_factory=dict)
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
    program: Program,
    *,
    conflicts: int | None = None,
    seconds: float | None = None,
    clock: Clock = lambda: 0.0,
    on_progress: Progress = lambda _: None,
) -> Clash | Possible | Unknown:
    """A minimal clash among all groups of a grounded program, or a way if there is none.

    `conflicts` bounds each search for a smaller clash, `seconds` of the clock all searches together. Raises ValueError
    when the program has no model even without any group: then there is nothing that could be told.
    """
    return _Search(program, conflicts, seconds, clock, on_progress).run()


def clashes(program: Program, members: Sequence[str], *, seconds: float | None = None) -> bool | None:
    """Do these members clash? None: not known after so many seconds."""
    solved = program.solve([_use(member) for member in members], seconds=seconds)
    return None if solved.satisfiable is None else not solved.satisfiable


def _use(member: str) -> Assumption:
    return "use", (member,), True


class _Search:
    """One question: its budgets, and what was counted."""

    def __init__(
        self, program: Program, conflicts: int | None, seconds: float | None, clock: Clock, on_progress: Progress
    ) -> None:
        self._program, self._each, self._clock, self._tell = program, conflicts, clock, on_progress
        self._began = clock()
        self._end = None if seconds is None else self._began + seconds
        self._searches = self._conflicts = 0
        self._groups: tuple[str, ...] = ()

    def run(self) -> Clash | Possible | Unknown:
        free = self._program.solve([])
        if free.model is None:
            raise ValueError("the program has no model, whatever is left out")
        self._groups = _groups(free.model)
        first = self._try(self._groups, None)
        if first.model is not None:
            return Possible(first.model)
        if first.satisfiable is None:
            return Unknown(self._conflicts, self._clock() - self._began)
        members = self._shrink(self._core(self._groups, first))
        without = self._verify(members)
        return Clash(members, without, self._searches, self._conflicts, self._clock() - self._began)

    def _shrink(self, members: tuple[str, ...]) -> tuple[str, ...]:
        """Leave out as many as possible, in their order: as many at a time as went well before, and twice as many."""
        at, size = 0, 1
        while at < len(members) and not self._over():
            size = min(size, len(members) - at)
            self._tell(f"{len(members)} members clash, {at} of them are needed")
            rest = members[:at] + members[at + size :]
            solved = self._try(rest, self._each)
            if solved.satisfiable is False:
                core = set(self._core(rest, solved))
                at = sum(member in core for member in members[:at])
                members, size = tuple(member for member in rest if member in core), size * 2
            elif size > 1:
                size //= 2
            else:
                at += 1
        return members

    def _verify(self, members: tuple[str, ...]) -> dict[str, Model]:
        """What is possible without each member, and that nothing is with all."""
        without = {}
        for member in members:
            if self._over():
                break
            self._tell(f"{len(members)} members clash, {len(without)} of them were tried once more")
            solved = self._try(tuple(m for m in members if m != member), self._each)
            if solved.satisfiable is False:  # only if an earlier try ended without an answer
                return self._verify(self._core(members, solved))
            if solved.model is not None:
                without[member] = solved.model
        return without

    def _try(self, members: tuple[str, ...], conflicts: int | None) -> Solved:
        chosen = set(members)
        assumed: list[Assumption] = [("use", (group,), group in chosen) for group in self._groups]
        left = None if self._end is None else max(self._end - self._clock(), 0.0)
        solved = self._program.solve(assumed, conflicts=conflicts, seconds=left)
        self._searches += 1
        self._conflicts += solved.conflicts
        return solved

    def _core(self, members: tuple[str, ...], solved: Solved) -> tuple[str, ...]:
        core = {args[0] for _, args, truth in solved.core if truth}
        return tuple(member for member in members if member in core)

    def _over(self) -> bool:
        return self._end is not None and self._clock() >= self._end


def _groups(model: Model) -> tuple[str, ...]:
    ranked = sorted((int(a.args[1]), str(a.args[0])) for a in model.atoms if a.name == "group")
    return tuple(name for _, name in ranked)
