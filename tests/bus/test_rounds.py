"""The fast clock over the in-memory transport: the same events on every run, whatever happens in between."""

from __future__ import annotations

import random
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from bus import keys
from bus.codec import decode
from bus.memory_transport import MemoryRouter, Mischief
from bus.messages import Enquire, Envelope, Event
from bus.node import Node
from tests.bus import toys
from tests.bus.conftest import Bus, Collected, Threads, wait

Said = tuple[str, int, int, float, str, str]


class System:
    """The toy system in threads."""

    def __init__(self, router: MemoryRouter, home: Path | None = None, **world: Any) -> None:
        self.bus, self.threads = Bus(router.connect), Threads()
        self.events: Collected[Said] = Collected()
        self.home, self._world = home, world
        self.bus.transport().subscribe(keys.event(self.bus.run, "*"), self._on_event)

    def _on_event(self, _: str, payload: bytes) -> None:
        envelope = decode(payload)
        assert isinstance(envelope, Envelope)
        event = envelope.body
        assert isinstance(event, Event)
        said = sorted((key, str(value)) for key, value in event.data.items())
        self.events.add((envelope.src, envelope.inc, envelope.seq, envelope.at_s, event.kind, str(said)))

    def start(self, name: str, body: Callable[..., object], *args: object) -> Node:
        node = self.bus.node(name, home=self.home)
        self.threads.stops.append(node.stop)

        def life() -> None:
            with node:
                body(node, *args)

        self.threads.start(life)
        return node

    def start_world(self, **changes: Any) -> Node:
        return self.start("world", lambda node: toys.world(node, **{**self._world, **changes}))

    def start_all(self, hook: toys.Hook = toys.nothing, besides: tuple[str, ...] = ()) -> None:
        self.start_world()
        for name in toys.TEAMS:
            if name not in besides:
                self.start(name, toys.team, hook)
        if "coordinator" not in besides:
            self.start("coordinator", toys.coordinator, hook)

    def finish(self, teams: tuple[str, ...] = toys.TEAMS) -> list[Said]:
        """Wait for the teams to finish; the events in the order of simulated time."""
        self.events.wait(lambda items: {e[0] for e in items if e[4] == "team_finished"} >= set(teams), 30.0)
        self.close()
        return sorted(self.events.items, key=lambda e: (e[3], e[0], e[1], e[2]))

    def close(self) -> None:
        self.threads.close()
        self.bus.close()


def kinds(events: list[Said], kind: str, source: str = "") -> list[Said]:
    return [e for e in events if e[4] == kind and e[0].startswith(source)]


def taken(events: list[Said], steps: int = toys.STEPS) -> bool:
    """Whether every team took every step exactly once."""
    ended = [e[5] for e in kinds(events, "step_ended")]
    return len(ended) == len(set(ended)) == steps * len(toys.TEAMS)


def test_the_same_events_whatever_the_load() -> None:
    def loaded(seed: int) -> toys.Hook:
        dice = random.Random(seed)
        return lambda name, step: wait(0.01 * dice.random())

    calm = System(MemoryRouter())
    calm.start_all()
    expected = calm.finish()
    assert taken(expected)
    assert max(e[3] for e in expected) == toys.STEPS * toys.PERIOD_S
    for seed in (1, 2):
        system = System(MemoryRouter())
        system.start_all(loaded(seed))
        assert system.finish() == expected


def test_lost_repeated_and_reordered_mail_costs_nothing_but_time() -> None:
    router = MemoryRouter(seed=4)
    system = System(router)
    system.start_all()
    router.mischief = Mischief("*/*/mail/*", drop=0.03, repeat=0.2, delay=0.2)
    events = system.finish()
    assert taken(events)
    assert len(kinds(events, "question")) == toys.STEPS * len(toys.TEAMS)


class KilledError(Exception):
    """The end of a process without a goodbye."""


