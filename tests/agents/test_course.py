"""Following a plan: pure functions of a team's memory."""

from __future__ import annotations

from msgspec.structs import replace

from agents import course
from agents.carrying import waited
from agents.memory import Begun, Course, Memory, load, save
from bus.journal import Journal
from bus.messages import Executed, Hand, Handover, Offer, Question, SkillCall
from reasoning import domain as domains
from tests.agents.rooms import ALONE, DOMAIN, LENDER

FACTORY = domains.load(DOMAIN)
STEPS = (("move(w1,right)",), ("workOn(w1,1)", "giveRobot(w2)"), ("lineShift",), ("lineShift",))
PLAN = Course(10, STEPS, ({},) * 5)
W2 = Hand("worker", 0, "w2")
LATER = replace(W2, step=1)


def test_actions_only_while_the_plan_lasts() -> None:
    memory = Memory(course=PLAN)
    assert course.actions(memory, 9) is None
    assert course.actions(memory, 10) == STEPS[0]
    assert course.actions(memory, 13) == STEPS[3]
    assert course.actions(memory, 14) is None
    assert course.actions(Memory(), 0) is None


def test_calls_say_what_the_written_action_leaves_out() -> None:
    take = "takeRobot(w3,1,2)"
    details = {1: {take: {"effector": 2}}}
    plan = Course(
        4, ((), (take, "lineShift")), ({}, {}, {}), details, "borrow", took=(Hand("worker", 1, "w3", "T9.w1"),)
    )
    assert course.calls(FACTORY, Memory(course=plan), 4) == ()
    assert course.calls(FACTORY, Memory(course=plan), 5) == (
        SkillCall("takeRobot", ("w3", 1, 2), {"effector": 2, "robot": "T9.w1"}),
        SkillCall("lineShift"),
    )


def test_surprises_are_held_against_the_state_after_the_step() -> None:
    plan = Course(3, (("a",),), ({"at(w1)": "(1,1)"}, {"at(w1)": "(2,1)"}))
    memory = Memory(step=3, course=plan, begun=Begun(3, ("a",)))
    assert course.surprises(memory, {"at(w1)": "(2,1)"}) == ()
    assert course.surprises(memory, {"at(w1)": "(1,1)"}) == ("at(w1)",)
    assert course.surprises(replace(memory, begun=Begun(3, ("inspect(w1)",), recover=True)), {}) == ()
    assert course.surprises(replace(memory, begun=None), {}) == ()


def given(memory: Memory, *actions: str, state: dict[str, int | str], step: int = 5) -> Memory:
    begun = replace(memory, step=step, begun=Begun(step, actions))
    return course.completed(FACTORY, "T1", begun, Executed("T1", step, state))


def test_a_robot_that_is_gone_was_given_and_one_that_is_there_was_taken() -> None:
    gone = {k: v for k, v in LENDER.items() if "w2" not in k}
    plan = Course(0, ((),) * 9, ({},) * 10, gave=(W2,), took=(replace(W2, robot="T2.w1"),))
    after = given(Memory(observed=LENDER, course=plan), "giveRobot(w2)", state=gone)
    assert after.gave == (Handover("T1.w2", 5, "worker"),)
    assert (after.step, after.begun, after.observed, after.history) == (6, None, gone, (("giveRobot(w2)",),))
    back = given(after, "takeRobot(w2,1,1)", state=LENDER, step=8)
    assert (back.took, back.guests) == ((Handover("T2.w1", 8, "worker"),), {"w2": "T2.w1"})
    again = given(back, "giveRobot(w2)", state=gone, step=9)
    assert again.gave[-1] == Handover("T2.w1", 9, "worker"), "a guest leaves under the name it was built with"
    assert again.guests == {}


def test_exchanges_that_did_not_take_place_are_not_noted() -> None:
    assert given(Memory(), "giveRobot(w2)", state=LENDER).gave == ()
    borrowing = Memory(course=Course(0, ((),) * 9, ({},) * 10, took=(replace(W2, robot="T2.w1"),)))
    assert given(borrowing, "takeRobot(w2,1,1)", state=ALONE).took == ()


