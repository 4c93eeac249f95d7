"""The checker accepts the published run, and refuses copies of it that are spoiled in each single rule."""

from __future__ import annotations

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from reasoning.checker import Break, Exchange, check, examine
from reasoning.domain import load as load_domain
from reasoning.planner import predict
from reasoning.values import Problem, Step, Violation
from tests.reasoning import published
from tests.reasoning.published import BREAKS, DETAILS, DOMAIN, EXCHANGES
from tests.reasoning.simulator import ROBOT_ARGUMENTS, judge
from tests.reasoning.spoiling import Spoiled

SETUP, STEPS = published.load()


def verdict(plan: dict[str, list[Step]], **given: object) -> list[Violation]:
    given = {"breaks": BREAKS, **given}
    return check(DOMAIN, SETUP.static, SETUP.states, plan, **given)  # type: ignore[arg-type]


def test_the_published_run_is_right_and_its_failed_attach_is_the_only_discrepancy() -> None:
    result = examine(DOMAIN, SETUP.static, SETUP.states, STEPS, breaks=BREAKS)
    assert result.violations == ()
    assert [(d.team, d.step, d.action) for d in result.discrepancies] == [("T4", 16, "attach(c1,w1)")]


def test_told_exchanges_and_effectors_are_accepted_as_well() -> None:
    assert verdict(STEPS, exchanges=EXCHANGES, details=DETAILS) == []


def test_without_the_break_the_repair_is_the_first_thing_wrong_besides_what_the_attach_did() -> None:
    rules = {(v.team, v.step, v.action, v.rule) for v in verdict(STEPS, breaks=())}
    assert ("T4", 17, "repair(c1)", "repair_whole") in rules
    assert all(team == "T4" and step >= 17 for team, step, _, _ in rules)


def test_an_effector_that_does_not_fit_is_told_where_it_matters() -> None:
    details = {**DETAILS, "T1": {(13, "takeRobot(w2,1,2)"): {"effector": 2}}}
    assert {v.rule for v in verdict(STEPS, details=details)} == {"work_stage", "goal_stage"}


