"""Coordinator and teams together, message by message, over the in-memory twin: they reach their goal whoever is killed,
lost or not heard, at whatever moment. Nothing is carried out twice, and no robot is in two places.
"""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from agents.setups import GivenPlan
from bus.memory_transport import Mischief
from bus.messages import Exchange, Inject
from tests.agents.conftest import MakeSystem
from tests.agents.rooms import ALONE, BORROWER, LENDER, PAINTER, WAXED, room
from tests.agents.together import System

Prepare = Callable[[MakeSystem], System]


def lend(make_system: MakeSystem) -> System:
    """T2 lends a worker to T1, which has none."""
    return make_system({"T1": BORROWER, "T2": LENDER})


def broken(make_system: MakeSystem) -> System:
    """T1's worker is broken from the beginning, and nobody knows."""
    system = make_system({"T1": ALONE, "T2": ALONE})
    system.world.broken.add("T1.w1")
    return system


def painting(make_system: MakeSystem) -> System:
    """T1 has paint that dries while it waits for T2, whose worker is broken."""
    system = make_system({"T1": PAINTER, "T2": ALONE})
    system.world.broken.add("T2.w1")
    return system


SETTINGS = (lend, broken, painting)


def test_nobody_needs_anybody(make_system: MakeSystem) -> None:
    over = make_system({"T1": ALONE, "T2": ALONE}).end()
    assert (over.goal, over.makespan, over.replans) == (True, 4, 0)


def test_a_robot_is_lent(make_system: MakeSystem) -> None:
    system = lend(make_system)
    over = system.end()
    assert (over.goal, over.makespan, over.replans) == (True, 6, 0)
    assert [(team, h.robot, h.step) for team, h in system.world.handed] == [("T2", "T2.w2", 0), ("T1", "T2.w2", 1)]


def test_a_broken_robot_is_found_and_repaired(make_system: MakeSystem) -> None:
    system = broken(make_system)
    assert system.end().goal
    assert [data["causes"] for data in system.said("diagnosis")] == [[["broken(w1)"]]]
    assert [data["robot"] for data in system.said("repair")] == ["w1"]


def test_an_unreachable_goal_ends_the_run_with_the_reason(make_system: MakeSystem) -> None:
    over = make_system({"T1": BORROWER, "T2": ALONE | {"line(1)": 1}}).end()
    assert not over.goal
    assert over.reason.startswith("no plan: T1, T2 can never finish alone, and there is not a robot to borrow for each")
    assert "T2: box 1 is at line position 1" in over.reason


@pytest.mark.slow
@pytest.mark.parametrize("setting", SETTINGS)
@pytest.mark.parametrize("victim", ["coordinator", "T1", "T2"])
def test_killed_before_any_write_or_send(make_system: MakeSystem, setting: Prepare, victim: str) -> None:
    undisturbed = setting(make_system)
    steps = undisturbed.end().makespan
    for operation in range(0, undisturbed[victim].operations, 3 if setting is painting else 1):
        system = setting(make_system)
        system[victim].left = operation
        over = system.end()
        assert over.goal, f"killed before operation {operation}: {over.reason}"
        # A step that others have taken meanwhile is the most that may be lost.
        assert steps <= over.makespan <= steps + 2, f"killed before operation {operation}: {system.story()}"
        system.close()


@pytest.mark.slow
@pytest.mark.parametrize("turns", [4, 40])
@pytest.mark.parametrize("setting", SETTINGS)
@pytest.mark.parametrize("victim", ["T1", "T2"])
def test_lost_for_a_while(make_system: MakeSystem, setting: Prepare, victim: str, turns: int) -> None:
    """Killed before some write or send, declared lost, and back later: the others do what they can meanwhile."""
    undisturbed = setting(make_system)
    undisturbed.end()
    for operation in range(0, undisturbed[victim].operations, 5 if setting is painting else 2):
        system = setting(make_system)
        system[victim].left = operation
        system.until(lambda system=system: system[victim].lives and system[victim].node is None)
        system.contact(victim, "lost_contact")
        for _ in range(turns):
            system.tick()
        system.contact(victim, "back")
        over = system.end()
        assert over.goal, f"killed before operation {operation}: {over.reason}"
        system.close()


@pytest.mark.slow
@pytest.mark.parametrize("setting", SETTINGS)
def test_the_team_and_then_the_coordinator(make_system: MakeSystem, setting: Prepare) -> None:
    """The coordinator is killed while a team is out of contact, of which the world tells once."""
    for operation in range(0, 60, 3):
        system = setting(make_system)
        system.until(lambda system=system: system.said("bound"))
        system.contact("T1", "lost_contact")
        system["coordinator"].left = operation
        for _ in range(30):
            system.tick()
        system.contact("T1", "back")
        assert system.end().goal
        system.close()


