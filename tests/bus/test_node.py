"""What a node promises to its owner, over both transports."""

from __future__ import annotations

from pathlib import Path

import pytest

from bus import keys
from bus.codec import decode, encode
from bus.messages import (
    Envelope,
    Event,
    Execute,
    Executed,
    Impair,
    Observe,
    Observed,
    Ok,
    Ping,
    Status,
    Tick,
)
from bus.node import NoAnswer, Node
from tests.bus import toys
from tests.bus.conftest import Bus, Collected, Threads, serve
from tests.bus.test_codec import envelope


def test_ask_and_answer(bus: Bus, server: Node) -> None:
    client = bus.node("client", outsider=True)
    for _ in range(3):
        assert client.ask("server", Observe("T1"), timeout_s=5.0) == Observed("T1", {"seen": 1})
    assert client.ask("server", Ping(), timeout_s=5.0) == Ok()


def test_nobody_answers(bus: Bus) -> None:
    client = bus.node("client", outsider=True)
    with pytest.raises(NoAnswer, match=r"ghost did not answer Ping within 0.1 s"):
        client.ask("ghost", Ping(), timeout_s=0.1)


def test_requests_and_replies_in_turns(bus: Bus, server: Node) -> None:
    client = bus.node("client", outsider=True)
    asked = [client.request("server", Observe(f"T{number}")) for number in range(5)]
    answered: dict[str, str] = {}
    for turn in client.turns():
        for message in turn.mail:
            assert isinstance(message.body, Observed)
            answered[message.re] = message.body.team
        if len(answered) == 5:
            client.stop()
    assert answered == {request: f"T{number}" for number, request in enumerate(asked)}


def test_a_request_is_repeated_until_its_receiver_comes(bus: Bus, threads: Threads) -> None:
    client = bus.node("client", outsider=True)
    client.request("server", Observe("T1"), retry_s=0.05)
    late = bus.node("server", outsider=True)
    threads.stops.append(late.stop)
    threads.start(serve, late)
    for turn in client.turns():
        if turn.mail:
            assert turn.mail[0].body == Observed("T1", {"seen": 1})
            client.stop()


def test_what_was_forgotten_is_neither_repeated_nor_delivered(bus: Bus) -> None:
    client, other = bus.node("client", outsider=True), bus.transport()
    request = client.request("server", Observe("T1"), retry_s=0.05)
    client.forget(request)
    reply = envelope(Observed("T1", {}), run=bus.run, src="server", id="server.1.1", re=request)
    other.put(keys.mail(bus.run, "client", "server"), encode(reply))
    news = envelope(Observe("T2"), run=bus.run, src="server", id="server.1.2")
    other.put(keys.mail(bus.run, "client", "server"), encode(news))
    for turn in client.turns():
        if turn.mail:
            assert [message.body for message in turn.mail] == [Observe("T2")]
            client.stop()


def test_a_repeated_request_is_answered_again_but_delivered_once(bus: Bus, threads: Threads, tmp_path: Path) -> None:
    """Also by the next life of the server."""
    replies: Collected[Envelope] = Collected()
    stranger = bus.transport()

    def on_reply(_: str, payload: bytes) -> None:
        message = decode(payload)
        assert isinstance(message, Envelope)
        replies.add(message)

    stranger.subscribe(keys.mail(bus.run, "stranger", "*"), on_reply)
    request = encode(envelope(Observe("T1"), run=bus.run, src="stranger", id="stranger.1.1"))
    seen: Collected[Envelope] = Collected()
    for life in (1, 2):
        server = bus.node("server", outsider=True, home=tmp_path)
        threads.stops.append(server.stop)
        thread = threads.start(serve, server, seen)
        for copy in (1, 2):
            stranger.put(keys.mail(bus.run, "server", "stranger"), request)
            replies.wait(lambda items, count=2 * life - 2 + copy: len(items) >= count)  # type: ignore[misc]
        server.stop()
        thread.join(10)
        server.close()
    assert len(seen.items) == 1
    assert [(r.re, r.id, r.body) for r in replies.items] == 4 * [
        ("stranger.1.1", "re.stranger.1.1", Observed("T1", {"seen": 1}))
    ]
    assert [r.inc for r in replies.items] == [1, 1, 2, 2]