TAKE = "takeRobot(w2,1,2)"
GOAL = 27
SPOILED = [
    Spoiled("unknown", "T1", 7, add=("fly(w1)",)),
    Spoiled("unknown", "T1", 7, add=("workOn(w1,9)",)),
    Spoiled("unknown", "T1", 7, add=("swapEndEffector(w1,4)",)),
    Spoiled("unknown", "T1", 7, add=("giveRobot(c1)",)),
    Spoiled("unknown", "T1", 7, add=("move(w1",)),
    Spoiled("absent", "T1", 7, add=("move(w2,left)",)),
    Spoiled("off_grid", "T1", 7, add=("move(c1,left)",)),
    Spoiled("off_grid", "T2", 2, ("push(c1)",), ("pull(c1)",)),
    Spoiled("off_grid", "T1", 20, add=("push(c1)",)),
    Spoiled("west_or_east", "T1", 7, add=("move(w1,down)",)),
    Spoiled("move_tied", "T2", 12, add=("move(w2,right)",)),
    Spoiled("move_tied", "T2", 12, add=("move(c1,right)",)),
    Spoiled("attach_apart", "T1", 7, add=("attach(c1,w1)",)),
    Spoiled("attach_tied", "T2", 12, add=("attach(c1,w1)",)),
    Spoiled("free", "T1", 7, add=("detach(c1)",)),
    Spoiled("free", "T1", 7, add=("push(c1)",)),
    Spoiled("free", "T1", 7, add=("pull(c1)",)),
    Spoiled("swap_outside", "T1", 7, add=("swapEndEffector(w1,2)",)),
    Spoiled("swap_fixed", "T1", 14, fixed="w1"),
    Spoiled("take_kind", "T2", 11, fixed="w3", found_at=("T1", 13), exchanges=EXCHANGES),
    Spoiled("swap_same", "T1", 14, ("swapEndEffector(w1,2)",), ("swapEndEffector(w1,1)",)),
    Spoiled("work_row", "T2", 4, add=("workOn(w2,1)",)),
    Spoiled("work_pit", "T1", 14, add=("workOn(w1,1)",)),
    Spoiled("work_column", "T1", 7, add=("workOn(w1,1)",)),
    Spoiled("work_stage", "T1", 10, ("move(w1,left)",), ("workOn(w1,3)",)),
    Spoiled("work_wet", "T1", 4, ("move(w1,right)",), ("workOn(w1,1)",)),
    Spoiled("work_together", "T2", 8, add=("workOn(w2,2)",)),
    Spoiled("shift_at_work", "T1", 3, add=("lineShift",)),
    Spoiled("give_outside", "T1", 7, add=("giveRobot(w1)",)),
    Spoiled("give_tied", "T2", 12, add=("giveRobot(w2)",)),
    Spoiled("take_outside", "T1", 13, (TAKE,), ("takeRobot(w2,2,2)",)),
    Spoiled("take_present", "T1", 20, add=("takeRobot(w1,1,1)",)),
    Spoiled("take_present", "T1", 7, add=("takeRobot(c1,1,2)",)),
    Spoiled("take_nobody", "T2", 11, ("giveRobot(w3)",), found_at=("T1", 13)),
    Spoiled("take_nobody", "T1", 13, exchanges=EXCHANGES[1:]),
    Spoiled("take_nobody", "T2", 11, add=("move(w3,right)",), found_at=("T1", 13)),
    Spoiled(
        "take_own",
        "T2",
        15,
        add=("takeRobot(w9,1,1)",),
        exchanges=(EXCHANGES[1], Exchange("w3", "T2", 11, "T2", 15, "w9")),
    ),
    Spoiled("take_early", "T1", 12, add=(TAKE,), also=("T1", 13, TAKE)),
    Spoiled("take_twice", "T1", 13, exchanges=(EXCHANGES[0], Exchange("w3", "T2", 11, "T4", 18, "w2"))),
    Spoiled("two_robots", "T1", 13, exchanges=(*EXCHANGES, Exchange("w1", "T3", 10, "T1", 13, "w2"))),
    Spoiled("exchange_no_give", "T2", 10, exchanges=(EXCHANGES[1], Exchange("w3", "T2", 10, "T1", 13, "w2"))),
    Spoiled("exchange_no_give", "T2", 0, exchanges=(EXCHANGES[1], Exchange("w3", "T2", 0, "T1", 13, "w2"))),
    Spoiled("exchange_no_take", "T1", 14, exchanges=(EXCHANGES[1], Exchange("w3", "T2", 11, "T1", 14, "w2"))),
    Spoiled("repair_whole", "T1", 7, add=("repair(c1)",)),
    Spoiled("broken", "T4", 17, ("repair(c1)",), found_at=("T4", 18)),
    Spoiled("busy", "T1", 6, add=("move(w1,left)",)),
    Spoiled("busy", "T4", 17, add=("detach(c1)",)),
    Spoiled("busy", "T1", 13, add=("attach(c1,w2)",)),
    Spoiled("busy", "T2", 11, add=("attach(c1,w3)",)),
    Spoiled("busy", "T2", 7, add=("workOn(w2,1)",)),
    Spoiled("twice", "T1", 14, add=("swapEndEffector(w1,3)",)),
    Spoiled("twice", "T2", 6, add=("attach(c1,w3)",)),
    Spoiled("same_cell", "T2", 9, ("workOn(w1,4)", "move(w3,left)"), ("move(w1,left)", "move(w3,right)")),
    Spoiled("change_cells", "T3", 9, ("move(w1,left)",), ("move(w1,right)",)),
    Spoiled("cell_taken", "T2", 10, ("move(w3,left)",)),
    Spoiled("goal_stage", "T1", 24, ("workOn(w2,4)",), found_at=("T1", GOAL)),
    Spoiled("goal_line", "T1", 26, ("lineShift",), found_at=("T1", GOAL)),
]


