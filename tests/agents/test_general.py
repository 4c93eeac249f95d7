"""Teams that share without the published limits: several robots of one team, robots that are passed on and that come
back, and what is carried over from a search when a plan has gone some steps."""

from __future__ import annotations

from itertools import combinations_with_replacement

import pytest

from agents import course
from agents.adoption import Adoption
from agents.agreement import Agreement, Refused, Waiting
from agents.guests import following, problem
from agents.memory import Course, Memory
from agents.questions import Planning
from agents.recovery import still_on_course
from agents.requests import Requests
from agents.search import Search
from agents.setups import GivenPlan
from bus import messages as m
from bus.messages import Hand, Question
from reasoning import values
from reasoning.domain import load
from reasoning.loans import Market
from reasoning.planner import Planner, predict
from reasoning.sharing import Loan, Shared
from tests.agents.conftest import MakeSystem
from tests.agents.rooms import ALONE, BORROWER, DOMAIN, LENDER, STATIC, WAXED, room

FACTORY = load(DOMAIN)
GENERAL = STATIC | {"sharing": "general"}
ROBOTS = {"worker": 2}
ONE = {"worker": 1}


def never() -> bool:
    return False


def test_one_team_lends_two_robots(make_system: MakeSystem) -> None:
    """Under the published limits there is not a robot to borrow for each."""
    rooms = {"T1": BORROWER, "T2": LENDER, "T3": BORROWER}
    assert not make_system(rooms).end().goal
    system = make_system(rooms, robots=ROBOTS)
    assert system.end().goal
    assert {(data["giver"], data["taker"]) for data in system.said("exchange")} >= {("T2", "T1"), ("T2", "T3")}
    assert [data["status"] for data in system.said("shared_plan")] == ["optimal"]


def test_a_team_that_is_done_lends_its_only_robot(make_system: MakeSystem) -> None:
    """The only worker of both does T2's box, then T1's."""
    system = make_system({"T1": BORROWER, "T2": ALONE}, robots=ONE)
    assert system.end().goal
    assert {data["robot"] for data in system.said("exchange")} == {"T2.w1"}
    assert [(team, hand.robot) for team, hand in system.world.handed] == [("T2", "T2.w1"), ("T1", "T2.w1")]


@pytest.mark.slow
@pytest.mark.parametrize("victim", ["coordinator", "T1", "T2"])
def test_killed_between_any_two_turns_the_robots_still_come(make_system: MakeSystem, victim: str) -> None:
    rooms = {"T1": BORROWER, "T2": ALONE}
    for turn in range(0, 40, 5):
        system = make_system(rooms, robots=ONE)
        for _ in range(turn):
            system.tick()
        if system[victim].node is not None:
            system.restart(victim)
        assert system.end().goal


def test_a_given_plan_may_exchange_several_robots(make_system: MakeSystem) -> None:
    move, work, shift = ("move(w1,right)",), ("workOn(w1,1)",), ("lineShift",)
    there = (move, work, shift, shift)
    plan = GivenPlan(
        {"T1": ((), ("takeRobot(w1,1,2)",), *there), "T2": (("giveRobot(w2)", "move(w1,right)"), *there[1:])},
        (m.Exchange("w2", "T2.w2", "T2", 0, "T1", 1, "w1"),),
    )
    system = make_system({"T1": BORROWER, "T2": LENDER}, plan=plan, robots=ROBOTS)
    over = system.end()
    assert (over.goal, over.makespan, over.replans) == (True, 6, 0)
    assert [(data["robot"], data["take_step"]) for data in system.said("exchange")] == [("T2.w2", 1)]


# ---------------------------------------------------------------- who is asked what
PASSED = Shared("optimal", 9, 9, {"A": values.Question("share", 9), "B": values.Question("share", 9),
                "C": values.Question("share", 9)}, (Loan("A", "B", "worker"), Loan("B", "C", "worker")))  # fmt: skip


def adopted(team: str, gave: tuple[Hand, ...] = (), took: tuple[Hand, ...] = ()) -> m.Adopted:
    return m.Adopted(1, team, True, 9, gave, took)


def test_all_adopt_at_once_and_hear_then_which_robots_come() -> None:
    adoption = Adoption(PASSED, 1, 10, "ABC", {}, general=True)
    assert set(adoption.missing()) == {"A", "B", "C"}
    adoption.adopted = {
        "A": adopted("A", gave=(Hand("worker", 11, "w1", "A.w1"),)),
        "B": adopted("B", gave=(Hand("worker", 15, "w2"),), took=(Hand("worker", 12, "w2"),)),
        "C": adopted("C", took=(Hand("worker", 16, "w7"),)),
    }
    assert adoption.missing() == {"B": m.Welcome(1, {"w2": "A.w1"}), "C": m.Welcome(1, {"w7": "A.w1"})}
    adoption.adopted["B"] = adopted("B", (Hand("worker", 15, "w2", "A.w1"),), (Hand("worker", 12, "w2", "A.w1"),))
    adoption.adopted["C"] = adopted("C", took=(Hand("worker", 16, "w7", "A.w1"),))
    assert not adoption.missing()
    assert adoption.exchanges() == (
        m.Exchange("w1", "A.w1", "A", 11, "B", 12, "w2"),
        m.Exchange("w2", "A.w1", "B", 15, "C", 16, "w7"),
    )