def test_replies_to_long_names_are_told_apart(bus: Bus, server: Node) -> None:
    client = bus.node("client", outsider=True)
    asked = {client.request("server", Observe("T1"), request_id="x" * 100 + tail) for tail in "ab"}
    replies: dict[str, str] = {}
    for turn in client.turns():
        replies |= {message.re: message.id for message in turn.mail}
        if len(replies) == 2:
            client.stop()
    assert set(replies) == asked
    assert len({*replies.values()}) == 2


def test_a_reply_goes_out_with_its_transaction(bus: Bus) -> None:
    """If the change is not kept, neither is the reply: the repeated request is handled anew."""
    server = bus.node("server", outsider=True)
    tries: list[int] = []

    def careful() -> None:
        for turn in server.turns():
            for message in turn.mail:
                with server.journal.transaction():
                    tries.append(1)
                    server.journal.put("count", b"%d" % len(tries))
                    server.reply(message, Executed("T1", len(tries), {}))
                    if len(tries) == 1:
                        raise RuntimeError("died")

    bus.node("client", outsider=True).request("server", Execute("T1", 0))
    with pytest.raises(RuntimeError, match="died"):
        careful()
    assert server.journal.get("count") is None
    assert server.post.outbox.total == 0


def test_hostile_mail_is_refused_counted_and_told(bus: Bus, server: Node) -> None:
    events: Collected[Event] = Collected()

    def on_event(_: str, payload: bytes) -> None:
        message = decode(payload)
        assert isinstance(message, Envelope)
        assert isinstance(message.body, Event)
        events.add(message.body)

    stranger = bus.transport()
    stranger.subscribe(keys.event(bus.run, "server"), on_event)
    mailbox = keys.mail(bus.run, "server", "stranger")
    stranger.put(mailbox, b"\xc1")
    stranger.put(mailbox, b"\x93\x01")
    stranger.put(mailbox, encode(envelope(Ping(), run="another")))
    assert bus.node("client", outsider=True).ask("server", Ping(), timeout_s=5.0) == Ok()
    server.wake_soon()
    events.wait(lambda items: {e.data["reason"] for e in items} >= {"malformed", "wrong_run"})
    assert {(e.kind, e.data["reason"], e.data["count"]) for e in events.items} == {
        ("refused", "malformed", 2),
        ("refused", "wrong_run", 1),
    }


def test_whose_name_is_in_the_key_must_be_the_source(bus: Bus) -> None:
    node = bus.node("watcher", outsider=True)
    heard: list[str] = []
    node.post.listen(keys.beat(bus.run, "*"), lambda message: heard.append(message.src))
    stranger = bus.transport()
    stranger.put(keys.beat(bus.run, "T1"), encode(envelope(Ping(), run=bus.run, src="T2")))
    stranger.put(keys.beat(bus.run, "T1"), encode(envelope(Ping(), run=bus.run, src="T1")))
    while "T1" not in heard:
        assert node.post.wait(5.0) or not heard
    assert heard.count("T2") == 0
    assert node.post.inbox.refused == {"forged": 1}


def test_hostile_round_numbers_do_not_keep_mail_for_ever(memory_bus: Bus, threads: Threads) -> None:
    world, agent = memory_bus.node("world"), memory_bus.node("T1")
    threads.stops += [world.stop, agent.stop]
    threads.start(lambda: toys.world(world, participants=("T1",)))
    threads.start(serve, agent)
    stranger = memory_bus.transport()
    answers: Collected[str] = Collected()
    stranger.subscribe(keys.mail(memory_bus.run, "stranger", "*"), lambda key, _: answers.add(key))
    far = envelope(Observe("T1"), run=memory_bus.run, src="stranger", id="stranger.1.1", round=2**60)
    for receiver in ("world", "T1"):
        stranger.put(keys.mail(memory_bus.run, receiver, "stranger"), encode(far))
    answers.wait(lambda items: len(items) == 1)


