"""The realtime clock over the in-memory transport. Only bounds are asserted: the machine may be busy."""

from __future__ import annotations

from itertools import pairwise

import pytest

from bus import pace
from bus.clock import run_world, wall_s
from bus.messages import Envelope, Observe, Observed
from bus.node import Node
from bus.pace import STEP_S
from bus.participant import ClockError
from tests.bus import toys
from tests.bus.conftest import Bus, Collected, Threads, wait


class Stopwatch:
    """A simulation that notes when it is advanced, and answers at once."""

    def __init__(self, node: Node, hold_s: float = 0.0) -> None:
        self.node = node
        self.steps: Collected[tuple[float, float]] = Collected()
        self._hold_s = hold_s

    def handle(self, mail: tuple[Envelope, ...]) -> None:
        for message in mail:
            if not message.re:
                self.node.reply(message, Observed("T1", {}))

    def next_s(self) -> float | None:
        return None

    def advance(self, to_s: float) -> None:
        self.steps.add((wall_s(), to_s))
        if self._hold_s and to_s > 0.5:
            wait_s, self._hold_s = self._hold_s, 0.0
            wait(wait_s)


def conduct(
    node: Node, simulation: Stopwatch, contacts: Collected[tuple[str, str]], factor: float, **limits: float
) -> None:
    run_world(
        node, simulation, participants=("T1",), mode="realtime", factor=factor, on_contact=contacts.pair, **limits
    )


def start(bus: Bus, threads: Threads, factor: float, hold_s: float = 0.0) -> tuple[Node, Stopwatch, Node]:
    world, agent = bus.node("world", mode="realtime"), bus.node("T1", mode="realtime")
    threads.stops += [world.stop, agent.stop]
    simulation = Stopwatch(world, hold_s)
    threads.start(conduct, world, simulation, Collected(), factor)
    return world, simulation, agent


def test_time_runs_at_its_factor_and_stands_until_all_are_there(memory_bus: Bus, threads: Threads) -> None:
    _, simulation, agent = start(memory_bus, threads, factor=10.0)
    wait(0.1)
    assert simulation.steps.items == []
    threads.start(lambda: list(agent.turns()))
    steps = simulation.steps.wait(lambda items: items and items[-1][1] > 8.0)
    wall, simulated = steps[-1][0] - steps[0][0], steps[-1][1] - steps[0][1]
    assert 0.8 < simulated / wall / 10.0 < 1.1
    assert [to_s for _, to_s in steps] == sorted(to_s for _, to_s in steps)


@pytest.mark.slow
def test_after_a_hold_up_time_catches_up_without_a_leap(memory_bus: Bus, threads: Threads) -> None:
    _, simulation, agent = start(memory_bus, threads, factor=1.0, hold_s=0.3)
    threads.start(lambda: list(agent.turns()))
    steps = simulation.steps.wait(lambda items: items and items[-1][1] > 1.5)
    assert max(later[1] - earlier[1] for earlier, later in pairwise(steps)) <= 0.041
    assert (steps[-1][1] - steps[0][1]) / (steps[-1][0] - steps[0][0]) > 0.6, "it has caught up"


@pytest.mark.slow
def test_what_time_is_behind_too_much_is_given_up(
    memory_bus: Bus, threads: Threads, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pace, "OWED_S", 0.2)
    _, simulation, agent = start(memory_bus, threads, factor=1.0, hold_s=0.6)
    threads.start(lambda: list(agent.turns()))
    steps = simulation.steps.wait(lambda items: items and items[-1][1] > 2.0)
    behind_s = (steps[-1][0] - steps[0][0]) - (steps[-1][1] - steps[0][1])
    assert behind_s > 0.35, "of 0.6 s that nothing went on, 0.2 are made up for"


