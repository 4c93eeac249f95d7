"""Why not: minimal clashes known by hand, and what must hold of every clash, checked by searches of the test's own."""

from __future__ import annotations

import re
import time
from collections.abc import Sequence
from itertools import count
from pathlib import Path

import pytest

from ops.cases import read_case
from reasoning import reference
from reasoning.domain import domains, load
from reasoning.planner import Planner
from reasoning.reasons import Make, contradicts, follow, never, no_plan, no_sharing, not_possible
from reasoning.solver import Program
from reasoning.values import Problem, Question
from reasoning.why import Clash, Possible, Unknown, explain
from tests.reasoning import published
from tests.reasoning.teams import DOMAIN, drawn, team

STAMPER = team([((2, 3), 3)], [(2, 2, 0)], carrier=None)
"""One box, at the last place where it can be worked on, and beside it who can finish it: 3 steps."""


def clash(make: Make) -> set[str]:
    """The members of a clash that was checked to the end."""
    found = explain(make)
    assert isinstance(found, Clash)
    assert found.checked
    assert not found.open
    return set(found.members)


def possible(make: Make, members: Sequence[str]) -> bool:
    """A search from scratch that knows nothing of the explanation's own searches; all else is left open."""
    solved = make().solve([("use", (member,), True) for member in members])
    assert solved.satisfiable is not None
    return solved.satisfiable


def check_minimal(make: Make) -> None:
    """Refuted all together, and possible without any one member."""
    members = clash(make)
    assert not possible(make, sorted(members))
    for member in members:
        assert possible(make, sorted(members - {member})), member


def allowed(make: Make) -> bool:
    """Can all members hold together? One search, which explains nothing."""
    program = make()
    free = program.solve([]).model
    assert free is not None
    solved = program.solve([("use", atom.args[:1], True) for atom in free.atoms if atom.name == "group"])
    assert solved.satisfiable is not None
    return solved.satisfiable


# ---------------------------------------------------------------- no plan
def test_the_line_does_not_move_while_the_box_is_stamped() -> None:
    assert clash(no_plan(STAMPER, 2, 3)) == {
        "stamped(1)", "gone(1)", "start(line(1),2)", "start(stage(1),2)", "rule(shift_at_work)", "steps(2)"
    }  # fmt: skip


def test_a_box_needs_a_step_for_each_place() -> None:
    finished = team([], [(2, 3, 0)], carrier=None)
    assert clash(no_plan(finished, 1, 2)) == {"gone(1)", "start(line(1),2)", "steps(1)"}


def test_a_wet_box_waits() -> None:
    wet = team([((3, 3), 2)], [(3, 1, 1)], carrier=None, size=(3, 3))
    assert "rule(work_wet)" not in clash(no_plan(wet, 3, 9))
    assert clash(no_plan(team([((2, 1), 1)], [(2, 0, 0)], carrier=None, size=(2, 1)), 2, 9)) >= {
        "stamped(1)",
        "steps(2)",
    }


def test_a_plan_that_exists_is_shown() -> None:
    found = explain(no_plan(STAMPER, 3, 4))
    assert isinstance(found, Possible)
    done = {(str(a.args[0]), int(a.args[1])) for a in found.model.atoms if a.name == "occurs"}
    assert {action for action, _ in done} >= {"workOn(w1,1)", "lineShift"}
    assert max(step for _, step in done) == 2


def test_the_way_without_a_rule_breaks_it() -> None:
    found = explain(no_plan(STAMPER, 2, 3))
    assert isinstance(found, Clash)
    way = found.without["rule(shift_at_work)"]
    assert "shift_at_work" in {str(a.args[0]) for a in way.atoms if a.name == "breach"}


def test_lending_and_borrowing() -> None:
    lender = team([((1, 3), 1), ((2, 3), 3)], [(2, 2, 0)], carrier=None)
    assert explain(no_plan(lender, 3, 4, ("lend", 0))).__class__ is Possible
    assert clash(no_plan(STAMPER, 3, 9, ("lend", 1))) >= {"lend(1)"}
    needy = team([], [(2, 2, 0)], carrier=None, guest="w1")
    assert "alone" in clash(no_plan(needy, 5, 9))
    assert explain(no_plan(needy, 5, 9, ("borrow", 0))).__class__ is Possible
    assert clash(no_plan(needy, 5, 9, ("borrow", 1))) >= {"borrow(1)", "stamped(1)", "steps(5)"}


@pytest.mark.parametrize(
    "seed", [1, 8, *(pytest.param(n, marks=pytest.mark.slow) for n in (0, 2, 3, 4, 5, 6, 7, 9, 10, 11))]
)
def test_every_clash_is_minimal_and_agrees_with_the_reference(seed: int) -> None:
    problem = drawn(seed, breaks=0.3)
    found = Planner(problem).shortest()
    if found.plan is None:
        assert found.status == "infeasible"
        return
    shortest = found.plan.makespan
    assert explain(no_plan(problem, shortest, shortest + 1)).__class__ is Possible
    if shortest == 0:
        return
    assert reference.answer(problem, Question("alone", shortest - 1)).verdict == "no"
    check_minimal(no_plan(problem, shortest - 1, shortest))


