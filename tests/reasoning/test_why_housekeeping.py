"""Why not, in rooms: what is known by hand, agreement with the planner, and which furniture is to blame."""

from __future__ import annotations

import random
import re
from dataclasses import replace
from pathlib import Path

import pytest

from reasoning.domain import load
from reasoning.geometry import middle, room
from reasoning.motion.oracle import Oracle
from reasoning.pieces import facts, minimal
from reasoning.planner import Planner, predict
from reasoning.reasons import follow, never, never_in_time, no_plan, not_possible, without_time
from reasoning.solver import Program, parse
from reasoning.values import Problem, Question
from reasoning.why import Clash, Possible, explain
from tests.encodings.housekeeping.rooms import DOMAIN, NIGHTSTAND, SHELF, problem, robot, thing
from tests.encodings.housekeeping.test_planning import LONG
from tests.reasoning.test_why import allowed, check_minimal, clash

ONE = problem([robot("r1", 0, 0)], [thing("a", 1, 1)], level="both")
PAIR = problem([robot("r1", 1, 2), robot("r2", 2, 2)], heavy=[LONG], level="both")
THERE = problem([robot("r1", 1, 1)], [thing("a", 1, 1)], level="both")
NEAR = {"place(a)", "start(connected(r1),none)", "robot(r1)", "free(r1)", "rule(attach_apart)", "rule(busy)"}


# ---------------------------------------------------------------- no plan
def test_four_steps_a_thing() -> None:
    assert clash(no_plan(ONE, 3, 4)) == {*NEAR, "start(at(a),(1,1))", "start(at(r1),(0,0))", "steps(3)"}
    assert isinstance(explain(no_plan(ONE, 4, 5)), Possible)


def test_a_deadline_that_is_too_early() -> None:
    late = problem([robot("r1", 0, 0)], [thing("a", 1, 1)], deadline=3)
    assert without_time(late) == problem([robot("r1", 0, 0)], [thing("a", 1, 1)])
    assert clash(never_in_time(late, 4)) == {*NEAR, "start(at(a),(1,1))", "start(at(r1),(0,0))", "deadline(3)"}


@pytest.mark.parametrize(
    ("start", "expected"),
    [
        (problem([], [thing("a", 1, 1)]), {"place(a)", "start(at(a),(1,1))", "crew"}),
        (problem([robot("r1", 1, 2)], heavy=[LONG]),
         {"place(rug)", "start(at(rug),(0,0))", "crew", "robot(r1)", "rule(alone)"}),
        (problem([robot("r1", 0, 0, short_arm=1)], [thing("a", 1, 1)]),
         {"place(a)", "start(at(a),(1,1))", "start(raised(a),0)", "start(short_arm(r1),1)", "crew", "robot(r1)",
          "rule(attach_floor)"}),
        (problem([robot("r1", 0, 0)], [thing("a", 1, 1), thing("b", 1, 2)], deposit=(3, 3, 0, 0)),
         {"place(a)", "place(b)", "rule(same_cell)"}),
        (problem([robot("r1", 0, 0)], [thing("a", 1, 0)], furniture=[NIGHTSTAND], level="both"),
         {"place(a)", "start(at(a),(1,0))", "crew", "robot(r1)", "solid(nightstand)", "rule(no_way)"}),
        (problem([robot("r1", 0, 1)], [thing("a", 2, 1)], furniture=[NIGHTSTAND, SHELF], level="static"),
         {"place(a)", "start(at(a),(2,1))", "start(at(r1),(0,1))", "crew", "robot(r1)", "solid(nightstand)",
          "solid(shelf)", "rule(no_way)"}),
    ],
)  # fmt: skip
def test_what_can_never_be(start: Problem, expected: set[str]) -> None:
    assert Planner(start).hopeless()
    found = clash(never(start))
    # A heavy thing has two ends, and either of them says that it is not where it belongs.
    assert {member.replace("end(rug),(0,1)", "at(rug),(0,0)") for member in found} == expected