@pytest.mark.parametrize("seed", [*range(10), *(pytest.param(n, marks=pytest.mark.slow) for n in range(10, 30))])
def test_whatever_happens(make_system: MakeSystem, seed: int) -> None:
    """Messages are lost, repeated and reordered, and everybody is killed again and again."""
    dice = random.Random(seed)
    system = dice.choice(SETTINGS)(make_system)
    system.router.mischief = Mischief("muster/*/mail/*/*", drop=0.1, repeat=0.1, delay=0.2, hold=6)
    for _ in range(12):
        victim = dice.choice(["coordinator", "T1", "T2"])
        system[victim].left = dice.randrange(60)
        lost = victim != "coordinator" and dice.random() < 0.3
        if lost:
            system.contact(victim, "lost_contact")
        for _ in range(dice.randrange(15)):
            system.tick()
        if lost:
            system.contact(victim, "back")
        if system.over:
            break
    system.router.mischief = Mischief()
    assert system.end().goal


def test_a_growing_order_begins_a_new_search(make_system: MakeSystem) -> None:
    system = make_system({"T1": ALONE, "T2": ALONE})
    system.until(lambda: system.world.done["T1", 0])
    system.grow("T1", 2, place=3)
    over = system.end()
    assert (over.goal, over.replans) == (True, 1)
    assert [data["reason"] for data in system.said("search_started")] == ["start", "the order of T1 changed"]
    assert not system.said("diagnosis"), "an order is nothing to explain"


def test_an_order_that_comes_while_the_teams_are_asked(make_system: MakeSystem) -> None:
    system = make_system({"T1": ALONE, "T2": ALONE})
    system.until(lambda: system.said("question"))
    assert not system.said("shared_plan")
    system.grow("T1", 2, place=3)
    over = system.end()
    assert (over.goal, over.replans) == (True, 0)
    assert len(system.said("shared_plan")) == 1


ALONE_STEPS = (("move(w1,right)",), ("workOn(w1,1)",), ("lineShift",), ("lineShift",))


def test_a_given_plan_is_followed(make_system: MakeSystem) -> None:
    system = make_system({"T1": ALONE, "T2": ALONE}, plan=GivenPlan({"T1": ALONE_STEPS, "T2": ALONE_STEPS}))
    over = system.end()
    assert (over.goal, over.makespan, over.replans) == (True, 4, 0)
    assert [data["status"] for data in system.said("shared_plan")] == ["given"]


@pytest.mark.parametrize("steps", [(), ALONE_STEPS[:2], (*ALONE_STEPS[:2], ("workOn(w1,1)",), ("lineShift",))])
def test_a_given_plan_that_ends_before_its_goal_is_taken_over(
    make_system: MakeSystem, steps: tuple[tuple[str, ...], ...]
) -> None:
    """Nothing at all, a plan that stops half-way, and one that is possible as far as there only."""
    system = make_system({"T1": ALONE, "T2": ALONE}, plan=GivenPlan({"T1": steps, "T2": ALONE_STEPS}))
    over = system.end()
    assert over.goal
    assert [data["status"] for data in system.said("shared_plan")][-1] == "optimal"
    for data in system.said("team_finished"):
        assert data["step"] in (3, 4), "nobody is finished before the goal"


def test_a_given_plan_in_which_nobody_has_anything_to_do(make_system: MakeSystem) -> None:
    system = make_system({"T1": ALONE, "T2": ALONE}, plan=GivenPlan({}))
    over = system.end()
    assert (over.goal, over.makespan) == (True, 4)


def test_a_given_exchange_takes_place(make_system: MakeSystem) -> None:
    took = ("takeRobot(w1,1,2)",)
    plan = GivenPlan(
        {"T1": ((), took, *ALONE_STEPS), "T2": (("giveRobot(w2)", "move(w1,right)"), *ALONE_STEPS[1:])},
        (Exchange("w2", "T2.w2", "T2", 0, "T1", 1, "w1"),),
    )
    system = make_system({"T1": BORROWER, "T2": LENDER}, plan=plan)
    over = system.end()
    assert (over.goal, over.makespan, over.replans) == (True, 6, 0)
    assert [data["take_step"] for data in system.said("exchange")] == [1]


def test_what_only_a_lost_team_can_give_is_waited_for(make_system: MakeSystem) -> None:
    system = lend(make_system)
    system.contact("T2", "lost_contact")
    for _ in range(60):
        system.tick()
    assert system.over is None, "no plan without T2 does not mean no plan"
    system.contact("T2", "back")
    assert system.end().goal


def test_three_robots_break_one_after_the_other(make_system: MakeSystem) -> None:
    rooms = {"T1": room(("(1,2)", 3), boxes=WAXED, carrier="(1,1)"), "T2": ALONE}
    system = make_system(rooms)
    system.world.broken |= {"T1.w1", "T2.w1"}
    assert system.end().goal
    assert len(system.said("repair")) == 2


def test_strangers_are_not_obeyed(make_system: MakeSystem) -> None:
    """Disturbances are the world's business, not the teams'."""
    system = make_system({"T1": ALONE, "T2": ALONE}, puppets=("mallory",))
    system.send("mallory", "T1", Inject("break", "T1.w1"))
    assert system.end().goal
    assert not system.said("discrepancy")
