"""What a team promises, by the real planner on tiny set-ups; and that what it carries over is true."""

from __future__ import annotations

from itertools import product

import pytest

from agents import course
from agents.guests import problem
from agents.memory import Course, Memory
from agents.questions import Planning
from agents.recovery import still_on_course
from bus import messages as m
from bus.messages import Hand, Question, State
from reasoning import values
from reasoning.domain import load
from reasoning.planner import Planner, predict
from tests.agents.rooms import ALONE, BORROWER, DOMAIN, LENDER, PAINTER, STATIC, WAXED, room

FACTORY = load(DOMAIN)


def never() -> bool:
    return False


def planning(state: State) -> Planning:
    return Planning(1, problem(FACTORY, STATIC, {}, Memory(observed=state), state))


def adopt(made: Planning, question: Question, start: int = 0, guest: str = "") -> Course:
    found = made.course(m.Adopt(1, start, question, guest), "T1", never)
    assert isinstance(found, Course), found
    return found


def test_prospects_say_whether_all_is_done_and_why_it_never_will_be() -> None:
    assert planning(ALONE).prospects(never) == (3, False, "", "", {})
    assert planning(ALONE | {"stage(1)": 3, "line(1)": 0}).prospects(never) == (0, True, "", "", {})
    bound, finished, alone, with_guest, _ = planning(BORROWER).prospects(never)
    assert (bound, finished, with_guest) == (3, False, "")
    assert alone == "no worker can ever stand beside the line"
    assert planning(ALONE | {"line(1)": 1}).prospects(never).hopeless_with_guest


@pytest.mark.parametrize(
    ("state", "question", "verdict"),
    [
        (ALONE, Question("alone", 3), "no"),
        (ALONE, Question("alone", 4), "yes"),
        (LENDER, Question("lend", 4, 0), "yes"),
        (ALONE, Question("lend", 9, 1), "no"),
        (BORROWER, Question("borrow", 5, 0), "yes"),
        (BORROWER, Question("borrow", 5, 1), "no"),
        (BORROWER, Question("borrow", 6, 1), "yes"),
    ],
)
def test_answers(state: State, question: Question, verdict: str) -> None:
    answer = planning(state).answer(question, never)
    assert (answer.verdict, answer.question, answer.epoch) == (verdict, question, 1)
    assert answer.finish <= question.within


def test_what_follows_from_an_answer_is_not_searched_again() -> None:
    made = planning(ALONE)
    assert made.answer(Question("alone", 6), never).verdict == "yes"
    assert made.answer(Question("alone", 3), never).verdict == "no"
    answer = made.answer(Question("alone", 7), never)
    assert (answer.verdict, answer.conflicts) == ("yes", 0)
    assert made.answer(Question("alone", 2), never).verdict == "no"


def test_the_adopted_plan_carries_the_refutations_of_its_search() -> None:
    made = planning(LENDER)
    made.answer(Question("alone", 3), never)
    made.answer(Question("lend", 5, 0), never)
    found = adopt(made, Question("lend", 5, 0), start=7)
    assert (found.start, found.role, found.gave) == (7, "lend", (Hand("worker", 0, "w2"),))
    assert found.refuted == (Question("alone", 3),)
    assert len(found.states) == found.makespan + 1


def test_after_a_restart_the_plan_is_searched_again() -> None:
    found = adopt(planning(BORROWER), Question("borrow", 6, 1), guest="T2.w2")
    assert (found.role, found.took) == ("borrow", (Hand("worker", 1, "w1", "T2.w2"),))
    assert found.details[1], "the effector that the guest is to come with"


def test_what_cannot_be_promised_cannot_be_adopted() -> None:
    made = planning(ALONE)
    assert (
        made.course(m.Adopt(1, 0, Question("alone", 3)), "T1", never) == "no plan is known that answers this question"
    )


def test_a_given_plan_is_cut_where_it_is_not_possible() -> None:
    made = planning(ALONE)
    steps = (("move(w1,right)",), ("workOn(w1,1)",), ("workOn(w1,1)",), ("lineShift",))
    found = made.course(m.Adopt(1, 3, Question("alone", 4), "", steps), "T1", never)
    assert isinstance(found, Course)
    assert (found.start, found.steps, found.role) == (3, steps[:2], "alone")
    assert not made.leads_to_goal(found)
    whole = (*steps[:2], ("lineShift",), ("lineShift",))
    found = made.course(m.Adopt(1, 3, Question("alone", 4), "", whole), "T1", never)
    assert isinstance(found, Course)
    assert made.leads_to_goal(found)


CARRIED = [
    (PAINTER, Question("alone", 13)),
    (room(("(1,2)", 3), ("(1,1)", 2), boxes=WAXED, carrier="(1,1)"), Question("lend", 6, 2)),
    (BORROWER, Question("borrow", 7, 1)),
]


@pytest.mark.slow
@pytest.mark.parametrize(("state", "wanted"), CARRIED)
@pytest.mark.parametrize("waits", [0, 1])
def test_what_is_carried_over_is_true(state: State, wanted: Question, waits: int) -> None:
    """After any number of the plan's steps, also when others made it wait in between, the offer is kept by a plan,
    and a planner that knows nothing of the past finds none for any question that is said to be refuted."""
    made = planning(state)
    horizon = wanted.within
    for kind, within, step in product(("alone", "lend", "borrow"), range(3, horizon), range(0, horizon, 2)):
        made.answer(Question(kind, within, 0 if kind == "alone" else step), never)
    found = adopt(made, wanted, guest="T2.w1")
    assert found.refuted
    for gone in range(found.makespan + 1):
        now = dict(found.states[gone])
        if waits:
            now = dict(predict(values.Problem(DOMAIN, STATIC, now), ((),) * waits)[0].states[-1])
        memory = still_on_course(FACTORY, STATIC, {}, Memory(gone, 1, now, course=found, on_course=True))
        assert memory.on_course
        offer = course.offer(memory)
        assert offer is not None
        guest = next((hand.name for hand in found.took if gone <= hand.step), "w9")
        fresh = Planner(values.Problem(DOMAIN, STATIC, now, guest))
        assert fresh.answer(values.Question(*fields(offer.question))).verdict == "yes"
        for q in offer.refuted:
            assert fresh.answer(values.Question(*fields(q))).verdict == "no", f"{q} after {gone} steps of {found.steps}"


def fields(q: Question) -> tuple[str, int, int]:
    return q.kind, q.within, q.step
