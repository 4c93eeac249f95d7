"""Events of a node: those that exist, and how they can be had again."""

from __future__ import annotations

from pathlib import Path

import pytest

from bus import keys
from bus.codec import decode
from bus.messages import Beat, Envelope, EventsAre, EventsFrom, Ok, Ping
from bus.node import Node
from tests.bus.conftest import Bus, Threads, serve


def test_events_can_be_had_again_also_those_of_a_former_life(bus: Bus, threads: Threads, tmp_path: Path) -> None:
    first = bus.node("T1", outsider=True, home=tmp_path)
    for number in range(250):
        first.emit("refused", "nothing happened", reason="none", count=number)
    first.close()
    second = bus.node("T1", outsider=True, home=tmp_path)
    second.emit("started", "here again", incarnation=2)
    threads.stops.append(second.stop)
    threads.start(serve, second)
    recorder = bus.node("recorder", outsider=True)
    have: list[Envelope] = []
    while len(have) < 250:
        answer = recorder.ask("T1", EventsFrom(1, len(have) + 1), timeout_s=5.0)
        assert isinstance(answer, EventsAre)
        assert answer.last == 250
        for packed in answer.packed:
            message = decode(packed)
            assert isinstance(message, Envelope)
            have.append(message)
    assert [message.seq for message in have] == list(range(1, 251))
    assert len({message.id for message in have}) == 250
    answer = recorder.ask("T1", EventsFrom(2, 1), timeout_s=5.0)
    assert isinstance(answer, EventsAre)
    assert (answer.last, len(answer.packed)) == (1, 1)


def test_an_event_that_fills_half_a_message_does_not_block_those_after_it(bus: Bus, threads: Threads) -> None:
    recorder, server = bus.node("recorder", outsider=True), bus.node("server", outsider=True)
    for text in ("x" * 600, "short"):
        server.emit("refused", text, reason="none", count=1, more=[text] * 1000)
    threads.stops.append(server.stop)
    threads.start(serve, server)
    numbers = []
    for first in (1, 2):
        answer = recorder.ask("server", EventsFrom(server.incarnation, first), timeout_s=5.0)
        assert isinstance(answer, EventsAre)
        numbers += [event.seq for event in map(decode, answer.packed) if isinstance(event, Envelope)]
    assert numbers[0] == 1
    assert numbers[-1] == 2


def test_an_unknown_kind_of_event_is_a_bug() -> None:
    from bus.memory_transport import MemoryRouter

    bus = Bus(MemoryRouter().connect)
    with pytest.raises(ValueError, match="no kind of event is called 'hapened'"):
        bus.node("T1").emit("hapened", "")
    bus.close()


def test_who_asks_for_events_gets_the_latest_figures(bus: Bus, server: Node) -> None:
    """The verdict counts messages by signs of life: without this, all since the last one would be missing."""
    client = bus.node("client", outsider=True)
    beats: list[Beat] = []
    client.post.listen(keys.beat(bus.run, "server"), lambda e: beats.append(e.body))  # type: ignore[arg-type]
    for _ in range(3):
        assert client.ask("server", Ping(), timeout_s=5.0) == Ok()
    assert isinstance(client.ask("server", EventsFrom(1, 1), timeout_s=5.0), EventsAre)
    while not any(beat.received >= 4 and beat.sent >= 3 for beat in beats):
        assert client.post.wait(0.2), "the next beat by itself would take longer"
