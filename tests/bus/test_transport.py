"""One suite for both transports."""

from __future__ import annotations

import threading

import pytest

from bus.transport import TransportError
from tests.bus.conftest import Bus, Collected, free_endpoint

Messages = Collected[tuple[str, bytes]]


def test_messages_arrive_in_order(bus: Bus) -> None:
    got: Messages = Collected()
    bus.transport().subscribe(f"{bus.run}/mail/a", got.pair)
    sender = bus.transport()
    for number in range(200):
        sender.put(f"{bus.run}/mail/a", b"%d" % number)
    expected = [(f"{bus.run}/mail/a", b"%d" % number) for number in range(200)]
    assert got.wait(lambda items: len(items) >= 200) == expected


def test_expressions_match_one_part_or_many(bus: Bus) -> None:
    one: Messages = Collected()
    many: Messages = Collected()
    receiver, sender = bus.transport(), bus.transport()
    receiver.subscribe(f"{bus.run}/event/*", one.pair)
    receiver.subscribe(f"{bus.run}/**", many.pair)
    for key in ("event/a", "event/a/b", "other", "event/c"):
        sender.put(f"{bus.run}/{key}", b"")
    assert [key for key, _ in many.wait(lambda items: len(items) >= 4)] == [
        f"{bus.run}/{key}" for key in ("event/a", "event/a/b", "other", "event/c")
    ]
    assert [key for key, _ in one.wait(lambda items: len(items) >= 2)] == [f"{bus.run}/event/a", f"{bus.run}/event/c"]


def test_who_comes_late_gets_the_latest_value(bus: Bus) -> None:
    sender, receiver = bus.transport(), bus.transport()
    sender.keep(f"{bus.run}/status/a", b"old")
    sender.keep(f"{bus.run}/status/a", b"new")
    got: Messages = Collected()
    receiver.subscribe(f"{bus.run}/status/*", got.pair, history=True)
    got.wait_for((f"{bus.run}/status/a", b"new"))
    sender.keep(f"{bus.run}/status/a", b"newest")
    assert got.wait(lambda items: items[-1][1] == b"newest")


def test_a_kept_value_reaches_plain_subscribers_too(bus: Bus) -> None:
    got: Messages = Collected()
    bus.transport().subscribe(f"{bus.run}/status/*", got.pair)
    bus.transport().keep(f"{bus.run}/status/a", b"value")
    got.wait_for((f"{bus.run}/status/a", b"value"))


def test_a_slow_reader_of_the_latest_gets_the_last_message(bus: Bus) -> None:
    got: Messages = Collected()
    gate = threading.Event()

    def slow(key: str, payload: bytes) -> None:
        if payload != b"0":
            gate.wait(0.01)
        got.pair(key, payload)

    bus.transport().subscribe(f"{bus.run}/frame", slow, latest=True)
    sender = bus.transport()
    for number in range(50):
        sender.put(f"{bus.run}/frame", b"%d" % number)
    got.wait_for((f"{bus.run}/frame", b"49"))


def test_tokens_are_seen_to_come_and_go(bus: Bus) -> None:
    early, late = bus.transport(), bus.transport()
    early.present(f"{bus.run}/live/a")
    seen: Collected[tuple[str, bool]] = Collected()
    watcher = bus.transport()
    watcher.watch(f"{bus.run}/live/*", seen.pair)
    seen.wait_for((f"{bus.run}/live/a", True))
    late.present(f"{bus.run}/live/b")
    seen.wait_for((f"{bus.run}/live/b", True))
    early.close()
    seen.wait_for((f"{bus.run}/live/a", False))
    assert (f"{bus.run}/live/b", False) not in seen.items


def test_nothing_happens_after_close(bus: Bus) -> None:
    got: Messages = Collected()
    closed, sender, other = bus.transport(), bus.transport(), bus.transport()
    closed.subscribe(f"{bus.run}/mail/a", got.pair)
    control: Messages = Collected()
    other.subscribe(f"{bus.run}/mail/a", control.pair)
    closed.close()
    closed.close()
    closed.put(f"{bus.run}/mail/a", b"from the closed one")
    closed.keep(f"{bus.run}/mail/a", b"from the closed one")
    sender.put(f"{bus.run}/mail/a", b"to the closed one")
    control.wait_for((f"{bus.run}/mail/a", b"to the closed one"))
    assert len(control.items) == 1
    assert got.items == []


def test_a_missing_router_is_said_plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    from bus import zenoh_transport

    monkeypatch.setitem(zenoh_transport.CLIENT, "connect/timeout_ms", 200)
    with pytest.raises(TransportError, match="no router answers at"):
        zenoh_transport.connect(free_endpoint())
