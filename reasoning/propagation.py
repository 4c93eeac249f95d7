"""Motion inside the search: a propagator that asks a judge about the motions the search commits to, and learns.

How a domain uses it. Its program says, for each step T, what is there; predicates are told in `Names`:

- ``at(R,P,T)``       body R is at P before step T;
- ``goes(R,P,T)``     in step T it goes to P;
- ``still(K...,T)``   an obstacle, of one or more arguments, is in the way in step T: what moves then is none;
- ``longer(R,K,T)``   optional: the way of R in step T is longer than K metres. A choice of the program, for each K that
  matters: ``{ longer(R,(3;6;9),t-1) } :- goes(R,t-1).`` The propagator makes it true where it must be;
- ``pair(R,R',T)``    optional: in step T the two carry one thing.

`Lessons` holds what was learned, outside of any solver, and is handed to the searches for other lengths, other
questions and replans as long as the same judge speaks of the same room::

    lessons = Lessons(judge, limits=(3, 6, 9))
    program.register(MotionPropagator(Names("stands", "go", "lies_still"), lessons))

A lesson is about kinds of bodies, not bodies, and about no step in particular: each is a clause for every step and
every body of its kind. The judge is asked for partial assignments, with the obstacles that are there for sure, which
can only become more; and for total ones, so that no model is wrong.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from reasoning.lessons import Bodies, Key, Lesson, Lessons, Motion
from reasoning.solver import PropagateControl, PropagateInit, Propagator, Term, program_literals


class Names(NamedTuple):
    """The predicates of the domain's program; an optional one that is missing is ""."""

    at: str
    goes: str
    still: str
    keys: int = 2
    """How many arguments of `still` are the obstacle's key."""
    longer: str = ""
    pair: str = ""


