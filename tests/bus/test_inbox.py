"""What waits for a node is bounded, and a flood keeps nobody from the rest of its work."""

from __future__ import annotations

import threading

import pytest

from bus import inbox as inboxes
from bus.codec import MAX_BYTES
from bus.inbox import Inbox


def test_a_flood_does_not_hold_its_receiver_up_for_ever() -> None:
    inbox, handled = Inbox("r"), 0

    def handle(key: str, payload: bytes) -> None:
        nonlocal handled
        handled += 1
        assert handled < 100, "the next message is always there before this one is handled"
        receive(key, payload)

    receive = inbox.into(handle)
    receive("k", b"1")
    receive("k", b"2")
    assert inbox.pump(0.0)
    assert handled == 2
    assert inbox.pump(0.0)
    assert handled == 4


def test_what_is_too_large_for_any_message_does_not_wait() -> None:
    inbox, taken = Inbox("r"), list[int]()
    receive = inbox.into(lambda _, payload: taken.append(len(payload)))
    receive("k", bytes(MAX_BYTES + 1))
    receive("k", bytes(MAX_BYTES))
    inbox.pump(0.0)
    assert taken == [MAX_BYTES]
    assert inbox.refused == {"oversized": 1}


def test_few_large_messages_do_not_eat_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inboxes, "FULL_BYTES", 1000)
    inbox, taken = Inbox("r"), list[int]()
    receive = inbox.into(lambda _, payload: taken.append(len(payload)))
    for size in (600, 400, 1, 1):
        receive("k", bytes(size))
    assert inbox.refused == {"overflow": 2}
    inbox.pump(0.0)
    receive("k", bytes(1000))
    inbox.pump(0.0)
    assert taken == [600, 400, 1000], "what was handled makes room"


def test_many_small_messages_do_not_either(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inboxes, "FULL", 3)
    inbox = Inbox("r")
    receive = inbox.into(lambda *_: None)
    for _ in range(5):
        receive("k", b"")
    assert inbox.refused == {"overflow": 2}


def test_refusals_of_several_threads_are_all_counted() -> None:
    inbox = Inbox("r")
    threads = [threading.Thread(target=lambda: [inbox.refuse("forged") for _ in range(5000)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert inbox.refused == {"forged": 20_000}
