"""How somebody comes to take part in the world's time, word by word: played by hand over the in-memory transport."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from bus import keys
from bus.clock import run_world
from bus.codec import decode, encode
from bus.contacts import Contacts
from bus.messages import Body, Done, Envelope, Join, Observe, Ok, Tick
from bus.node import Node
from tests.bus.conftest import Bus, Collected, Threads
from tests.bus.test_codec import envelope


class ByHand:
    """A participant that says what the test has it say."""

    def __init__(self, bus: Bus, name: str) -> None:
        self.name, self.run, self.transport = name, bus.run, bus.transport()
        self.mail: Collected[Envelope] = Collected()
        self.transport.subscribe(keys.mail(bus.run, name, "*"), lambda _, payload: self.mail.add(opened(payload)))

    def say(self, key: str, body: Body, message_id: str, inc: int = 1) -> None:
        self.transport.put(key, encode(envelope(body, run=self.run, src=self.name, inc=inc, id=message_id)))

    def join(self, message_id: str, inc: int = 1) -> None:
        self.say(keys.join(self.run, self.name), Join(), message_id, inc)

    def told(self, kind: type[Body]) -> list[Envelope]:
        return [e for e in self.mail.items if isinstance(e.body, kind)]


def opened(payload: bytes) -> Envelope:
    message = decode(payload)
    assert isinstance(message, Envelope)
    return message


def heard(world: Node) -> None:
    """What was said has been taken in: in memory it is there at once."""
    while world.post.wait(0.05):
        pass


def test_who_joins_enters_with_all_others_in_the_round_after_the_next_and_is_told_again_if_it_asks_again(
    memory_bus: Bus,
) -> None:
    world = memory_bus.node("world")
    first, second = ByHand(memory_bus, "T1"), ByHand(memory_bus, "T2")
    contacts = Contacts(world.post, ("T1", "T2"), lease_s=60.0, return_s=60.0)
    first.join("T1.1.j")
    heard(world)
    assert contacts.settle(5) == [], "all enter in the same round"
    second.join("T2.1.j")
    heard(world)
    assert contacts.settle(5) == [("T1", "present"), ("T2", "present")]
    assert (contacts.members(6), contacts.members(7)) == ((), ("T1", "T2"))
    first.join("T1.1.j")  # it has not heard the answer
    heard(world)
    first.mail.wait(lambda items: len(items) == 2)
    assert [(e.re, e.round) for e in first.told(Ok)] == [("T1.1.j", 7)] * 2
    assert not contacts.gone("T1")


def test_a_new_life_enters_anew_and_a_word_of_the_old_one_that_comes_late_counts_for_nothing(memory_bus: Bus) -> None:
    world, team = memory_bus.node("world"), ByHand(memory_bus, "T1")
    contacts = Contacts(world.post, ("T1",), lease_s=60.0, return_s=60.0)
    team.join("T1.1.j")
    heard(world)
    contacts.settle(5)
    team.join("T1.2.j", inc=2)
    heard(world)
    assert contacts.gone("T1"), "its old life says no more"
    assert contacts.settle(8) == [], "it was never out of contact"
    assert (contacts.members(9), contacts.members(10)) == ((), ("T1",))
    team.join("T1.1.k", inc=1)
    team.say(keys.done(memory_bus.run, "T1"), Done(10), "T1.1.9", inc=1)
    heard(world)
    assert not contacts.gone("T1")
    assert contacts.done("T1", 10) is None
    team.say(keys.done(memory_bus.run, "T1"), Done(10), "T1.2.9", inc=2)
    heard(world)
    assert contacts.done("T1", 10) == Done(10)


PAUSE_S = 600.0
"""Between repetitions, in simulated seconds: `fast` time leaps there when all has been said."""


class Still:
    """A simulation in which nothing happens."""

    def handle(self, mail: tuple[Envelope, ...]) -> None:
        pass

    def next_s(self) -> float | None:
        return None

    def advance(self, to_s: float) -> None:
        pass


@pytest.fixture
def conducted(memory_bus: Bus, threads: Threads) -> Callable[[str], tuple[Node, ByHand, Collected[Tick]]]:
    def start(mode: str) -> tuple[Node, ByHand, Collected[Tick]]:
        world, team = memory_bus.node("world", mode=mode), ByHand(memory_bus, "T1")
        ticks: Collected[Tick] = Collected()
        team.transport.subscribe(keys.tick(memory_bus.run), lambda _, payload: ticks.add(opened(payload).body))  # type: ignore[arg-type]
        world.request("T1", Observe("T1"), retry_s=PAUSE_S)
        threads.stops.append(world.stop)
        given = {"participants": ("T1",), "mode": mode, "return_s": 60.0, "lease_s": 60.0}
        threads.start(lambda: run_world(world, Still(), **given, on_contact=lambda *_: None))  # type: ignore[arg-type]
        ticks.wait(len)  # now the world listens
        team.join("T1.1.j")
        return world, team, ticks

    return start


def test_a_round_that_somebody_has_not_heard_of_is_announced_again(
    conducted: Callable[[str], tuple[Node, ByHand, Collected[Tick]]],
) -> None:
    _, _, ticks = conducted("fast")
    found = ticks.wait(lambda items: sum("T1" in tick.participants for tick in items) >= 2)
    assert len({tick.round for tick in found if "T1" in tick.participants}) == 1


@pytest.mark.parametrize("mode", ["fast", "realtime"])
def test_who_comes_again_is_asked_again_what_it_has_not_answered(
    conducted: Callable[[str], tuple[Node, ByHand, Collected[Tick]]], mode: str
) -> None:
    """Its former life may have taken the question with it."""
    _, team, ticks = conducted(mode)
    team.mail.wait(lambda _: team.told(Observe))
    asked = len(team.told(Observe))
    if mode == "realtime":
        ticks.wait(lambda items: any("T1" in tick.participants for tick in items))
        team.say(keys.mail(team.run, "world", "T1"), Ok(), "T1.1.2", inc=1)
        team.say(keys.mail(team.run, "world", "T1"), Ok(), "T1.2.1", inc=2)
    else:
        round_ = ticks.wait(lambda items: any("T1" in tick.participants for tick in items))[-1].round
        team.say(keys.done(team.run, "T1"), Done(round_), "T1.1.2")
    team.mail.wait(lambda _: len(team.told(Observe)) > asked)
    assert team.told(Observe)[asked].at_s < PAUSE_S