def test_who_adopts_a_plan_without_an_exchange_that_others_count_on_is_refused(make_system: MakeSystem) -> None:
    """A team that was killed since it answered may find another plan for the same question."""
    node = make_system({"T1": ALONE})["supervisor"].node
    assert node is not None
    agreement = Agreement(node, Requests(node), 1, 1, Market({}, most=ROBOTS, back=1))
    agreement.adoption = Adoption(PASSED, 1, 10, "ABC", {}, general=True)
    assert isinstance(agreement.adopted("A", adopted("A", gave=(Hand("worker", 11, "w1", "A.w1"),))), Waiting)
    assert agreement.adopted("C", adopted("C")) == Refused(
        "C cannot adopt its plan: it exchanges fewer robots than promised"
    )
    assert isinstance(agreement.adopted("B", adopted("B", took=(Hand("worker", 12, "w2"),))), Refused)
    assert isinstance(
        agreement.adopted("B", adopted("B", (Hand("tug", 15, "w2"),), (Hand("worker", 12, "w2"),))), Refused
    )


def test_a_team_can_have_its_own_robot_back_from_the_bench() -> None:
    gave = (m.Handover("T1.w1", 4, "worker"),)
    waiting = m.Standing(1, "T1", 5, False, 3, gave=gave, hopeless="nobody to work")
    search = Search({"T1": waiting}, 1, 5, Market({}, most=ROBOTS, back=2))
    asked = search.next()
    assert not isinstance(asked, Shared)
    while not isinstance(asked, Shared):
        (q,) = asked.questions.values()
        yes = q.within >= 6 and all(step <= q.within - 5 for _, step in q.takes) and bool(q.takes)
        search.learn(
            "T1", m.Answer(1, m.Question(*q), "yes" if yes else "no", 6 if yes else 0, took=q.takes if yes else ())
        )
        asked = search.next()
    assert (asked.makespan, asked.loans) == (6, (Loan("T1.w1", "T1", "worker"),))


# ---------------------------------------------------------------- what is carried over
STATES = [(room(("(1,2)", 3), ("(1,1)", 2), boxes=WAXED), 0), (BORROWER, 0), (BORROWER, 1)]
PROMISES = [promise for n in range(3) for promise in combinations_with_replacement([("worker", s) for s in (0, 3)], n)]


def carried(state: m.State) -> Course:
    """A plan that gives or takes something, with what was refuted of all that was asked before."""
    made = Planning(1, problem(FACTORY, GENERAL, ROBOTS, Memory(observed=state), state))
    answers = [
        made.answer(Question("share", within, 0, gives, takes), never)
        for within in (4, 6, 7)
        for gives in PROMISES
        for takes in PROMISES
        if len(gives) + len(takes) < 3
    ]
    rich = max((a for a in answers if a.verdict == "yes"), key=lambda a: (len(a.gave), len(a.took)))
    found = made.course(m.Adopt(1, 0, rich.question), "T1", never)
    assert isinstance(found, Course), found
    assert found.gave or found.took
    assert found.refuted
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("state", "waits"), STATES)
def test_what_is_carried_over_is_true(state: m.State, waits: int) -> None:
    """As under the published limits: after any number of the plan's steps, a planner that knows nothing of the past
    keeps the offer and finds no plan for what is said to be refuted."""
    found = carried(state)
    names = tuple((hand.name, hand.kind) for hand in found.took)
    kept = refuted = 0
    for gone in range(found.makespan + 1):
        now = dict(found.states[gone])
        if waits:
            now = dict(
                predict(values.Problem(DOMAIN, GENERAL, now, guests=names or (("w9", "worker"),)), ((),))[0].states[-1]
            )
        memory = still_on_course(FACTORY, GENERAL, ROBOTS, Memory(gone, 1, now, course=found, on_course=True))
        if not memory.on_course:
            continue
        offer = course.offer(memory)
        assert offer is not None
        start = problem(FACTORY, GENERAL, ROBOTS, memory, now)
        rest = course.rest(found, gone)
        kept += 1
        following_planner = Planner(following(start, rest))
        assert following_planner.answer(values.Question(*fields(offer.question))).verdict == "yes"
        left = {
            kind: n - sum(hand.kind == kind and hand.step < gone for hand in found.took) for kind, n in ROBOTS.items()
        }
        fresh = Planner(problem(FACTORY, GENERAL, left, memory, now))
        for q in offer.refuted:
            refuted += 1
            assert fresh.answer(values.Question(*fields(q))).verdict == "no", f"{q} after {gone} steps of {found.steps}"
    assert kept > 1, "nothing was carried over: it shows nothing"
    assert refuted or waits


def fields(q: Question) -> tuple[object, ...]:
    return q.kind, q.within, q.step, q.gives, q.takes
