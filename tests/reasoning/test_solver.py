"""The door to clingo: plain terms in and out, errors for any message, budgets and cancelling."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from reasoning.solver import Atom, Program, SolverError, models, parse, quoted

PIGEONS = """
#program base.
hole(1..9). pigeon(1..10).
#program step(t).
{ sits(P,H,t) : hole(H) } = 1 :- pigeon(P).
:- hole(H), 2 { sits(P,H,t) }, use(t).
{ use(t) }.
#show.
"""


def written(folder: Path, text: str) -> Path:
    file = folder / "program.lp"
    file.write_text(text)
    return file


def test_models_come_sorted_and_in_plain_terms(tmp_path: Path) -> None:
    file = written(tmp_path, '{ q(X) } :- p(X). p("a b"). #show q/1. #show r((1,x),f(Y),-3) : s(Y).')
    found = models([file], ["p(n).", "s(2)."])
    assert sorted(m.atoms for m in found) == sorted(
        (*(Atom("q", (x,)) for x in chosen), Atom("r", ("(1,x)", "f(2)", -3)))
        for chosen in [(), ("n",), ("a b",), ("n", "a b")]
    )


def test_limit_and_optimum_and_constants(tmp_path: Path) -> None:
    file = written(tmp_path, "#const n = 2. { q(1..n) }. #minimize { X,X : q(X) }. :- not q(_). #show q/1.")
    assert len(models([file], consts={"n": 3}, limit=1)) == 1
    (best,) = models([file], consts={"n": 3}, optimum=True)
    assert (best.atoms, best.cost) == ((Atom("q", (1,)),), (1,))


@pytest.mark.parametrize("text", ["p :- q.", "p(X) :- not q(X).", "p(", "p(X/0) :- X = 1."])
def test_any_message_is_an_error(tmp_path: Path, text: str) -> None:
    with pytest.raises(SolverError):
        models([written(tmp_path, text)])


def test_terms_are_parsed_and_strings_quoted() -> None:
    assert parse("move(w1,right)") == ("move", ("w1", "right"))
    assert parse("at((1,3),-2)") == ("at", ("(1,3)", -2))
    assert parse("shift") == ("shift", ())
    assert parse("(1,2)") == ("", (1, 2))
    said = 'say "hi"'
    assert parse(f"f({quoted(said)})") == ("f", (said,))
    assert parse('f("if not")') == ("f", ("if not",))
    for text in ("", "1", "f(", "-f", "f(X)", "a. b", "not", "f((1,g(not)))"):  # not is no name in a program
        with pytest.raises(ValueError, match="not a"):
            parse(text)


def test_assumptions_decide_what_is_asked_and_the_program_can_grow(tmp_path: Path) -> None:
    file = written(tmp_path, "#program base. #defined p/1. #program step(t). { p(t) }. :- p(t), p(t-1).")
    program = Program([file])
    program.ground(("base", ()), ("step", (1,)))
    assert program.solve([("p", (1,), True)]).satisfiable
    program.ground(("step", (2,)))
    assert not program.solve([("p", (1,), True), ("p", (2,), True)]).satisfiable
    assert program.solve([("p", (1,), False), ("p", (2,), True)]).satisfiable


def test_a_budget_of_conflicts_ends_a_search_the_same_way_every_time(tmp_path: Path) -> None:
    ends = []
    for _ in range(2):
        program = Program([written(tmp_path, PIGEONS)])
        program.ground(("base", ()), ("step", (1,)))
        ends.append(program.solve([("use", (1,), True)], conflicts=2000))
    assert ends[0] == ends[1]
    assert (ends[0].satisfiable, ends[0].model) == (None, None)
    assert 2000 <= ends[0].conflicts < 2100
    assert program.solve([("use", (1,), True)], conflicts=0).satisfiable is None
    assert program.solve([("use", (1,), False)]).satisfiable


def test_a_search_beats_and_can_be_cancelled_or_timed_out(tmp_path: Path) -> None:
    program = Program([written(tmp_path, PIGEONS)])
    program.ground(("base", ()), ("step", (1,)))
    beats: list[int] = []
    asked = itertools.count()
    stopped = program.solve([("use", (1,), True)], beat=lambda: beats.append(1), cancelled=lambda: next(asked) >= 1)
    assert stopped.satisfiable is None
    assert len(beats) == 2
    assert program.solve([("use", (1,), True)], seconds=0.2).satisfiable is None