def test_a_repaired_robot_is_whole_and_a_state_may_have_facts_about_nobody() -> None:
    after = given(Memory(broken=("c1", "w1")), "repair(w1)", state={"open": 1, **ALONE})
    assert after.broken == ("c1",)
    assert course.beliefs(after)["broken(c1)"] == 1
    assert "broken(w1)" not in course.beliefs(after)


def test_a_fresh_name_is_nobodys() -> None:
    assert course.fresh_name(FACTORY, Memory(observed=ALONE)) == "w2"
    assert course.fresh_name(FACTORY, Memory(observed=LENDER)) == "w3"
    assert course.fresh_name(FACTORY, Memory(observed={"line(7)": 1, "at(c1)": "(1,1)", "attached(c1)": "w4"})) == "w1"
    assert course.fresh_name(FACTORY, Memory(observed=ALONE, guests={"w5": "T2.w1"})) == "w6"


def test_nothing_is_offered_without_a_plan_that_leads_to_the_goal() -> None:
    assert course.offer(Memory()) is None
    assert course.offer(Memory(step=11, course=PLAN, on_course=False)) is None
    assert course.offer(Memory(step=14, course=PLAN, on_course=True)) == Offer(Question("alone", 0))


LENDING = replace(PLAN, role="lend", gave=(LATER,), refuted=(Question("lend", 3, 1), Question("alone", 3)))


def test_before_the_exchange_the_offer_is_in_the_plans_role() -> None:
    memory = Memory(step=11, course=LENDING, on_course=True)
    assert course.offer(memory) == Offer(Question("lend", 3, 0), (Question("lend", 2, 0), Question("alone", 2)))


def test_after_the_exchange_what_was_refuted_of_it_is_refuted_of_going_on_alone() -> None:
    """It gave in step 1: of lending by step 1 it was refuted that 3 steps are enough, of finishing alone too, but
    that is another story now."""
    memory = Memory(step=12, course=LENDING, on_course=True)
    assert course.offer(memory) == Offer(Question("alone", 2), (Question("alone", 1),))
    later = replace(LENDING, refuted=(Question("lend", 3, 0),))  # says nothing of giving in step 1
    assert course.offer(replace(memory, course=later)) == Offer(Question("alone", 2))


def test_a_borrower_that_has_taken_its_robot_goes_on_alone() -> None:
    borrowing = replace(
        PLAN, role="borrow", took=(LATER,), refuted=(Question("borrow", 3, 2), Question("borrow", 2, 0))
    )
    before = course.offer(Memory(step=11, course=borrowing, on_course=True))
    assert before == Offer(Question("borrow", 3, 0), (Question("borrow", 2, 1), Question("borrow", 1, 0)))
    after = course.offer(Memory(step=12, course=borrowing, on_course=True))
    assert after == Offer(Question("alone", 2), (Question("alone", 0),))


def test_the_rest_of_a_plan_is_a_plan_of_its_own() -> None:
    plan = replace(LENDING, details={0: {"a": {"x": 1}}, 2: {"b": {"y": 2}}})
    left = course.rest(plan, 1)
    assert (left.start, left.steps, len(left.states), left.gave) == (11, STEPS[1:], 4, (W2,))
    assert left.details == {1: {"b": {"y": 2}}}
    left = course.rest(plan, 2)
    assert (left.role, left.gave) == ("alone", ())


def test_time_that_passed_for_nothing_weakens_what_was_refuted() -> None:
    refuted = (Question("alone", 5), Question("alone", 1), Question("lend", 5, 1), Question("borrow", 5, 1))
    plan = replace(PLAN, refuted=refuted)
    assert waited(plan, 0, 0) == refuted
    assert waited(plan, 0, 2) == (Question("alone", 3), Question("borrow", 3, 0))
    assert waited(plan, 0, None) == ()
    lent = replace(plan, role="lend", gave=(LATER,))
    assert Question("lend", 3, 1) in waited(lent, 2, 2), "given before the wait"


def test_a_memory_survives_in_its_journal() -> None:
    journal = Journal()
    assert load(journal) == Memory()
    kept = Memory(3, 2, ALONE, ("w1",), {"w2": "T2.w1"}, course=LENDING, on_course=True, begun=Begun(3, ("a",)))
    save(journal, kept)
    assert load(journal) == kept
