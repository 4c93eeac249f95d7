"""The one door to clingo.

Outside it, terms are plain: integers, and strings that hold constants and compound terms as written (``"w1"``,
``"(1,3)"``, ``"move(w1,right)"``); a quoted string comes out without its quotes. Solving is single-threaded with a
fixed seed, so equal input gives equal output. A message from the grounder is a bug in a program, and an error here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import clingo
from clingo import PropagateControl as PropagateControl
from clingo import PropagateInit as PropagateInit
from clingo import Propagator as Propagator

Term = int | str
SLICE_S = 0.2
"""How often a running search looks up, wall seconds."""


class SolverError(Exception):
    """A program is wrong: it does not parse, or grounding it gave a message."""


class Atom(NamedTuple):
    name: str
    args: tuple[Term, ...]


class Model(NamedTuple):
    """The shown atoms, sorted, and the costs by priority (empty without optimisation)."""

    atoms: tuple[Atom, ...]
    cost: tuple[int, ...] = ()


@lru_cache(maxsize=65536)
def parse(text: str) -> tuple[str, tuple[Term, ...]]:
    """Name and arguments of a written term: ``move(w1,right)`` gives ``("move", ("w1", "right"))``; the name of a
    tuple is empty.

    Raises ValueError for what is no compound term or constant, or has ``not`` for a name, which no program may.
    """
    try:
        symbol = clingo.parse_term(text)
    except RuntimeError as error:
        raise ValueError(f"not a term: {text!r}") from error
    if symbol.type != clingo.SymbolType.Function or not symbol.positive or _negates(symbol):
        raise ValueError(f"not an action or a fluent: {text!r}")
    return symbol.name, tuple(_plain(a) for a in symbol.arguments)


def _negates(symbol: clingo.Symbol) -> bool:
    """Is ``not`` a name in it? Such a term can be parsed by itself, but not as a part of a program."""
    return symbol.type == clingo.SymbolType.Function and (symbol.name == "not" or any(map(_negates, symbol.arguments)))


def quoted(text: str) -> str:
    """A string as a term of its own."""
    return str(clingo.String(text))


def models(
    files: Sequence[Path],
    facts: Iterable[str] = (),
    *,
    consts: Mapping[str, int] | None = None,
    limit: int = 0,
    optimum: bool = False,
) -> list[Model]:
    """Up to `limit` models (0: all) of the programs with these facts; with `optimum`, only one that is proved best.

    Raises SolverError when a program is wrong.
    """
    options = [f"-c{name}={value}" for name, value in (consts or {}).items()]
    options += ["--opt-mode=opt", "-n0"] if optimum else [f"-n{limit}"]
    loaded = Program(files, facts, options)
    loaded.ground(("base", ()))
    found: list[Model] = []
    with loaded.control.solve(yield_=True) as handle:
        for model in handle:
            if optimum:  # each is better than the one before it
                found.clear()
            found.append(_model(model))
    return found


Assumption = tuple[str, tuple[Term, ...], bool]


class Solved(NamedTuple):
    """`satisfiable` is None when the search was stopped. `conflicts` counts this search alone. `core` are assumptions
    that cannot hold together, when the search was unsatisfiable; not always the fewest."""

    satisfiable: bool | None
    model: Model | None
    conflicts: int
    core: tuple[Assumption, ...] = ()


class Program:
    """Loaded programs for multi-shot solving: `ground` parts as they are needed, `solve` under assumptions."""

    def __init__(
        self, files: Sequence[Path], facts: Iterable[str] = (), options: Sequence[str] = (), *, seed: int = 0
    ) -> None:
        """Raises SolverError when a program does not parse."""
        self._messages: list[str] = []
        # An exception in the logger would end the process: messages are kept and raised after the call.
        self.control = clingo.Control(
            ["--seed=0", "-t1", *options], lambda _, text: self._messages.append(text.strip())
        )
        with self._door():
            for file in files:
                self.control.load(str(file))
            self.control.add("base", [], "\n".join(facts))

    def ground(self, *parts: tuple[str, Sequence[int]]) -> None:
        """Ground parts with integer arguments. Raises SolverError on any message."""
        with self._door():
            self.control.ground([(name, [clingo.Number(a) for a in args]) for name, args in parts])

    def register(self, propagator: Propagator) -> None:
        """Let a propagator take part in every search from now on. An exception in it ends the search with a
        RuntimeError that says the same."""
        self.control.register_propagator(propagator)

    def solve(
        self,
        assumptions: Sequence[Assumption],
        *,
        conflicts: int | None = None,
        seconds: float | None = None,
        beat: Callable[[], None] = lambda: None,
        cancelled: Callable[[], bool] = lambda: False,
        told: bool = True,
    ) -> Solved:
        """One search under assumptions (name, arguments, truth), stopped by its budgets or by `cancelled`, which
        is asked every `SLICE_S`, as `beat` is called. A budget of seconds is kept to a few hundredths. Unless it is to
        be `told`, what a model says is not read, which may take longer than the search."""
        self.control.configuration.solve.solve_limit = "umax,umax" if conflicts is None else f"{conflicts},umax"  # type: ignore[union-attr]
        symbols = [(clingo.Function(name, [_symbol(a) for a in args]), truth) for name, args, truth in assumptions]
        found: list[Model] = []

        def keep(model: clingo.Model) -> bool:
            found.append(_model(model) if told else Model((), ()))
            return False

        left_s = float("inf") if seconds is None else seconds
        with self.control.solve(assumptions=symbols, on_model=keep, async_=True) as handle:
            while not handle.wait(max(min(SLICE_S, left_s), 0.0)):
                beat()
                left_s -= SLICE_S
                if cancelled() or left_s <= 0.0:
                    handle.cancel()
                    break
            result = handle.get()
            refuted = set(handle.core()) if result.unsatisfiable else set()
        done = None if result.satisfiable is None or (result.interrupted and not found) else bool(result.satisfiable)
        used = int(self.control.statistics["solving"]["solvers"]["conflicts"])
        core = self._told(assumptions, symbols, refuted) if done is False else ()
        return Solved(done, found[0] if found else None, used, core)

    def cheapest(self) -> Model | None:
        """A model that is proved best by the program's preferences; None when there is no model."""
        found = None
        self.control.configuration.solve.models = 0  # type: ignore[union-attr]
        self.control.configuration.solve.opt_mode = "opt"  # type: ignore[union-attr]
        with self.control.solve(yield_=True) as handle:
            for model in handle:
                found = _model(model)
        return found

    def within(self, cost: Sequence[int], *, limit: int = 0, project: bool = False) -> list[Model]:
        """Up to `limit` models (0: all) that cost at most so much, by priority; with `project`, one for each
        assignment of what the program projects on."""
        self.control.configuration.solve.models = limit  # type: ignore[union-attr]
        self.control.configuration.solve.opt_mode = ",".join(("enum", *map(str, cost)))  # type: ignore[union-attr]
        self.control.configuration.solve.project = "project,3" if project else "no"  # type: ignore[union-attr]
        with self.control.solve(yield_=True) as handle:
            return [_model(model) for model in handle]

    def _told(
        self, assumptions: Sequence[Assumption], symbols: Sequence[tuple[clingo.Symbol, bool]], refuted: set[int]
    ) -> tuple[Assumption, ...]:
        """The assumptions behind the solver's literals; one about an atom that does not exist cannot be true."""
        atoms = self.control.symbolic_atoms
        known = [(a, atoms[symbol], truth) for a, (symbol, truth) in zip(assumptions, symbols, strict=True)]
        return tuple(
            assumption
            for assumption, atom, truth in known
            if (truth if atom is None else (atom.literal if truth else -atom.literal) in refuted)
        )

    @contextmanager
    def _door(self) -> Iterator[None]:
        failed = None
        try:
            yield
        except RuntimeError as error:
            failed = error
        if failed is not None or self._messages:
            text = "; ".join(self._messages) or str(failed)
            self._messages.clear()
            raise SolverError(text) from failed