@pytest.mark.parametrize(
    ("problem", "expected"),
    [
        (team([], 1), {"stamped(1)", "start(stage(1),0)", "crew"}),
        (
            team([((1, 2), 1)], 1, carrier=None),
            {"stamped(1)", "start(stage(1),0)", "start(at(w1),(1,2))", "robot(w1)", "crew", "rule(work_row)",
             "rule(west_or_east)"},
        ),
        (
            team([((1, 3), 1)], [(1, 0, 0)]),
            {"stamped(1)", "start(stage(1),0)", "start(line(1),1)", "robot(w1)", "crew", "rule(work_column)",
             "rule(work_pit)"},
        ),
    ],
)  # fmt: skip
def test_what_can_never_be(problem: Problem, expected: set[str]) -> None:
    assert clash(never(problem)) == expected
    assert Planner(problem).hopeless()


def test_a_fixed_end_effector() -> None:
    one = team([((1, 3), 1)], 1)
    painter = Problem(one.domain, one.static, {**one.state, "fixed(w1)": 1})
    assert clash(not_possible(painter, "swapEndEffector(w1,2)")) == {
        "action(swapEndEffector(w1,2))", "robot(w1)", "start(fixed(w1),1)", "rule(swap_fixed)"
    }  # fmt: skip
    assert {"start(effector(w1),1)", "start(fixed(w1),1)", "rule(swap_fixed)", "rule(work_stage)"} < clash(
        never(painter)
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_what_has_a_plan_is_never_called_impossible(seed: int) -> None:
    problem = drawn(seed, breaks=0.3)
    if Planner(problem).shortest(conflicts=50_000).plan is not None:
        assert explain(never(problem)).__class__ is Possible


# ---------------------------------------------------------------- an action
FREE = team([((1, 3), 1), ((1, 2), 2)], [(2, 0, 0), (3, 1, 1)], carrier=(1, 1), guest="w3")
TIED = team([((1, 1), 1)], [(2, 0, 0)], carrier=(1, 1), tied="w1")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("problem", "action", "others", "expected"),
    [
        (FREE, "move(w1,left)", (), {"robot(w1)", "start(at(w1),(1,3))", "rule(off_grid)"}),
        (FREE, "move(w1,up)", (), {"robot(w1)", "rule(west_or_east)"}),
        (TIED, "workOn(w1,1)", (), {"robot(w1)", "start(at(w1),(1,1))", "rule(work_row)"}),
        (
            FREE, "attach(c1,w1)", (),
            {"robot(c1)", "robot(w1)", "start(at(c1),(1,1))", "start(at(w1),(1,3))", "rule(attach_apart)"},
        ),
        (FREE, "push(c1)", (), {"robot(c1)", "start(attached(c1),none)", "rule(free)"}),
        (FREE, "swapEndEffector(w1,1)", (), {"robot(w1)", "start(effector(w1),1)", "rule(swap_same)"}),
        (FREE, "takeRobot(w3,2,1)", (), {"robot(w3)", "rule(take_outside)"}),
        (FREE, "repair(c1)", (), {"robot(c1)", "rule(repair_whole)"}),
        (FREE, "repair(w9)", (), {"rule(unknown)"}),
        (FREE, "giveRobot(w1)", ("move(w1,right)",), {"robot(w1)", "beside(move(w1,right))", "rule(busy)"}),
        (TIED, "move(w1,right)", (), {"robot(w1)", "start(attached(c1),w1)", "rule(move_tied)"}),
    ],
)  # fmt: skip
def test_an_action_that_was_not_possible(
    problem: Problem, action: str, others: tuple[str, ...], expected: set[str]
) -> None:
    assert clash(not_possible(problem, action, others)) == {f"action({action})"} | expected


@pytest.mark.parametrize("action", ["move(w1,right)", "giveRobot(w1)", "swapEndEffector(w2,3)", "takeRobot(w3,1,1)"])
def test_an_action_that_was_possible(action: str) -> None:
    assert isinstance(explain(not_possible(FREE, action)), Possible)


def test_what_is_no_action_is_refused() -> None:
    with pytest.raises(ValueError, match="not an action: 'move"):
        not_possible(FREE, "move(w1,")