def test_a_killed_team_comes_back_and_time_waits(tmp_path: Path) -> None:
    system = System(MemoryRouter(), tmp_path)
    dead = threading.Event()

    def killed(node: Node) -> None:
        def hook(name: str, step: int) -> None:
            if step == 2:
                raise KilledError

        with pytest.raises(KilledError):
            toys.team(node, hook)
        node.close()
        dead.set()

    system.start_all(besides=("T2",))
    system.start("T2", killed)
    assert dead.wait(10)
    system.start("T2", toys.team)
    events = system.finish()
    assert taken(events)
    assert {e[1] for e in events if e[0] == "T2"} == {1, 2}
    assert [e for e in kinds(events, "contact") if "lost" in e[5]] == []
    assert max(e[3] for e in events) <= (toys.STEPS + 1) * toys.PERIOD_S


def test_a_killed_team_that_stays_away_is_out_of_contact(tmp_path: Path) -> None:
    system = System(MemoryRouter(), tmp_path, return_s=1.0)

    def killed(node: Node) -> None:
        with pytest.raises(KilledError):
            toys.team(node, lambda name, step: (_ for _ in ()).throw(KilledError))
        node.close()

    system.start_all(besides=("T2",))
    system.start("T2", killed)
    events = system.finish(("T1", "T3"))
    contacts = [e[5] for e in kinds(events, "contact")]
    assert len([c for c in contacts if "present" in c]) == 4
    assert contacts[-1] == "[('name', 'T2'), ('state', 'lost_contact'), ('text', '')]"


def test_a_paused_team_is_lost_and_comes_back() -> None:
    system = System(MemoryRouter(), lease_s=0.6)
    resume = threading.Event()
    system.start_all(lambda name, step: wait(20.0, resume) if (name, step) == ("T2", 2) else None)
    system.events.wait(lambda items: any("lost_contact" in e[5] and "T2" in e[5] for e in items))
    system.events.wait(lambda items: {e[0] for e in items if e[4] == "team_finished"} >= {"T1", "T3"})
    resume.set()
    events = system.finish()
    assert taken(events)
    states = [e[5].split("'state', '")[1].split("'")[0] for e in kinds(events, "contact") if "'T2'" in e[5]]
    assert states == ["present", "lost_contact", "back"]


def test_a_world_that_comes_back_goes_on_from_its_journal(tmp_path: Path) -> None:
    system = System(MemoryRouter(), tmp_path)
    first = system.start_world()
    for name in toys.TEAMS:
        system.start(name, toys.team)
    system.start("coordinator", toys.coordinator)
    system.events.wait(lambda items: sum(e[4] == "step_ended" for e in items) >= 7)
    first.stop()
    system.threads._threads[0].join(10)
    system.start_world()
    events = system.finish()
    assert taken(events)
    assert {e[1] for e in events if e[0] == "world"} == {1, 2}
    assert len(kinds(events, "question")) == toys.STEPS * len(toys.TEAMS)


def test_an_idle_world_answers_outsiders(memory_bus: Bus, threads: Threads) -> None:
    world = memory_bus.node("world")
    listener = memory_bus.node("coordinator")
    threads.stops += [world.stop, listener.stop]
    threads.start(lambda: toys.world(world, participants=("coordinator",)))
    threads.start(toys.coordinator, listener)
    outsider = memory_bus.node("cli", outsider=True)
    for epoch in range(20):
        assert outsider.ask("coordinator", Enquire(epoch), timeout_s=5.0)


def test_waking_without_mail(memory_bus: Bus, threads: Threads) -> None:
    turns: Collected[float] = Collected()
    world, sleeper = memory_bus.node("world"), memory_bus.node("T1")
    threads.stops += [world.stop, sleeper.stop]

    def sleep() -> None:
        for turn in sleeper.turns():
            turns.add(turn.now_s)
            if turn.now_s == 0.0 and len(turns.items) == 1:
                for at_s in (7.5, 2.25, 2.25, 4.0):
                    sleeper.wake_at(at_s)

    threads.start(lambda: toys.world(world, participants=("T1",)))
    threads.start(sleep)
    assert turns.wait(lambda items: len(items) >= 4) == [0.0, 2.25, 4.0, 7.5]
    sleeper.wake_soon()
    assert turns.wait(lambda items: len(items) >= 5)[-1] == 7.5