def program_literals(init: PropagateInit, name: str, arity: int) -> Iterator[tuple[tuple[Term, ...], int]]:
    """The arguments of all atoms of a predicate that a propagator may meet, with their literals in the program, which
    stay the same as long as nothing more is grounded."""
    for atom in init.symbolic_atoms.by_signature(name, arity):
        yield _arguments(str(atom.symbol)), atom.literal


@lru_cache(maxsize=1 << 18)
def _arguments(atom: str) -> tuple[Term, ...]:
    """The arguments of a written atom. Faster than to ask for each of them."""
    inside = atom[atom.index("(") + 1 : -1]
    if '"' in inside:
        return parse(atom)[1]
    arguments, depth, begin = [], 0, 0
    for at, letter in enumerate(inside + ","):
        if letter == "(":
            depth += 1
        elif letter == ")":
            depth -= 1
        elif letter == "," and depth == 0:
            arguments.append(inside[begin:at])
            begin = at + 1
    return tuple(int(text) if text.lstrip("-").isdigit() else text for text in arguments)


def _model(model: clingo.Model) -> Model:
    atoms = sorted(model.symbols(shown=True))
    return Model(tuple(Atom(a.name, tuple(_plain(x) for x in a.arguments)) for a in atoms), tuple(model.cost))


def _symbol(term: Term) -> clingo.Symbol:
    return clingo.Number(term) if isinstance(term, int) else clingo.parse_term(term)


def _plain(symbol: clingo.Symbol) -> Term:
    if symbol.type == clingo.SymbolType.Number:
        return symbol.number
    return symbol.string if symbol.type == clingo.SymbolType.String else str(symbol)
