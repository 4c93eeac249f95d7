"""What single steps do in the planner's program, and what they may not; the checker says the same of each."""

from __future__ import annotations

import pytest

from reasoning.checker import check
from reasoning.planner import predict
from reasoning.values import Problem
from tests.encodings.housekeeping.rooms import DOMAIN, problem, robot, thing

ONE = problem([robot("r1", 0, 0)], [thing("book", 1, 1), thing("pad", 0, 2)])
AT = problem([robot("r1", 1, 1), robot("r2", 0, 0)], [thing("book", 1, 1), thing("pad", 0, 2)])
HELD = problem(
    [robot("r1", 1, 1), robot("r2", 0, 0)], [thing("book", 1, 1), thing("pad", 0, 2)], held={"r1": "grip(book,1)"}
)
SHORT = problem([robot("r1", 1, 1, short_arm=1)], [thing("book", 1, 1)])
RAISED = problem([robot("r1", 1, 1, short_arm=1)], [thing("book", 1, 1, raised=1)])
LONG = {"name": "rug", "kind": "cushion", "at": [0, 0], "end": [0, 1]}
RUG = problem([robot("r1", 0, 0), robot("r2", 0, 1)], heavy=[LONG])
WEAK = problem([robot("r1", 0, 0, light_weight=1), robot("r2", 0, 1)], heavy=[LONG])
BOTH = problem([robot("r1", 0, 0), robot("r2", 0, 1)], heavy=[LONG], held={"r1": "grip(rug,1)", "r2": "grip(rug,2)"})
HALL = problem([robot("r1", 0, 0)], [thing("vase", 0, 0, "vase")], size=(14, 2))
VASE = problem([robot("r1", 0, 0)], [thing("vase", 0, 0, "vase")], size=(14, 2), held={"r1": "grip(vase,1)"})
WARNED = problem([robot("r1", 0, 0)], never=[{"robot": "r1", "from": [0, 0], "to": [2, 0]}])
DEADLINE = problem([robot("r1", 0, 0)], size=(8, 2), deadline=1)


@pytest.mark.parametrize(
    ("start", "step", "changes"),
    [
        (ONE, "goto(r1,1,1)", {"at(r1)": "(1,1)", "elapsed": 1}),
        (ONE, "goto(r1,3,2)", {"at(r1)": "(3,2)", "elapsed": 2}),
        (ONE, "goto(r1,0,0)", None),
        (ONE, "goto(r1,4,0)", None),
        (ONE, "attach(r1)", None),
        (ONE, "detach(r1)", None),
        (AT, "attach(r1)", {"connected(r1)": "grip(book,1)", "elapsed": 1, "attaches": 1}),
        (AT, "attach(r1) goto(r1,2,2)", None),
        (AT, "goto(r2,1,1)", None),
        (AT, "goto(r2,1,1) goto(r1,0,0)", {"at(r1)": "(0,0)", "at(r2)": "(1,1)", "elapsed": 1}),
        (AT, "goto(r2,2,2) goto(r1,2,2)", None),
        (HELD, "goto(r1,2,2)", {"at(r1)": "(2,2)", "at(book)": "(2,2)", "elapsed": 1}),
        (HELD, "goto(r1,0,2)", None),  # the pad lies there
        (HELD, "detach(r1) goto(r2,2,0)", {"connected(r1)": "none", "at(r2)": "(2,0)", "elapsed": 1}),
        (HELD, "attach(r1)", None),
        (SHORT, "attach(r1)", None),
        (RAISED, "attach(r1)", {"connected(r1)": "grip(book,1)", "raised(book)": 0, "elapsed": 1, "attaches": 1}),
        (RUG, "attach(r1) attach(r2)",
         {"connected(r1)": "grip(rug,1)", "connected(r2)": "grip(rug,2)", "elapsed": 1, "attaches": 2}),
        (WEAK, "attach(r1)", None),
        (WEAK, "attach(r2)", {"connected(r2)": "grip(rug,2)", "elapsed": 1, "attaches": 1}),
        (BOTH, "goto(r1,2,1)", None),
        (BOTH, "goto(r1,2,1) goto(r2,3,2)", None),
        (BOTH, "goto(r1,2,1) goto(r2,3,1)",
         {"at(r1)": "(2,1)", "at(r2)": "(3,1)", "at(rug)": "(2,1)", "end(rug)": "(3,1)", "elapsed": 1}),
        (HALL, "goto(r1,12,0)", {"at(r1)": "(12,0)", "elapsed": 4}),
        (HALL, "goto(r1,12,1)", None),  # 12.04 m: more than four units
        (HALL, "goto(r1,13,0)", None),
        (VASE, "goto(r1,8,0)", {"at(r1)": "(8,0)", "at(vase)": "(8,0)", "elapsed": 4}),
        (VASE, "goto(r1,8,1)", None),  # 8.06 m; fragile: slower
        (VASE, "goto(r1,9,0)", None),
        (WARNED, "goto(r1,2,0)", None),
        (WARNED, "goto(r1,2,1)", {"at(r1)": "(2,1)", "elapsed": 1}),
        (DEADLINE, "goto(r1,3,0)", {"at(r1)": "(3,0)", "elapsed": 1}),
        (DEADLINE, "goto(r1,4,0)", None),
    ],
)  # fmt: skip
def test_what_one_step_does(start: Problem, step: str, changes: dict[str, int | str] | None) -> None:
    actions = tuple(step.split())
    plan, possible = predict(start, [actions])
    assert possible == (changes is not None)
    violations = check(DOMAIN, start.static, {"T1": start.state}, {"T1": [actions]})
    about_steps = [v for v in violations if v.action != "goal" or v.rule == "deadline"]
    assert bool(about_steps) == (changes is None), about_steps
    if changes is not None:
        before, after = plan.states
        assert {f: v for f, v in after.items() if before[f] != v} == changes
        assert before.keys() == after.keys() == start.state.keys()


def test_idle_steps_take_no_time() -> None:
    plan, possible = predict(ONE, [(), ("goto(r1,1,1)",), ()])
    assert possible == 3
    assert [state["elapsed"] for state in plan.states] == [0, 0, 1, 1]


def test_a_step_takes_as_long_as_its_longest_action() -> None:
    start = problem([robot("r1", 0, 0), robot("r2", 0, 1)], size=(9, 2))
    plan, _ = predict(start, [("goto(r1,1,0)", "goto(r2,8,1)")])
    assert plan.states[-1]["elapsed"] == 3
