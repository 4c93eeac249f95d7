"""What a team does when the world is not as planned: pure functions."""

from __future__ import annotations

from msgspec.structs import replace

from agents import recovery
from agents.memory import Begun, Course, Memory
from bus.messages import Diagnosis, Question, SkillCall
from reasoning import domain as domains
from reasoning.planner import Planner
from reasoning.values import Problem
from reasoning.values import Question as Asked
from tests.agents.rooms import ALONE, DOMAIN, PAINTER, STATIC

FACTORY = domains.load(DOMAIN)


def blamed(*robots: str) -> Diagnosis:
    return Diagnosis(tuple(f"broken({robot})" for robot in robots))


CARRIER, WORKER, BOTH, PERSON = blamed("c1"), blamed("w1"), blamed("c1", "w1"), Diagnosis(("moved(w1)",))


def test_one_explanation_is_believed() -> None:
    settled = recovery.settle(Memory(broken=("w9",)), (CARRIER,))
    assert (settled.broken, settled.open) == (("c1", "w9"), ())


def test_several_explanations_wait_for_an_inspection_if_one_can_tell_them_apart() -> None:
    assert recovery.settle(Memory(), (CARRIER, WORKER)).open == (CARRIER, WORKER)
    alike = recovery.settle(Memory(), (CARRIER, Diagnosis(("broken(c1)", "moved(w1)"))))
    assert (alike.open, alike.broken) == ((), ("c1",))


def test_what_persons_did_leaves_nothing_to_inspect() -> None:
    settled = recovery.settle(Memory(), (PERSON, Diagnosis(("changed(1)",))))
    assert (settled.open, settled.broken) == ((), ())


def test_nothing_explains_it() -> None:
    assert recovery.settle(Memory(broken=("c1",)), ()) == Memory(broken=("c1",))


def test_suspects_are_those_on_whom_explanations_differ() -> None:
    assert recovery.suspects((CARRIER,)) == ()
    assert set(recovery.suspects((CARRIER, WORKER))) == {"c1", "w1"}
    assert recovery.suspects((BOTH, CARRIER)) == ("w1",)


def test_an_inspection_is_a_step_of_its_own() -> None:
    waiting = Memory(open=(BOTH, CARRIER))
    assert recovery.next_inspection(FACTORY, waiting) == ("inspect(w1)",)
    assert recovery.next_inspection(FACTORY, Memory()) is None
    assert recovery.calls(Begun(3, ("inspect(w1)",), recover=True)) == (SkillCall("inspect", ("w1",)),)


def test_findings_drop_what_they_contradict() -> None:
    waiting = Memory(open=(CARRIER, WORKER))
    assert recovery.narrowed(waiting, {"c1": "broken"}).broken == ("c1",)
    assert recovery.narrowed(waiting, {"c1": "sound"}).broken == ("w1",)
    assert recovery.narrowed(waiting, {"c1": "sound"}).open == ()
    three = replace(waiting, open=(CARRIER, WORKER, blamed("w2")))
    left = recovery.narrowed(three, {"c1": "sound"})
    assert (left.open, left.broken) == ((WORKER, blamed("w2")), ())


def test_findings_that_contradict_everything_are_believed_all_the_same() -> None:
    left = recovery.narrowed(Memory(open=(CARRIER, WORKER)), {"w2": "broken"})
    assert (left.open, left.broken) == ((), ("w2",))


def test_an_inspection_that_finds_nothing_is_not_repeated_for_ever() -> None:
    """The suspect has been carried away, say."""
    assert recovery.narrowed(Memory(open=(CARRIER, WORKER)), {}).open == ()


MOVED = ALONE | {"at(w1)": "(2,2)"}
NEW_BOX = {"line(2)": 3, "stage(2)": 0, "wet(2)": 0}


def test_a_changed_order_is_no_discrepancy() -> None:
    assert recovery.only_order(ALONE, MOVED, MOVED | NEW_BOX, tuple(NEW_BOX))
    gone = {fluent: value for fluent, value in MOVED.items() if "(1)" not in fluent}
    assert recovery.only_order(ALONE, MOVED, gone, ("line(1)", "stage(1)", "wet(1)"))


def test_a_changed_order_and_something_else_is_a_discrepancy() -> None:
    assert not recovery.only_order(ALONE, MOVED, ALONE | NEW_BOX, ("at(w1)", *NEW_BOX))
    assert not recovery.only_order(ALONE, MOVED, ALONE, ("at(w1)",))


def on_course(steps: int = 13, state: dict[str, int | str] = PAINTER) -> Memory:
    found = Planner(Problem(DOMAIN, STATIC, state)).answer(Asked("alone", steps)).plan
    assert found is not None
    plan = Course(4, found.steps, tuple(dict(s) for s in found.states), refuted=(Question("alone", 9),))
    return Memory(4, 1, state, course=plan, on_course=True)


def after(memory: Memory, gone: int, **seen: int | str) -> Memory:
    assert memory.course is not None
    state = memory.course.states[gone] | {k.replace("_", "(") + ")": v for k, v in seen.items()}
    return recovery.still_on_course(FACTORY, STATIC, {}, replace(memory, step=4 + gone, observed=state))


def test_whoever_is_where_the_plan_says_is_on_course() -> None:
    memory = on_course()
    assert after(memory, 3).course is memory.course


def test_paint_that_has_dried_changes_the_predictions_and_weakens_the_proof() -> None:
    memory = on_course()
    assert memory.course is not None
    painted = next(n for n, state in enumerate(memory.course.states) if state["wet(1)"])
    kept = after(memory, painted, wet_1=0)
    assert kept.on_course
    assert kept.course is not None
    assert kept.course.states[painted]["wet(1)"] == 0
    assert kept.course.states[-1] == memory.course.states[-1]
    assert kept.course.refuted == (Question("alone", 8),)


def test_a_plan_that_does_not_lead_to_its_goal_any_more_is_given_up() -> None:
    memory = on_course()
    assert not after(memory, 3, at_w1="(1,1)").on_course
    assert not after(memory, 3, stage_1=0).on_course
    assert not after(memory, 3, line_2=3, stage_2=0, wet_2=0).on_course
    gone = replace(memory, broken=("w1",))
    assert not after(gone, 1, wet_1=0).on_course, "a robot that is known to be broken does nothing"


def test_who_is_done_stays_done_unless_something_changes() -> None:
    memory = on_course()
    assert memory.course is not None
    done = memory.course.makespan
    assert after(memory, done).on_course
    assert not after(memory, done, line_2=3).on_course
    last = replace(memory, step=4 + done + 9, observed=memory.course.states[-1])
    assert recovery.still_on_course(FACTORY, STATIC, {}, last).on_course


def test_without_a_plan_nobody_is_on_course() -> None:
    assert not recovery.still_on_course(FACTORY, STATIC, {}, Memory(observed=ALONE)).on_course