def test_mail_is_handled_as_it_arrives(memory_bus: Bus, threads: Threads) -> None:
    """Two hundred requests, one after the other, in less than two hundred steps of the clock."""
    _, _, agent = start(memory_bus, threads, factor=1.0)
    answered, times, began_s = 0, [], wall_s()
    for turn in agent.turns():
        times.append(turn.now_s)
        answered += len(turn.mail)
        if answered == 200:
            break
        agent.request("world", Observe("T1"))
    assert times == sorted(times)
    assert wall_s() - began_s < 200 * STEP_S


def test_waking_and_worker_threads(memory_bus: Bus, threads: Threads) -> None:
    _, _, agent = start(memory_bus, threads, factor=10.0)
    woken: list[float] = []
    for turn in agent.turns():
        if not woken:
            agent.wake_at(turn.now_s + 3.0)
            woken.append(turn.now_s + 3.0)
        elif len(woken) == 1:
            assert turn.now_s >= woken[0]
            woken.append(turn.now_s)
            threads.start(agent.wake_soon)
        else:
            break
    assert woken[1] < woken[0] + 2.0


def test_the_toy_system_and_a_team_that_freezes(memory_bus: Bus, threads: Threads) -> None:
    """Out of contact after the lease; back when it goes on."""
    from threading import Event

    resume = Event()
    contacts: Collected[tuple[str, str]] = Collected()
    world = memory_bus.node("world", mode="realtime", factor=20.0)
    agent = memory_bus.node("T1", mode="realtime", factor=20.0)
    threads.stops += [resume.set, world.stop, agent.stop]
    simulation = Stopwatch(world)
    threads.start(lambda: conduct(world, simulation, contacts, 20.0, lease_s=0.6))

    def freeze() -> None:
        for _ in agent.turns():
            resume.wait(20)

    threads.start(freeze)
    contacts.wait_for(("T1", "lost_contact"))
    resume.set()
    contacts.wait_for(("T1", "back"))
    assert contacts.items == [("T1", "present"), ("T1", "lost_contact"), ("T1", "back")]


def test_who_is_out_of_contact_may_be_given_up(memory_bus: Bus, threads: Threads) -> None:
    contacts: Collected[tuple[str, str]] = Collected()
    world = memory_bus.node("world", mode="realtime", factor=20.0)
    threads.stops.append(world.stop)
    threads.start(lambda: conduct(world, Stopwatch(world), contacts, 20.0, return_s=0.1))
    contacts.wait_for(("T1", "lost_contact"))
    world.give_up("T1")
    contacts.wait_for(("T1", "stopped"))


def test_who_is_given_up_is_not_waited_for(memory_bus: Bus, threads: Threads) -> None:
    contacts: Collected[tuple[str, str]] = Collected()
    world = memory_bus.node("world", mode="realtime", factor=20.0)
    threads.stops.append(world.stop)
    world.give_up("T1")  # it never came
    threads.start(lambda: conduct(world, Stopwatch(world), contacts, 20.0))
    contacts.wait_for(("T1", "stopped"))


def test_two_clocks_do_not_go_together(memory_bus: Bus, threads: Threads) -> None:
    world, agent = memory_bus.node("world", mode="realtime"), memory_bus.node("T1", mode="fast")
    threads.stops.append(world.stop)
    threads.start(conduct, world, Stopwatch(world), Collected(), 1.0)
    with pytest.raises(ClockError, match="the world's clock is realtime, this process was started with --clock fast"):
        list(agent.turns())


def test_the_toy_system_in_realtime(bus: Bus, threads: Threads) -> None:
    world = bus.node("world", mode="realtime", factor=20.0)
    threads.stops.append(world.stop)
    names = ("coordinator", "T1")
    judge, player = (bus.node(name, mode="realtime", factor=20.0) for name in names)
    threads.stops += [judge.stop, player.stop]
    threads.start(lambda: toys.world(world, participants=names))
    threads.start(toys.coordinator, judge)
    steps: Collected[int] = Collected()
    threads.start(lambda: toys.team(player, lambda _, step: steps.add(step)))
    assert steps.wait(lambda items: len(items) == toys.STEPS) == list(range(toys.STEPS))