@pytest.mark.slow
@pytest.mark.parametrize("spoiled", SPOILED, ids=lambda s: f"{s.rule}-{s.team}-{s.step}")
def test_a_copy_spoiled_in_one_rule_is_refused_for_that_rule(spoiled: Spoiled) -> None:
    plan = spoiled.of(STEPS)
    fixed = {spoiled.team: {f"fixed({spoiled.fixed})": 1}} if spoiled.fixed else {}
    states = {name: {**state, **fixed.get(name, {})} for name, state in SETUP.states.items()}
    details = DETAILS if spoiled.rule == "take_kind" else None
    found = check(DOMAIN, SETUP.static, states, plan, breaks=BREAKS, exchanges=spoiled.exchanges, details=details)
    team, at = spoiled.found_at or (spoiled.team, spoiled.step)
    assert spoiled.rule in {v.rule for v in found if (v.team, v.step) == (team, at)}
    assert all(v.text for v in found)
    if spoiled.exchanges is None:
        assert min(v.step for v in found) >= min(spoiled.step, at), "nothing is wrong before the place that was spoiled"


def test_every_rule_has_its_row_and_its_words() -> None:
    assert {s.rule for s in SPOILED} == set(load_domain(DOMAIN).data.rules)


def test_goal_rules_are_told_alone_when_nothing_else_is_wrong() -> None:
    plan = {**STEPS, "T1": [*STEPS["T1"][:-1], ()]}
    assert [(v.team, v.step, v.rule, v.text) for v in verdict(plan)] == [
        ("T1", GOAL, "goal_line", "the last box, 4, is at line position 1 at the end, not at 0")
    ]


def test_a_team_without_a_plan_stays_idle() -> None:
    found = verdict({}, breaks=())
    assert {(v.step, v.rule) for v in found} == {(0, "goal_stage"), (0, "goal_line")}


def test_a_lone_borrower_takes_a_robot_that_was_given_before_the_plan_began() -> None:
    """A team checks its own plan: givers that are not in it are taken at their word."""
    states, plan = {"T1": SETUP.states["T1"]}, {"T1": STEPS["T1"]}
    for giver, step, expected in [
        ("T2", 11, []),
        ("T2", 12, ["take_early"]),
        ("bench", -5, []),
        ("T1", -5, ["take_own"]),
    ]:
        told = [Exchange("w3", giver, step, "T1", 13, "w2")]
        found = check(DOMAIN, SETUP.static, states, plan, exchanges=told)
        assert [v.rule for v in found if v.step == 13] == expected


def test_what_a_plan_file_may_contain_besides_actions_is_told_and_never_becomes_a_program() -> None:
    junk = [
        "move(w1",
        "lineShift. :- ",
        "not",
        "move(not,left)",
        "X",
        "",
        "7",
        "f(1..9)",
        "move(w1,right)",
        "move(w1,right)",
    ]
    states = {"T1": SETUP.states["T1"]}
    told = [Exchange("w1). :-", "T2", 0, "T1", 2, "w2"), Exchange("w1", 'T"2', 0, "T1", 2, "W")]
    details = {"T1": {(0, "move(w1"): {"effector": 1}, (0, "lineShift"): {"robot": "T2.w3", "effector": ":-"}}}
    breaks = [Break("T1", "C1", 0)]
    found = check(DOMAIN, SETUP.static, states, {"T1": [tuple(junk)]}, exchanges=told, details=details, breaks=breaks)
    assert {(v.action, v.rule) for v in found if v.action != "goal"} == {
        *((action, "unknown") for action in junk if action != "move(w1,right)"),
        ("move(w1,right)", "repeated"),
        ("w1). :- as w2", "unknown"),
        ("w1 as W", "unknown"),
    }


