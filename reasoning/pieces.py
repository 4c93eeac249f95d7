"""Geometry for explanations (`reasoning.why`): which pieces of furniture leave no way, so that they can be to blame.

It says what the planner's geometry says (`reasoning.geometry`), of rooms in which only some of the furniture stands:

- ``class(P,C)``: cells of one class can be reached from one another, whatever stands in the room; where a robot would
  touch furniture, each cell is a class of its own;
- ``cut(I,C,C')``: the furniture of set I leaves no way between two classes, less of it does;
- ``piece(I,N)``: piece N of the furniture is in set I; ``named(I,Text)``: all of them.

In the middle of the search, furniture is told like anything else that is in the way: piece N as ``solid(N)``, which
lies ``none``. What is learned names only the pieces that are needed.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import combinations_with_replacement

from reasoning import geometry
from reasoning.geometry import INTERLEAVED_LEVELS, LIMITS_M, NAMES, STATIC_LEVELS, Cell, Room, middle
from reasoning.lessons import Judge, Key, Lesson, Lessons, Motion
from reasoning.motion.layout import Layout
from reasoning.motion.oracle import Oracle
from reasoning.propagation import MotionPropagator
from reasoning.solver import Program, Term, parse, quoted
from reasoning.values import Problem

NOWHERE = "none"
Pieces = frozenset[str]


def facts(problem: Problem) -> list[str]:
    """What programs that explain are told of geometry."""
    known = geometry.room(problem.domain, problem.static, problem.state)
    return [] if known is None else list(_room_facts(known))


def interleave(problem: Problem, program: Program) -> None:
    """Let geometry take part in the program's searches, where the scenario lets planning know of it."""
    known = geometry.room(problem.domain, problem.static, problem.state)
    if known is not None and known.level in (*STATIC_LEVELS, *INTERLEAVED_LEVELS):
        program.register(MotionPropagator(NAMES, _lessons(known)))


@lru_cache(maxsize=8)
def _lessons(known: Room) -> Lessons:
    return Lessons(_Judge(known), LIMITS_M)


@lru_cache(maxsize=8)
def _room_facts(known: Room) -> tuple[str, ...]:
    cuts = _Cuts(known)
    found, sets = [], dict[Pieces, int]()
    classes = cuts.classes()
    found += [f"class(({x},{y}),{number})." for number, cells in enumerate(classes) for x, y in cells]
    for (a, one), (b, other) in combinations_with_replacement(enumerate(classes), 2):
        for pieces in cuts.between(one[0], other[0]):
            number = sets.setdefault(pieces, len(sets))
            found += [f"cut({number},{c},{d})." for c, d in sorted({(a, b), (b, a)})]
    for pieces, number in sets.items():
        found += [f"piece({number},{name})." for name in sorted(pieces)]
        found.append(f"named({number},{quoted(' and '.join(sorted(pieces)))}).")
    return tuple(found)


class _Cuts:
    """Which of the furniture leaves no way. Without geometry, robots go everywhere but to what furniture covers."""

    def __init__(self, known: Room) -> None:
        self._known, self._oracle = known, Oracle()
        self._radius_m = known.robot_m if known.level != "none" else 0.0
        self._all = frozenset(name for name, _ in known.furniture)

    def classes(self) -> list[list[Cell]]:
        layout = _layout(self._known, self._all)
        free: list[list[Cell]] = []
        alone: list[list[Cell]] = []
        for cell in self._known.cells:
            if not self._oracle.free(layout, self._radius_m, middle(cell)):
                alone.append([cell])
                continue
            own = next((cells for cells in free if not self._cut(self._all, cells[0], cell)), None)
            if own is None:
                free.append([cell])
            else:
                own.append(cell)
        return free + alone

    def between(self, p: Cell, q: Cell) -> list[Pieces]:
        """All sets of pieces that leave no way, and of which each piece is needed for that."""
        return minimal(self._all, lambda pieces: self._cut(pieces, p, q))

    def _cut(self, pieces: Pieces, p: Cell, q: Cell) -> bool:
        layout = _layout(self._known, pieces)
        if not all(self._oracle.free(layout, self._radius_m, middle(cell)) for cell in (p, q)):
            return True
        if self._known.level == "none":
            return False
        return not self._oracle.path_exists(layout, self._radius_m, middle(p), middle(q))


def minimal(names: Pieces, holds: Callable[[Pieces], bool]) -> list[Pieces]:
    """All minimal sets of names of which it holds; whatever holds of a set holds of larger ones."""
    found: list[Pieces] = []
    seen: set[Pieces] = set()
    waiting = [names]
    while waiting:
        some = waiting.pop()
        if some in seen:
            continue
        seen.add(some)
        least = next((known for known in found if known <= some), None)
        if least is None:
            if not holds(some):
                continue
            least = needed(some, holds)
            found.append(least)
        waiting += [some - {name} for name in sorted(least)]
    return sorted(found, key=sorted)


def needed(names: Pieces, holds: Callable[[Pieces], bool]) -> Pieces:
    """A set of those names of which it still holds, and of which it does not hold without any one."""
    for name in sorted(names):
        if holds(names - {name}):
            names -= {name}
    return names


class _Judge:
    """A `reasoning.lessons.Judge` for whom furniture is in the way like anything else. That a single robot has no way
    past furniture alone `facts` tells, so it is not told again, nor is how long a way is in an empty room."""

    def __init__(self, known: Room) -> None:
        self._known = replace(known, level="interleaved")
        self._judges: dict[Pieces, Judge] = {}

    def kind(self, body: Term) -> Hashable:
        return self._of(frozenset()).kind(body)

    def lessons(self, motion: Motion, obstacles: frozenset[Key], limits: tuple[int, ...]) -> Iterator[Lesson]:
        keys = {key: str(parse(str(key[0]))[1][0]) for key in obstacles if key[-1] == NOWHERE}
        things = obstacles - keys.keys()
        for lesson in self._of(frozenset(keys.values())).lessons(motion, things, limits):

            def holds(pieces: Pieces, lesson: Lesson = lesson) -> bool:
                asked = () if lesson.longer is None else (lesson.longer,)
                found = self._of(pieces).lessons(lesson.motion, lesson.obstacles, asked)
                return any(lesson._replace(obstacles=other.obstacles) == other for other in found)

            if len(motion.kinds) == 1 and not lesson.obstacles and lesson.longer is None:
                continue
            blamed = needed(frozenset(keys.values()), holds)
            said = lesson.obstacles | {key for key, name in keys.items() if name in blamed}
            if said or len(motion.kinds) > 1:
                yield lesson._replace(obstacles=said)

    def _of(self, pieces: Pieces) -> Judge:
        if pieces not in self._judges:
            furniture = tuple(one for one in self._known.furniture if one[0] in pieces)
            self._judges[pieces] = geometry.judge(replace(self._known, furniture=furniture))
        return self._judges[pieces]


@lru_cache(maxsize=256)
def _layout(known: Room, pieces: Pieces) -> Layout:
    return replace(known, furniture=tuple(one for one in known.furniture if one[0] in pieces)).layout
