"""Motion inside the search, against the same programs with everything worked out beforehand."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations, permutations, product
from pathlib import Path

import pytest

from reasoning.lessons import Key, Lesson, Lessons, Motion
from reasoning.motion.convex import Point
from reasoning.motion.judge import RoomJudge
from reasoning.motion.layout import Disc, Layout
from reasoning.motion.oracle import Oracle
from reasoning.motion.payload import PayloadPlanner
from reasoning.propagation import MotionPropagator, Names
from reasoning.solver import Program, Term, parse

MOVES = """
#program base.
#defined go/3.  #defined takes/3.  #defined longer/3.  #defined still/3.  #defined lengths/0.  #defined aim/2.
cell((0..3,0..2)).
stands(R,P,0) :- robot(R,P).
lies(E,P,0) :- thing(E,P).
#program step(t).
{ go(R,P,t-1) : cell(P) } 1 :- robot(R,_).
{ takes(R,E,t-1) : lies(E,P,t-1), stands(R,P,t-1) } 1 :- go(R,_,t-1).
stands(R,P,t) :- go(R,P,t-1).
stands(R,P,t) :- stands(R,P,t-1), not go(R,_,t-1).
moved(E,t-1) :- takes(R,E,t-1).
lies(E,P,t) :- takes(R,E,t-1), go(R,P,t-1).
lies(E,P,t) :- lies(E,P,t-1), not moved(E,t-1).
still(E,P,t-1) :- lies(E,P,t-1), not moved(E,t-1).
:- takes(R,E,t-1), takes(R',E,t-1), R < R'.
:- cell(P), 2 { lies(E,P,t) }.
:- cell(P), 2 { stands(R,P,t) }.
:- go(R,P,t-1), stands(R,P,t-1).
{ longer(R,K,t-1) : K = 2..5 } :- go(R,_,t-1), lengths.
{ query(t) }.
:- query(t), aim(E,P), not lies(E,P,t).
#show go/3.
#show takes/3.
#show longer/3.
"""
"""Robots go from cell to cell and may take along what lies where they are."""
BEFOREHAND = """
#program base.
#defined blocked/2.  #defined blocked/3.  #defined blocked/4.
#program step(t).
:- go(R,P',t-1), stands(R,P,t-1), blocked(P,P').
:- go(R,P',t-1), stands(R,P,t-1), blocked(P,P',A), still(_,A,t-1).
:- go(R,P',t-1), stands(R,P,t-1), blocked(P,P',A,B), still(_,A,t-1), still(_,B,t-1).
"""
NAMES = Names("stands", "go", "still", keys=2)
CELLS = [(x, y) for y in range(3) for x in range(4)]
WALL = ((1.9, 0.0), (2.1, 0.0), (2.1, 1.9), (1.9, 1.9))
ROOM = Layout(4, 3, (WALL,))
RADIUS_M, THING_M = 0.3, 0.25
LIMITS = (2, 3, 4, 5)


def point(place: Term) -> Point:
    x, y = parse(str(place))[1]
    return int(x) + 0.5, int(y) + 0.5


def disc(key: Key) -> Disc:
    return (*point(key[-1]), THING_M)


class Counting(RoomJudge):
    """Notes what it is asked."""

    def __init__(self, payload: PayloadPlanner | None = None, *, furniture_known: bool = False) -> None:
        super().__init__(
            Oracle(),
            ROOM,
            point=point,
            radius_m=lambda _: RADIUS_M,
            disc=disc,
            payload=payload,
            furniture_known=furniture_known,
        )
        self.questions: list[tuple[Motion, frozenset[Key]]] = []

    def lessons(self, motion: Motion, obstacles: frozenset[Key], limits: tuple[int, ...]) -> list[Lesson]:
        self.questions.append((motion, obstacles))
        return super().lessons(motion, obstacles, limits)


def beforehand() -> list[str]:
    """Every pair of cells with every arrangement of up to two things that leaves no way."""
    oracle, found = Oracle(), []
    for p, q in permutations(CELLS, 2):
        others = [c for c in CELLS if c not in (p, q)]
        for things in ((), *((c,) for c in others), *combinations(others, 2)):
            discs = [(x + 0.5, y + 0.5, THING_M) for x, y in things]
            ends = [(x + 0.5, y + 0.5) for x, y in (p, q)]
            if not oracle.path_exists(ROOM.with_discs(discs), RADIUS_M, *ends):
                found.append(f"blocked({','.join(f'({x},{y})' for x, y in (p, q, *things))}).")
    return found


def program(tmp_path: Path, extra: str, facts: Iterable[str]) -> Program:
    (tmp_path / "moves.lp").write_text(MOVES + extra)
    return Program([tmp_path / "moves.lp"], facts, ["-n0"])


def plans(loaded: Program) -> set[frozenset[str]]:
    with loaded.control.solve(yield_=True) as handle:
        return {frozenset(map(str, model.symbols(shown=True))) for model in handle}


def grown(loaded: Program, steps: int) -> Program:
    loaded.ground(("base", ()), *(("step", (t,)) for t in range(1, steps + 1)))
    return loaded


SITUATIONS = [
    (["robot(a,(0,0)).", "thing(x,(1,2))."], 2),
    (["robot(a,(0,0)).", "thing(x,(1,2)).", "thing(y,(2,2))."], 2),
    (["robot(a,(0,2)).", "thing(x,(1,1)).", "thing(y,(1,0))."], 2),
    (["robot(a,(0,0)).", "robot(b,(3,0)).", "thing(x,(2,2)).", "thing(y,(0,1))."], 1),
]


@pytest.mark.parametrize(("facts", "steps"), SITUATIONS)
def test_the_plans_are_those_of_exhaustive_precomputation(tmp_path: Path, facts: list[str], steps: int) -> None:
    expected = plans(grown(program(tmp_path, BEFOREHAND, [*facts, *beforehand()]), steps))
    loaded = program(tmp_path, "", facts)
    judge = Counting()
    loaded.register(MotionPropagator(NAMES, Lessons(judge)))
    assert plans(grown(loaded, steps)) == expected
    assert len(judge.questions) == len(set(judge.questions)) > 0


def test_what_the_program_knows_of_furniture_need_not_be_told(tmp_path: Path) -> None:
    facts, steps = SITUATIONS[2]
    known = beforehand()
    expected = plans(grown(program(tmp_path, BEFOREHAND, [*facts, *known]), steps))
    of_furniture = [fact for fact in known if len(parse(fact[:-1])[1]) == 2]
    loaded = program(tmp_path, BEFOREHAND, [*facts, *of_furniture])
    lessons = Lessons(Counting(furniture_known=True))
    loaded.register(MotionPropagator(NAMES, lessons))
    assert plans(grown(loaded, steps)) == expected
    assert all(lesson.obstacles for lesson in lessons.learned)


def test_lessons_are_short() -> None:
    """Of four things, only that in the gap between the halves of the room is a reason."""
    things = {"x": "(2,2)", "y": "(0,0)", "z": "(3,0)", "u": "(0,1)"}
    lesson, back = Counting().lessons(Motion((RADIUS_M,), ("(0,2)",), ("(3,1)",)), frozenset(things.items()), ())
    assert lesson.obstacles == {("x", "(2,2)")}
    assert lesson.longer is None
    assert back == Lesson(Motion((RADIUS_M,), ("(3,1)",), ("(0,2)",)), lesson.obstacles)


def test_an_exception_of_the_judge_ends_the_search(tmp_path: Path) -> None:
    class Broken(Counting):
        def lessons(self, motion: Motion, obstacles: frozenset[Key], limits: tuple[int, ...]) -> list[Lesson]:
            raise ZeroDivisionError("out of order")

    loaded = grown(program(tmp_path, ":- not go(_,_,0).", SITUATIONS[0][0]), 1)
    loaded.register(MotionPropagator(NAMES, Lessons(Broken())))
    with pytest.raises(RuntimeError, match="out of order"):
        loaded.solve([])


def test_searches_for_other_lengths_and_replans_ask_nothing_twice(tmp_path: Path) -> None:
    facts = ["robot(a,(0,0)).", "thing(x,(2,2)).", "thing(y,(3,0)).", "aim(y,(0,0))."]
    judge = Counting()
    lessons = Lessons(judge)

    def asking() -> Program:
        loaded = program(tmp_path, "", facts)
        loaded.register(MotionPropagator(NAMES, lessons))
        return loaded

    expected = shortest(program(tmp_path, BEFOREHAND, [*facts, *beforehand()]))
    assert shortest(asking()) == expected > 2  # the thing in the gap is taken away first
    learned = list(lessons.learned)
    assert shortest(asking()) == expected
    assert len(judge.questions) == len(set(judge.questions)) == lessons.asked
    assert lessons.learned[: len(learned)] == learned
    assert len(set(lessons.learned)) == len(lessons.learned)


def test_what_was_judged_is_forgotten_in_the_end_and_what_was_learned_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("reasoning.lessons.REMEMBERED", 1)
    judge = Counting()
    lessons = Lessons(judge)
    gap, free = Motion((RADIUS_M,), ("(1,0)",), ("(3,0)",)), Motion((RADIUS_M,), ("(0,0)",), ("(1,0)",))
    filled = frozenset({("x", "(2,2)")})
    (number,) = lessons.about(gap, filled)
    assert [lessons.about(free, filled), lessons.about(gap, filled), lessons.about(gap, frozenset())] == [
        [],
        [number],
        [],
    ]
    assert lessons.about(free, filled) == []
    assert len(judge.questions) > len(set(judge.questions))
    assert len(set(lessons.learned)) == len(lessons.learned)


def shortest(loaded: Program) -> int:
    loaded.ground(("base", ()))
    for steps in range(1, 9):
        loaded.ground(("step", (steps,)))
        if loaded.solve([("query", (steps,), True)]).satisfiable:
            return steps
    raise AssertionError("no plan")


@pytest.mark.parametrize("facts", [SITUATIONS[0][0], ["robot(a,(1,0)).", "thing(x,(1,2)).", "thing(y,(0,1))."]])
def test_what_is_longer_among_things_is_told(tmp_path: Path, facts: list[str]) -> None:
    """All models of one step: exactly the lengths that must be are in all of them."""
    loaded = program(tmp_path, "", [*facts, "lengths."])
    loaded.register(MotionPropagator(NAMES._replace(longer="longer"), Lessons(Counting(), limits=LIMITS)))
    found = plans(grown(loaded, 1))
    oracle = Oracle()
    (start,) = (parse(fact[:-1])[1][1] for fact in facts if fact.startswith("robot"))
    things = {str(e): p for e, p in (parse(fact[:-1])[1] for fact in facts if fact.startswith("thing"))}
    for (x, y), taken in product(CELLS, [None, *things]):
        goal = f"({x},{y})"
        told = {f"go(a,{goal},0)"} | ({f"takes(a,{taken},0)"} if taken else set())
        models = [m for m in found if {atom for atom in m if not atom.startswith("longer")} == told]
        others = {e: p for e, p in things.items() if e != taken}
        if goal == start or (taken and (things[taken] != start or goal in others.values())):
            assert not models
            continue
        still = [disc((e, p)) for e, p in others.items() if p not in (start, goal)]
        way = oracle.shortest(ROOM.with_discs(still), RADIUS_M, point(start), point(goal))
        assert bool(models) == (way is not None)
        if way is not None:
            needed = {f"longer(a,{k},0)" for k in LIMITS if way.length_m > k}
            assert {atom for atom in frozenset.intersection(*models) if atom.startswith("longer")} == needed
            assert len(models) == 2 ** (len(LIMITS) - len(needed))


def test_two_that_carry_a_thing_go_together_or_not_at_all(tmp_path: Path) -> None:
    """Not only each by itself must have a way, but both with what is between them."""
    loaded = program(tmp_path, "", ["robot(a,(0,1)).", "robot(b,(1,1)).", "pair(a,b,0).", "thing(x,(2,1))."])
    thing, starts = frozenset({("x", "(2,1)")}), ("(0,1)", "(1,1)")
    refused = 0
    with PayloadPlanner(Oracle(), budget=500) as payload:
        judge = Counting(payload)
        loaded.register(MotionPropagator(NAMES._replace(pair="pair"), Lessons(judge)))
        found = plans(grown(loaded, 1))
        for goals in permutations([f"({x},{y})" for x, y in CELLS], 2):
            ends = list(zip(starts, goals, strict=True))
            alone = [judge.lessons(Motion((RADIUS_M,), (p,), (q,)), thing, ()) for p, q in ends]
            together = judge.lessons(Motion((RADIUS_M, RADIUS_M), starts, goals), thing, ())
            possible = not (any(p == q for p, q in ends) or any(alone) or together)
            assert (frozenset(f"go({r},{q},0)" for r, q in zip("ab", goals, strict=True)) in found) == possible
            refused += bool(together) and not any(alone)
    assert refused