def test_robots_known_to_be_broken_are_told_and_repaired() -> None:
    states = {"T1": {**SETUP.states["T1"], "broken(w1)": 1}}
    plan: dict[str, list[Step]] = {"T1": [("move(w1,right)",), ("repair(w1)",), ("move(w1,right)",), ("repair(w1)",)]}
    found = [v for v in check(DOMAIN, SETUP.static, states, plan) if v.action != "goal"]
    assert [(v.step, v.rule) for v in found] == [(0, "broken"), (3, "repair_whole")]


def test_a_robot_that_breaks_unseen_fails_and_what_needed_it_is_judged_in_the_state_that_results() -> None:
    plan: dict[str, list[Step]] = {"T1": [("move(w1,right)",), ("workOn(w1,1)",), ("inspect(w1)", "repair(w1)")]}
    states = {"T1": {**SETUP.states["T1"], "line(1)": 2}}
    result = examine(DOMAIN, SETUP.static, states, plan, breaks=[Break("T1", "w1", 0)])
    assert [(v.step, v.action) for v in result.discrepancies] == [(0, "move(w1,right)")]
    assert {v.rule for v in result.violations if v.step == 1} == {"broken", "work_pit", "work_column"}
    assert [v.rule for v in result.violations if v.step == 2] == ["busy", "busy"]


# ---------------------------------------------------------------- against a second judge
NAMES = st.sampled_from(["w1", "w2", "w3", "c1"])


@st.composite
def actions(draw: st.DrawFn) -> str:
    name = draw(st.sampled_from(sorted(ROBOT_ARGUMENTS)))
    if name == "lineShift":
        return name
    rest = {
        "move": st.sampled_from(["left", "right", "up", "down"]),
        "attach": NAMES,
        "swapEndEffector": st.integers(1, 3).map(str),
        "workOn": st.integers(1, 5).map(str),
        "takeRobot": st.tuples(st.integers(1, 2), st.integers(1, 3)).map(lambda c: f"{c[0]},{c[1]}"),
    }.get(name)
    return f"{name}({draw(NAMES)}{',' + draw(rest) if rest is not None else ''})"


@st.composite
def mutants(draw: st.DrawFn) -> dict[str, list[Step]]:
    """The published plan with some actions left out, put elsewhere, or added, most of them early, where they spread."""
    plan = {team: list(steps) for team, steps in STEPS.items()}
    for _ in range(draw(st.integers(1, 8))):
        team, step = draw(st.sampled_from(sorted(plan))), draw(st.integers(0, 26))
        kept = [a for a in plan[team][step] if draw(st.integers(0, 3))]
        plan[team][step] = tuple(dict.fromkeys([*kept, *draw(st.lists(actions(), max_size=2))]))
    return plan


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@example(STEPS)
@given(mutants())
def test_random_mutants_are_judged_as_a_second_judge_judges_them(plan: dict[str, list[Step]]) -> None:
    takes = [
        (team, t, a)
        for team, steps in plan.items()
        for t, step in enumerate(steps)
        for a in step
        if a.startswith("takeRobot")
    ]
    tools = dict.fromkeys(takes, 3)
    details = {team: {(t, a): {"effector": 3} for g, t, a in takes if g == team} for team in plan}
    found = verdict(plan, breaks=(), exchanges=EXCHANGES, details=details)
    expected = judge((5, 3), 2, SETUP.states, plan, EXCHANGES, tools)
    assert {(v.team, v.step, v.action, v.rule) for v in found if not v.rule.startswith("exchange_")} == expected


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(mutants(), st.sampled_from(["T2", "T3"]), st.integers(1, 20))
def test_checker_and_planner_agree_on_the_first_step_that_is_wrong(
    plan: dict[str, list[Step]], team: str, length: int
) -> None:
    """They share no law, so this holds the one to the other."""
    steps = [tuple(a for a in step if not a.startswith(("inspect", "takeRobot"))) for step in plan[team][:length]]
    found = check(DOMAIN, SETUP.static, {team: SETUP.states[team]}, {team: steps})
    _, possible = predict(Problem(DOMAIN, SETUP.static, SETUP.states[team]), steps)
    assert possible == min((v.step for v in found if v.action != "goal"), default=length)