def test_where_it_belongs_is_nowhere_near() -> None:
    plate = clash(never(problem([robot("r1", 0, 0)], [thing("a", 1, 1, "plate")])))
    assert plate == {"place(a)", "start(at(a),(1,1))", "belongs(a,kitchen)", "crew", "robot(r1)", "rule(no_way)"}


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 3, 4, 6])
def test_what_is_counted_follows_from_what_it_assumes(seed: int) -> None:
    """With whatever members: what is possible without the counting is possible with it."""
    rng = random.Random(seed)
    cells = rng.sample([(x, y) for x in range(3) for y in range(2)], 4)
    start = problem(
        [robot("r1", *cells[0]), robot("r2", *cells[1])][: 1 + seed % 2],
        [thing("a", *cells[2]), thing("b", *cells[3])],
        size=(3, 2),
        deposit=(rng.choice([0, 2]), 2, 0, 0),
        deadline=rng.choice([0, 5, 6, 7]),
    )
    within = 3 if seed % 2 else 7
    told = [f"static({key},{value})." for key, value in start.static.items()]
    told += [f"init({fluent},{value})." for fluent, value in start.state.items()]
    told += [*facts(start), f"limit({within}).", f"length({within};{within + 1})."]
    entry = load(DOMAIN).program("why")
    plain = entry.read_text().replace('#include "why_work.lp".\n', "")
    assert plain != entry.read_text()
    programs = [Program(files_of(text), told) for text in (entry.read_text(), plain)]
    for program in programs:
        program.ground(("base", ()), *(("step", (t,)) for t in range(1, within + 2)))
    free = programs[0].solve([]).model
    assert free is not None
    groups = sorted(str(atom.args[0]) for atom in free.atoms if atom.name == "group")
    verdicts = set()
    for _ in range(30):
        some = [("use", (group,), True) for group in groups if rng.random() < 0.96]
        counted, plainly = (program.solve(some).satisfiable for program in programs)
        assert counted == plainly, some
        verdicts.add(counted)
    assert verdicts == {True, False}


def files_of(text: str) -> list[Path]:
    return [load(DOMAIN).folder / name for name in re.findall(r'^#include "(.*)"\.$', text, re.MULTILINE)]


# ---------------------------------------------------------------- an action
@pytest.mark.parametrize(
    ("start", "action", "others", "expected"),
    [
        (ONE, "goto(r1,0,0)", (), {"robot(r1)", "start(at(r1),(0,0))", "rule(stays)"}),
        (ONE, "detach(r1)", (), {"robot(r1)", "start(connected(r1),none)", "rule(detach_free)"}),
        (THERE, "goto(r1,0,0)", ("attach(r1)",), {"robot(r1)", "beside(attach(r1))", "rule(busy)"}),
        (ONE, "sweep(r1)", (), {"rule(unknown)"}),
        (PAIR, "goto(r1,2,2)", (), {"robot(r1)", "robot(r2)", "start(at(r2),(2,2))", "rule(same_cell)"}),
    ],
)
def test_an_action_that_was_not_possible(
    start: Problem, action: str, others: tuple[str, ...], expected: set[str]
) -> None:
    assert clash(not_possible(start, action, others)) == {f"action({action})"} | expected


@pytest.mark.slow
@pytest.mark.parametrize("level", ["none", "static", "both"])
def test_the_planner_says_the_same_of_drawn_actions(level: str) -> None:
    """Robots stand anywhere, also where they touch the furniture and no scenario may put them."""
    rng, possible_ones = random.Random(level), 0
    for _ in range(12):
        cells = rng.sample([(x, y) for x in range(4) for y in range(3)], 4)
        (x, y), (u, v), (p, q), _ = cells
        set_up = problem(
            [robot("r1", 0, 0), robot("r2", 3, 2, short_arm=1)],
            [thing("a", p, q), thing("b", x, y, raised=1)],
            furniture=[NIGHTSTAND],
            level=level,
        )
        start = replace(set_up, state={**set_up.state, "at(r1)": f"({x},{y})", "at(r2)": f"({u},{v})"})
        action = rng.choice([f"goto(r1,{rng.randrange(4)},{rng.randrange(3)})", "attach(r1)", "attach(r2)"])
        _, kept = predict(start, [(action,)])
        assert allowed(not_possible(start, action)) == (kept == 1), (start.state, action)
        possible_ones += kept
    assert 0 < possible_ones < 12


# ---------------------------------------------------------------- agreement, and every clash
@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 2, 4))])
def test_every_clash_is_minimal_and_agrees_with_the_planner(seed: int) -> None:
    rng = random.Random(seed)
    cells = rng.sample([(x, y) for x in range(4) for y in range(3) if (x, y) != (1, 0)], 4)
    robots = [robot(f"r{i}", *cells[i]) for i in range(1 + seed % 2)]
    things = [thing("a", *cells[2]), thing("b", *cells[3])][: 2 - seed % 2]
    start = problem(robots, things, furniture=[NIGHTSTAND], level="both")
    found = Planner(start).shortest()
    assert found.plan is not None
    assert isinstance(explain(never(start)), Possible)
    shortest = found.plan.makespan
    assert isinstance(explain(no_plan(start, shortest, shortest + 1)), Possible)
    check_minimal(no_plan(start, shortest - 1, shortest))