def test_only_the_world_tells_a_watcher_the_time(bus: Bus) -> None:
    watcher, stranger = bus.node("watcher", outsider=True), bus.transport()
    watcher.wake_soon()
    next(watcher.turns())
    for number, (source, run) in enumerate((("world", bus.run), ("mallory", bus.run), ("world", "another")), 1):
        tick = Tick("fast", number, 10.0 * number)
        stranger.put(keys.tick(bus.run), encode(envelope(tick, run=run, src=source)))
        while watcher.now_s == 0.0 or watcher.post.inbox.refused.total() < number - 1:
            watcher.post.wait(0.01)
        assert watcher.now_s == 10.0
    assert watcher.post.inbox.refused == {"forged": 1, "wrong_run": 1}


def test_late_comers_see_the_latest_status(bus: Bus) -> None:
    node = bus.node("T1", outsider=True)
    node.status(Status("team", "planning"))
    node.status(Status("team", "executing", step=3))
    seen: Collected[str] = Collected()

    def on_status(_: str, payload: bytes) -> None:
        message = decode(payload)
        assert isinstance(message, Envelope)
        assert isinstance(message.body, Status)
        seen.add(message.body.doing)

    bus.transport().subscribe(keys.status(bus.run, "*"), on_status, history=True)
    seen.wait(lambda items: "executing" in items)


def test_a_reply_counts_only_from_who_was_asked(bus: Bus) -> None:
    client, other = bus.node("client", outsider=True), bus.transport()
    request = client.request("server", Observe("T1"))
    for source, seen in (("mallory", 666), ("server", 1)):  # taken in this order, by their names
        reply = envelope(Observed("T1", {"seen": seen}), run=bus.run, src=source, id=f"{source}.1.1", re=request)
        other.put(keys.mail(bus.run, "client", source), encode(reply))
    heard = []
    for turn in client.turns():
        heard += [message.body for message in turn.mail]
        if heard:
            client.stop()
    assert heard == [Observed("T1", {"seen": 1})]


def test_impaired_links_lose_mail_and_requests_get_through(bus: Bus, server: Node) -> None:
    client, world = bus.node("client", outsider=True), bus.node("world", outsider=True)
    assert client.ask("server", Impair("client", drop=1.0), timeout_s=5.0) == Ok()
    assert server.post.inbox.refused == {"not_yours": 1}, "disturbances are the world's business"
    assert world.ask("server", Impair("client", drop=0.4, seed=5), timeout_s=5.0) == Ok()
    asked = {client.request("server", Observe("T1"), retry_s=0.02) for _ in range(20)}
    for turn in client.turns():
        asked -= {message.re for message in turn.mail}
        if not asked:
            client.stop()
    assert server.post.outbox.repeated > 0


def test_a_bad_link_stays_bad_for_the_next_life(bus: Bus, threads: Threads, tmp_path: Path) -> None:
    world = bus.node("world", outsider=True)
    first = bus.node("T1", outsider=True, home=tmp_path)
    threads.stops.append(first.stop)
    thread = threads.start(serve, first)
    for impair in (Impair("client", drop=1.0), Impair("world", late=0.5, late_s=0.1), Impair("world")):
        assert world.ask("T1", impair, timeout_s=5.0) == Ok()
    first.stop()
    thread.join(10)
    first.close()
    second = bus.node("T1", outsider=True, home=tmp_path).post.outbox.impairments
    assert second.fate("client", "T1.2.1").now == 0
    assert second.fate("world", "T1.2.2").now == 1, "this one was mended"
