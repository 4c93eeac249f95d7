"""Shortest plans: the published ones, those of the plain encoding, costs, conditions, and why there is none."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from ops.planning import solve
from ops.scenario import load
from reasoning import reference
from reasoning.checker import check
from reasoning.costs import bounded, cheapest
from reasoning.planner import Planner, predict
from reasoning.reasons import follow
from reasoning.setup import Refused, compile_setup
from reasoning.values import Found, Plan, Problem
from tests.encodings.housekeeping.rooms import DOMAIN, NIGHTSTAND, SHELF, problem, robot, thing

LONG = {"name": "rug", "kind": "cushion", "at": [0, 0], "end": [0, 1]}


def spent(start: Problem, units: int) -> Problem:
    return replace(start, state={**start.state, "elapsed": units})


def moved(start: Problem, place: str) -> Problem:
    """Where no scenario may put a robot, but perhaps a person did."""
    return replace(start, state={**start.state, "at(r1)": place})


def shortest(start: Problem) -> Found:
    """The shortest plan, which the checker accepts."""
    found = Planner(start).shortest(conflicts=200_000)
    if found.plan is not None:
        told = {"T1": found.plan.details}
        assert check(DOMAIN, start.static, {"T1": start.state}, {"T1": found.plan.steps}, details=told) == []
    return found


def plan_of(start: Problem) -> Plan:
    found = shortest(start)
    assert found.plan is not None, found.proof
    return found.plan


# ---------------------------------------------------------------- what is published
PUBLISHED = [("kitchen", 16), ("two_robots", 8), ("living_room", 8)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "steps"), PUBLISHED)
def test_the_published_lengths(name: str, steps: int) -> None:
    scenario = load(f"housekeeping/{name}")
    plan = solve(scenario, lambda _: None)
    assert (plan.status, plan.makespan, plan.refused) == ("optimal", steps, ())
    if name == "two_robots":
        assert "elapsed 14 is least: 13 is refuted for 8 steps" in plan.proof


def test_a_gap_that_is_too_narrow_is_why_there_is_no_plan() -> None:
    plan = solve(load("housekeeping/bedroom"), lambda _: None)
    assert plan.status == "infeasible"
    assert "there is no way between bed and nightstand" in plan.proof
    blind = solve(load("housekeeping/bedroom", ["house.geometry=none"]), lambda _: None)
    assert (blind.status, blind.makespan) == ("refused", 4)
    first = blind.refused[0]
    assert (first.rule, first.step) == ("no_way", 0)
    assert "bed and nightstand" in first.text


@pytest.mark.slow
def test_a_shortest_plan_that_knows_no_durations_misses_the_deadline() -> None:
    """With durations there is one of the same length that does not, see above."""
    blind = solve(load("housekeeping/kitchen", ["house.durations=none"]), lambda _: None)
    assert (blind.status, blind.makespan, blind.lower_bound) == ("refused", 16, 16)
    assert [(v.rule, v.text) for v in blind.refused] == [
        ("deadline", "30 units of time have passed at the end; the deadline is at 25")
    ]


@pytest.mark.parametrize(("name", "robots", "units", "too_few"), [("two_robots", 2, 27, 13), ("kitchen", 1, 23, 22)])
def test_no_plan_of_whatever_length_takes_fewer_units(name: str, robots: int, units: int, too_few: int) -> None:
    """Counted before any search; 14 units in 8 steps, the published figures, are the optimum of `two_robots`."""
    start = problem_of(name)
    assert Planner(bounded(start, "elapsed", too_few + 1)).hopeless() == ""
    assert Planner(bounded(start, "elapsed", too_few)).hopeless() == (
        f"the work takes {robots} robots {units} units at least, and the deadline is at {too_few}"
    )


def problem_of(name: str) -> Problem:
    """That of a shipped scenario with one team."""
    scenario = load(f"housekeeping/{name}")
    found = compile_setup(DOMAIN, scenario.setup)
    assert not isinstance(found, Refused)
    (state,) = found.states.values()
    return Problem(DOMAIN, found.static, state)


# ---------------------------------------------------------------- the plain encoding has the same optima
def drawn(seed: int) -> Problem:
    """A small room, with anything in it."""
    draw = random.Random(seed)
    cells = [(x, y) for x in range(4) for y in range(3)]
    robots = [
        robot(f"r{n}", *c, short_arm=int(draw.random() < 0.2), light_weight=int(draw.random() < 0.2))
        for n, c in enumerate(draw.sample(cells, draw.choice([1, 2, 2])))
    ]
    places = draw.sample(cells, 3)
    things = [
        thing(f"t{n}", *c, draw.choice(["cushion", "plate", "vase"]), raised=draw.randint(0, 1))
        for n, c in enumerate(places[: draw.randint(1, 2)])
    ]
    heavy = []
    if len(robots) == 2 and draw.random() < 0.5 and (0, 0) not in places and (1, 0) not in places:
        heavy = [{"name": "rug", "kind": "cushion", "at": [0, 0], "end": [1, 0]}]
        things = things[:1]
    exchange = [{"to": "kitchen", "area": [0, 1, 2, 2]}]
    level = draw.choice(["none", "static"])
    return problem(robots, things, heavy=heavy, exchange=exchange, deadline=draw.choice([0, 0, 6, 12]), level=level)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(24))
def test_the_plain_encoding_finds_the_same_lengths(seed: int) -> None:
    start = drawn(seed)
    ours = shortest(start)
    plain = reference.shortest(start, longest=ours.plan.makespan if ours.plan else 8)
    assert (ours.plan is None) == (plain.plan is None)
    if ours.plan is not None and plain.plan is not None:
        assert ours.plan.makespan == plain.plan.makespan
        assert check(DOMAIN, start.static, {"T1": start.state}, {"T1": plain.plan.steps}) == []


# ---------------------------------------------------------------- teams of two, costs and conditions
def test_two_robots_carry_what_is_heavy_together() -> None:
    plan = plan_of(problem([robot("r1", 1, 2), robot("r2", 2, 2)], heavy=[LONG], level="both"))
    assert plan.makespan == 4
    assert len(plan.steps[2]) == 2
    ends = {plan.states[-1]["at(rug)"], plan.states[-1]["end(rug)"]}
    assert ends == {"(3,0)", "(3,1)"}


@pytest.mark.parametrize(
    ("start", "why"),
    [
        (problem([robot("r1", 1, 2)], heavy=[LONG]), "rug needs two robots"),
        (problem([robot("r1", 0, 0, short_arm=1)], [thing("a", 1, 1)]), "a lies on the floor, and all arms are short"),
        (problem([], [thing("a", 1, 1)]), "a is to be moved, and nobody is built for it"),
        (problem([robot("r1", 1, 2, short_arm=1), robot("r2", 2, 2)], heavy=[LONG]),
         "rug lies on the floor, and needs two robots whose arms are not short"),
        (problem([robot("r1", 0, 0)], [thing("a", 1, 1), thing("b", 1, 2)], deposit=(3, 3, 0, 0)),
         "there are 1 places where 2 ends of things are to be"),
        (problem([robot("r1", 0, 0)], [thing("a", 1, 1, "plate")]), "a belongs in a room that no exchange area"),
        (problem([robot("r1", 0, 0)], [thing("a", 1, 1)], deadline=3), "1 robots 4 units at least"),
        (spent(problem([robot("r1", 0, 0)], [thing("a", 1, 1)], deadline=30), 31),
         "elapsed is 31 already, and may be 30 at most"),
        (moved(problem([robot("r1", 0, 0)], [thing("a", 3, 2)], furniture=[NIGHTSTAND], level="both"), "(1,0)"),
         "r1, at (1,0), cannot move: it would touch nightstand"),
        (moved(problem([robot("r1", 0, 0)], [thing("a", 3, 2)], furniture=[NIGHTSTAND], level="interleaved"), "(1,0)"),
         "r1, at (1,0), cannot move: it would touch nightstand"),
        (problem([robot("r1", 0, 0)], [thing("a", 1, 0)], furniture=[NIGHTSTAND], level="both"),
         "no robot can stand at a, at (1,0): it would touch nightstand"),
        (problem([robot("r1", 0, 1)], [thing("a", 2, 1)], furniture=[NIGHTSTAND, SHELF], level="static"),
         "r1 cannot get to a, at (2,1): there is no way between nightstand and shelf"),
        (problem([robot("r1", 0, 1)], [thing("a", 0, 2)], furniture=[NIGHTSTAND, SHELF], level="interleaved"),
         "a, at (0,2), cannot be brought to any place where it is to be: there is no way between"),
    ],
)  # fmt: skip
def test_what_is_out_of_reach_is_said_before_any_search(start: Problem, why: str) -> None:
    planner = Planner(start)
    assert why in planner.hopeless()
    assert planner.shortest().status == "infeasible"


def test_a_deadline_that_no_search_can_keep_ends_the_search() -> None:
    far = problem(
        [robot("r1", 0, 0)], [thing("a", 0, 2), thing("b", 1, 2)], deadline=9, size=(9, 3), deposit=(8, 8, 0, 1)
    )
    found = Planner(far).shortest()
    assert found.status == "infeasible"
    assert "deadline" in found.proof


def test_what_follows_is_predicted_also_when_the_deadline_has_passed() -> None:
    late = spent(problem([robot("r1", 0, 0)], [thing("a", 1, 1)], deadline=30), 31)
    plan, possible = predict(late, [(), ("goto(r1,1,1)",)])
    assert (possible, plan.states[-1]["elapsed"]) == (1, 31)


@pytest.mark.parametrize("level", ["none", "static", "interleaved", "both"])
def test_a_thing_that_is_in_its_place_needs_no_robot_there(level: str) -> None:
    """Nobody can stand at (0,0), where b is to be and lies already."""
    stool = {"name": "stool", "corners": [[0, 0], [20, 0], [20, 20], [0, 20]]}
    things = [thing("a", 3, 2), thing("b", 0, 0)]
    start = problem([robot("r1", 2, 2)], things, deposit=(0, 1, 0, 0), furniture=[stool], level=level)
    start = replace(start, static={**start.static, "radius(robot)": 45})
    assert plan_of(start).makespan == 4


@pytest.mark.parametrize("level", ["interleaved", "both"])
def test_the_least_time_is_that_of_the_ways_past_what_lies_in_them(level: str) -> None:
    """A thing in the middle of a corridor makes the straight way of 3 m longer. Without a deadline, too, the checker's
    time is the one that is proved to be the least."""
    start = problem([robot("r1", 0, 1)], [thing("a", 3, 1), thing("b", 1, 1)], deposit=(0, 1, 1, 1), level=level)
    start = replace(start, static={**start.static, "least(living_room)": "elapsed"})
    plan, proof = cheapest(start, plan_of(start), 4)
    assert proof.startswith(f"elapsed {plan.states[-1]['elapsed']} is least")
    (states,) = follow(DOMAIN, start.static, {"T1": start.state}, {"T1": plan.steps}).values()
    assert states[-1]["elapsed"] == plan.states[-1]["elapsed"]


def test_where_nothing_is_to_be_done_no_cost_is_refuted() -> None:
    tidy = problem([robot("r1", 0, 0)], [thing("a", 3, 1)], minimise="duration")
    assert cheapest(tidy, plan_of(tidy), 0) == (plan_of(tidy), "elapsed 0 is least: nothing is added to it")


def test_costs_are_lowered_until_the_next_lower_one_is_refuted() -> None:
    start = problem([robot("r1", 0, 0)], [thing("a", 3, 2)], size=(9, 3), deposit=(0, 8, 0, 1))
    least = Problem(DOMAIN, {**start.static, "least(living_room)": "elapsed"}, start.state)
    plan, proof = cheapest(least, plan_of(start), 4)
    assert plan.states[-1]["elapsed"] == 5
    assert proof == "elapsed 5 is least: 4 is refuted for 4 steps"
    few = Problem(DOMAIN, {**start.static, "least(living_room)": "attaches"}, start.state)
    assert cheapest(few, plan_of(start), 6)[1] == "attaches 1 is least: 0 is refuted for 6 steps"
    assert cheapest(start, plan_of(start), 4) == (plan_of(start), "")


def test_conditions_are_data() -> None:
    robots, things = [robot("r1", 0, 0)], [thing("a", 1, 1), thing("b", 0, 1)]
    for early, late in (("a", "b"), ("b", "a")):
        plan = plan_of(problem(robots, things, late=[{"thing": late, "steps": 3}]))
        assert plan.makespan == 8
        handled = [state[f"at({early})"] for state in plan.states]
        assert handled[4] == handled[-1]
    never = [{"robot": "r1", "from": [0, 0], "to": [1, 1]}, {"robot": "r1", "from": [0, 0], "to": [0, 1]}]
    assert plan_of(problem(robots, things, never=never)).makespan == 9


def test_what_is_in_the_way_is_moved_first_when_geometry_takes_part_in_the_search() -> None:
    """Three broad things in a row part the room: with them where they are, the fourth cannot be reached."""
    robots = [robot("r1", 0, 1)]
    row = [thing("a", 1, 0), thing("b", 1, 1), thing("c", 1, 2)]
    far = [*row, thing("d", 2, 1)]
    wide = {"deposit": (3, 4, 0, 1), "size": (5, 3)}

    def broad(level: str) -> Problem:
        start = problem(robots, far, level=level, **wide)
        return Problem(DOMAIN, {**start.static, "radius(thing)": 40}, start.state)

    for level in ("interleaved", "both"):
        plan = plan_of(broad(level))  # the checker, with its own geometry, agrees
        assert plan.makespan == 16
        assert plan.steps[0] != ("goto(r1,2,1)",)