def test_following_the_published_plan_through_its_failure() -> None:
    setup, plan = published.load()
    states = follow(DOMAIN, setup.static, setup.states, plan, published.EXCHANGES, published.BREAKS)
    assert all(states[team][0] == dict(setup.states[team]) for team in plan)
    assert states["T4"][17]["attached(c1)"] == "none"
    assert states["T4"][17]["broken(c1)"] == 1
    assert "broken(c1)" not in states["T4"][18]
    assert all(states[team][-1]["stage(3)"] == 3 for team in plan)


# ---------------------------------------------------------------- a suspicion
def test_the_worker_whose_box_did_progress_is_cleared() -> None:
    case = read_case("factory/carrier_at_step_16").case
    seen = {"commanded(attach(c1,w1),0)", "seen(attached(c1),none)", "seen(stage(1),3)"}
    assert clash(contradicts(case, broken="w1")) == {"suspect(w1)", "most(1)", *seen}
    assert clash(contradicts(case, whole="c1")) == {"cleared(c1)", *seen}
    assert isinstance(explain(contradicts(case, broken="c1")), Possible)


def test_an_inspection_settles_it() -> None:
    case = read_case("factory/carrier_or_worker").case
    assert isinstance(explain(contradicts(case, broken="w1")), Possible)
    found = {"c1": "broken"}
    assert clash(contradicts(case, broken="w1", findings=found)) == {"suspect(w1)", "most(1)", "inspected(c1,broken)"}
    sound = {"w1": "sound"}
    assert clash(contradicts(case, broken="w1", findings=sound)) == {"suspect(w1)", "inspected(w1,sound)"}


# ---------------------------------------------------------------- sharing
def test_two_borrowers_and_one_lender_in_time() -> None:
    make = no_sharing(25, 2, ["A", "B", "C", "D"], alone=["A", "D"], early={"B": 3, "C": 17}, late={"A": 14, "D": 16})
    assert clash(make) == {'alone("A")', 'alone("D")', 'early("C",17)', 'late("A",14)', 'late("D",16)'}


def test_transport_is_named_where_it_matters() -> None:
    make = no_sharing(9, 2, ["A", "B"], alone=["A"], early={"B": 4}, late={"A": 5})
    assert clash(make) == {'alone("A")', 'early("B",4)', 'late("A",5)', "delay(2)"}
    assert isinstance(explain(no_sharing(9, 1, ["A", "B"], alone=["A"], early={"B": 4}, late={"A": 5})), Possible)


def test_roles_that_are_asked_about() -> None:
    make = no_sharing(9, 1, ["A", "B"], alone=["A"], early={"B": 4}, late={"A": 5}, may_not={"A": "borrow"})
    assert clash(make) == {'alone("A")', 'may_not("A",borrow)'}
    make = no_sharing(9, 1, ["A", "B"], alone=["A"], late={"A": 5, "B": 3}, must={"B": "borrow"})
    assert 'must("B",borrow)' in clash(make)


# ---------------------------------------------------------------- budgets, programs, words
def test_a_search_that_ends_early_says_how_far_it_got() -> None:
    problem = team([((1, 3), 1)], 1)
    assert isinstance(explain(no_plan(problem, 14, 15), seconds=0.0, clock=time.monotonic), Unknown)
    ticks = count()
    found = explain(no_plan(problem, 14, 15), seconds=12.0, clock=lambda: next(ticks))
    assert isinstance(found, Clash)
    assert not found.checked
    assert found.open
    assert not possible(no_plan(problem, 14, 15), found.members)


def test_what_is_impossible_without_any_member_is_an_error(tmp_path: Path) -> None:
    file = tmp_path / "wrong.lp"
    file.write_text("group(a,1). { use(G) } :- group(G,_). :- not use(b). #show group/2. use(c). :- use(c).")

    def make() -> Program:
        program = Program([file])
        program.ground(("base", ()))
        return program

    with pytest.raises(ValueError, match="no model"):
        explain(make)


def test_a_length_that_suffices_is_longer() -> None:
    with pytest.raises(ValueError, match="more than 3 steps"):
        no_plan(STAMPER, 3, 3)


@pytest.mark.parametrize("domain", [name for name in domains() if load(name).data.why])
def test_every_rule_has_words_and_every_header_is_there(domain: str) -> None:
    files = {one for entry in load(domain).folder.glob("why*.lp") for one in included(entry)}
    named = set()
    for file in sorted(files):
        text = file.read_text()
        assert text.startswith("% ")
        assert len(text.splitlines()) < 60
        for group in re.findall(r"^rule\(\(?([a-z_;]+)\)+\.$", text, re.MULTILINE):
            named |= set(group.split(";"))
    assert len(named) > 15
    assert named == set(load(domain).data.why["rule"])
    assert named <= load(domain).data.rules.keys()


def included(file: Path) -> set[Path]:
    """The file and all that it includes."""
    inner = re.findall(r'^#include "(.*)"\.$', file.read_text(), re.MULTILINE)
    return {file.resolve()}.union(*(included(file.parent / name) for name in inner))