@pytest.mark.slow
@pytest.mark.parametrize("level", ["none", "static", "interleaved", "both"])
def test_the_planner_says_the_same_of_drawn_rooms(level: str) -> None:
    """With furniture and deadlines, where robots and things start where a robot can stand."""
    rng, verdicts = random.Random(f"rooms {level}"), set()
    for _ in range(8):
        width, height = rng.choice([(4, 3), (9, 3), (14, 3)])
        at, by = 100 * rng.randrange(1, width), rng.choice([0, 90])
        shelf = {"name": "shelf", "corners": [[at, by], [at + 60, by], [at + 60, by + 200], [at, by + 200]]}
        free = [(x, y) for x in range(width) for y in range(height) if abs(100 * x + 50 - at - 30) > 60]
        one, two, three = rng.sample(free, 3)
        start = problem(
            [robot("r1", *one)],
            [thing("a", *two, kind=rng.choice(["cushion", "glass"])), thing("b", *three)][: rng.choice([1, 1, 2])],
            furniture=[shelf],
            level=level,
            size=(width, height),
            deposit=(0, 1, 0, height - 1),
            deadline=rng.choice([0, 5, 6, 8, 10]),
        )
        within = rng.choice([3, 4, 5, 8])
        answer = Planner(start).answer(Question("alone", within))
        assert allowed(no_plan(start, within, within + 1)) == (answer.verdict == "yes"), (start, within)
        verdicts.add(answer.verdict)
    assert verdicts == {"yes", "no"}


def test_a_thing_in_the_gap_between_two_pieces_of_furniture() -> None:
    wardrobe = {"name": "wardrobe", "corners": [[100, 200], [190, 200], [190, 300], [100, 300]]}
    start = problem([robot("r1", 0, 1)], [thing("a", 1, 1)], furniture=[NIGHTSTAND, wardrobe], level="both")
    assert clash(not_possible(start, "goto(r1,2,1)")) == {
        "action(goto(r1,2,1))", "start(at(r1),(0,1))", "start(at(a),(1,1))", "start(connected(r1),none)", "robot(r1)",
        "solid(nightstand)", "solid(wardrobe)", "rule(no_way)",
    }  # fmt: skip
    blind = problem([robot("r1", 0, 1)], [thing("a", 1, 1)], furniture=[NIGHTSTAND, wardrobe], level="static")
    assert isinstance(explain(not_possible(blind, "goto(r1,2,1)")), Possible)


# ---------------------------------------------------------------- geometry
def test_all_minimal_sets() -> None:
    blocking = [{"a", "b"}, {"b", "c"}, {"d"}]
    found = minimal(frozenset("abcde"), lambda some: any(one <= some for one in blocking))
    assert found == [frozenset(one) for one in sorted(blocking, key=sorted)]
    assert minimal(frozenset("abc"), lambda some: False) == []


def test_cuts_are_ways_that_are_not_there() -> None:
    start = problem([robot("r1", 0, 1)], [thing("a", 2, 1)], furniture=[NIGHTSTAND, SHELF], level="static")
    known = room(start.domain, start.static, start.state)
    assert known is not None
    told = [parse(fact[:-1]) for fact in facts(start)]
    classes = {str(args[0]): args[1] for name, args in told if name == "class"}
    cut = {(args[1], args[2]) for name, args in told if name == "cut"}
    oracle = Oracle()
    for x, y in known.cells:
        for u, v in known.cells:
            way = oracle.path_exists(known.layout, known.robot_m, middle((x, y)), middle((u, v)))
            assert way == ((classes[f"({x},{y})"], classes[f"({u},{v})"]) not in cut)


def test_following_a_plan_takes_the_time_of_its_ways() -> None:
    far = problem([robot("r1", 0, 0)], [thing("a", 3, 2)], size=(9, 3))
    states = follow(DOMAIN, far.static, {"T": far.state}, {"T": [("goto(r1,8,0)",), ("goto(r1,3,2)",)]})["T"]
    assert [state["elapsed"] for state in states] == [0, 3, 5]
    assert isinstance(explain(not_possible(far, "attach(r1)")), Clash)