class MotionPropagator(Propagator):
    """Takes part in the searches of one solver; see the head of this file."""

    def __init__(self, names: Names, lessons: Lessons) -> None:
        self._names, self._lessons = names, lessons
        self._added: set[tuple[int, Bodies, int]] = set()
        self._grounded = -1
        self._atoms: dict[str, list[Atom]] = {}

    # ---------------------------------------------------------------- called by the solver
    def init(self, init: PropagateInit) -> None:
        """Before each search: which literals there are, and what was learned before, as clauses."""
        names = self._names
        if len(init.symbolic_atoms) != self._grounded:  # to read them takes longer than most searches do
            self._grounded = len(init.symbolic_atoms)
            arities = dict.fromkeys((names.at, names.goes, names.pair, names.longer), 3)
            arities[names.still] = names.keys + 1
            self._atoms = {name: _atoms(init, name, arity) for name, arity in arities.items() if name}
        tables = (Table(init, self._atoms.get(name, ())) for name in (names.at, names.goes, names.still))
        self._at, self._goes, self._still = tables
        self._pair, self._longer = (Table(init, self._atoms.get(name, ())) for name in (names.pair, names.longer))
        self._watched: dict[int, list[tuple[Table, int, Key]]] = {}
        for table in (self._at, self._goes, self._still, self._pair):
            for literal, step, key in table.open():
                init.add_watch(literal)
                self._watched.setdefault(literal, []).append((table, step, key))
        self._bodies = sorted({key[0] for keys in self._goes.literals.values() for key in keys}, key=str)
        self._waiting: list[list[int]] = []
        self._spread = len(self._lessons.learned)
        for number, lesson in enumerate(self._lessons.learned):
            for bodies, step in self._places(lesson.motion):
                clause = self._clause(lesson, bodies, step)
                if clause and (number, bodies, step) not in self._added:
                    self._added.add((number, bodies, step))
                    if not init.add_clause(clause):
                        return

    def propagate(self, control: PropagateControl, changes: Iterable[int]) -> None:
        """What is true now."""
        touched = set()
        for literal in changes:
            for table, step, key in self._watched[literal]:
                table.now.setdefault(step, set()).add(key)
                touched.add(step)
        self._look(control, sorted(touched))

    def check(self, control: PropagateControl) -> None:
        """Everything is decided: look at all steps."""
        self._look(control, sorted(self._goes.literals))

    # ---------------------------------------------------------------- what it does
    def _look(self, control: PropagateControl, steps: Iterable[int]) -> None:
        """Ask about what bodies do in these steps, as far as that is known. It ends when the search must go back."""
        if not self._flush(control):
            return
        for step in steps:
            going = self._goes.true(step, control)
            if not going:
                continue
            obstacles = frozenset(self._still.true(step, control))
            where = {key[0]: key[1] for key in self._at.true(step, control)}
            whither = {key[0]: key[1] for key in going}
            teams = [(body,) for body in whither] + list(self._pair.true(step, control))
            for bodies in sorted(teams, key=str):
                if all(body in where and body in whither for body in bodies):
                    self._ask(bodies, step, where, whither, obstacles, control)
            if not self._flush(control):
                return

    def _ask(
        self,
        bodies: Bodies,
        step: int,
        where: dict[Term, Term],
        whither: dict[Term, Term],
        obstacles: frozenset[Key],
        control: PropagateControl,
    ) -> None:
        lessons = self._lessons
        kinds = tuple(map(lessons.judge.kind, bodies))
        motion = Motion(kinds, tuple(where[b] for b in bodies), tuple(whither[b] for b in bodies))
        for number in lessons.about(motion, obstacles):
            clause = self._clause(lessons.learned[number], bodies, step)
            if clause and not any(map(control.assignment.is_true, clause)):
                self._waiting.append(clause)
        while self._spread < len(lessons.learned):  # what is new, for all steps and bodies
            lesson = lessons.learned[self._spread]
            clauses = (self._clause(lesson, *place) for place in self._places(lesson.motion) if place != (bodies, step))
            self._waiting.extend(clause for clause in clauses if clause)
            self._spread += 1

    def _flush(self, control: PropagateControl) -> bool:
        """Add the clauses that wait; False when the search must go back first."""
        if not self._waiting:
            return True
        while self._waiting:
            # Locked: they hold for ever, and stay when the solver forgets what it learned itself.
            if not control.add_clause(self._waiting.pop(0), lock=True):
                return False
        return control.propagate()

    def _places(self, motion: Motion) -> Iterator[tuple[Bodies, int]]:
        """All bodies of these kinds, at all steps."""
        kind = self._lessons.judge.kind
        for step in sorted(self._goes.literals):
            teams = (
                [(b,) for b in self._bodies] if len(motion.kinds) == 1 else sorted(self._pair.literals.get(step, {}))
            )
            for bodies in teams:
                if tuple(map(kind, bodies)) == motion.kinds:
                    yield bodies, step

    def _clause(self, lesson: Lesson, bodies: Bodies, step: int) -> list[int]:
        """The lesson for these bodies in this step; empty when it cannot come to that, or the program does not care."""
        (_, starts, goals), obstacles, longer = lesson
        at, goes, still = (table.literals.get(step, {}) for table in (self._at, self._goes, self._still))
        literals = [at.get((body, place)) for body, place in zip(bodies, starts, strict=True)]
        literals += [goes.get((body, place)) for body, place in zip(bodies, goals, strict=True)]
        literals += [still.get(key) for key in sorted(obstacles, key=str)]
        if len(bodies) == 2:
            literals.append(self._pair.literals.get(step, {}).get(bodies))
        clause = [-literal for literal in literals if literal is not None]
        if len(clause) < len(literals):
            return []
        if longer is None:
            return clause
        told = self._longer.literals.get(step, {}).get((bodies[0], longer))
        return [] if told is None else [*clause, told]


Atom = tuple[int, Key, int]
"""Its step, its arguments before the step, and its literal in the program."""


def _atoms(init: PropagateInit, name: str, arity: int) -> list[Atom]:
    found = program_literals(init, name, arity)
    return [(step, tuple(key), literal) for (*key, step), literal in found if isinstance(step, int)]


class Table:
    """The atoms of a predicate: for each step, their arguments before the step and their literals."""

    def __init__(self, init: PropagateInit, atoms: Iterable[Atom]) -> None:
        self.literals: dict[int, dict[Key, int]] = {}
        self.now: dict[int, set[Key]] = {}
        """Those that are true, and maybe some that were."""
        fixed = init.assignment
        self._open: list[tuple[int, int, Key]] = []
        for step, key, atom in atoms:
            literal = init.solver_literal(atom)
            if fixed.is_false(literal):
                continue
            self.literals.setdefault(step, {})[key] = literal
            if fixed.is_true(literal):
                self.now.setdefault(step, set()).add(key)
            else:
                self._open.append((literal, step, key))

    def open(self) -> list[tuple[int, int, Key]]:
        """Literal, step and arguments of those that are not decided before the search."""
        return self._open

    def true(self, step: int, control: PropagateControl) -> list[Key]:
        """The arguments of what is true in a step, sorted."""
        now, literals, is_true = self.now.get(step, set()), self.literals.get(step, {}), control.assignment.is_true
        now.difference_update([key for key in now if not is_true(literals[key])])
        return sorted(now, key=str)
