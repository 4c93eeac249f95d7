"""Somebody on the bus who wishes us ill: whatever bytes arrive, the run takes the course that it takes without them."""

from __future__ import annotations

import random
import threading
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest

from bus import keys
from bus import messages as m
from bus.codec import MAX_BYTES, encode
from bus.messages import Body, Envelope, Event
from bus.zenoh_transport import open_client
from ops.recording import event_stream
from tests.system.whole import Live, ended, running

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]

SCENARIO = "factory/growing_order"
VICTIMS = ("coordinator", "T1", "world")
STRANGER = "mallory"
REASONS = (
    *("malformed", "oversized", "too_deep", "not_finite", "unknown_version", "invalid"),  # no message of ours
    *("wrong_run", "forged", "not_yours"),  # a message of ours, and not for its sender to send
)


def test_hostile_messages_change_nothing(tmp_path: Path) -> None:
    undisturbed = ended(SCENARIO, tmp_path / "alone", "--clock", "fast")
    with running(SCENARIO, tmp_path / "attacked", "--clock", "fast") as live:
        over, sent = threading.Event(), Counter[str]()
        attacker = threading.Thread(target=attack, args=(live, over, sent), daemon=True)
        attacker.start()
        attacked = live.wait()
        over.set()
        attacker.join(30)
    assert not attacker.is_alive()
    assert attacked.code == undisturbed.code == 0, attacked.told
    assert sent["rounds"] > 3, "it was over before it was attacked"
    told = [event for event in event_stream(attacked.recording) if event[2] != "refused"]
    assert told == event_stream(undisturbed.recording)
    refused = Counter[str]()
    for envelope in attacked.recording.events:
        if isinstance(envelope.body, Event) and envelope.body.kind == "refused" and envelope.src in VICTIMS:
            refused[str(envelope.body.data["reason"])] += int(str(envelope.body.data["count"]))
    for reason in REASONS:
        assert refused[reason] > 0, f"nothing was refused as {reason}: {refused}"
    assert attacked.told["messages"]["refused"] > 0


def attack(live: Live, over: threading.Event, sent: Counter[str]) -> None:
    """Everything, to everybody, again and again until the run is over."""
    session = open_client(live.connect)
    draw = random.Random(3)
    try:
        while not over.is_set():
            for key, payload in arrows(live.run, draw):
                session.put(key, payload)
            sent["rounds"] += 1
            over.wait(0.05)
    finally:
        session.close()  # type: ignore[no-untyped-call]


def arrows(run: str, draw: random.Random) -> Iterator[tuple[str, bytes]]:
    good = encode(letter(run, m.Observe("T1")))
    for victim in (*VICTIMS, "supervisor", "recorder"):
        key = keys.mail(run, victim, STRANGER)
        yield key, b""
        yield key, draw.randbytes(200)
        yield key, good[: draw.randrange(len(good))]
        yield key, msgspec.msgpack.encode({**msgspec.to_builtins(letter(run, m.Ping())), "v": 99})
        yield key, msgspec.msgpack.encode({**msgspec.to_builtins(letter(run, m.Ping())), "more": 1})
        yield key, msgspec.msgpack.encode({**msgspec.to_builtins(letter(run, m.Ping())), "at_s": float("nan")})
        yield key, encode(letter("elsewhere", m.Ping()))
        yield key, encode(letter(run, deep(40)))
        for body in FORGED:
            yield key, encode(letter(run, body))
            yield key, encode(letter(run, body, src="T2", inc=1))
            yield keys.mail(run, victim, "T2"), encode(letter(run, body, src="T2", inc=1))
    if draw.random() < 0.3:
        yield keys.mail(run, draw.choice(VICTIMS), STRANGER), b"\xc6\x7f\xff\xff\xff" + bytes(MAX_BYTES)
    for source in ("T1", "coordinator", "world"):
        for key in (keys.event(run, source), keys.status(run, source), keys.beat(run, source)):
            yield key, encode(letter(run, m.Event("run_over", {"goal": True})))
            yield key, draw.randbytes(50)
    for key in (keys.tick(run), keys.done(run, "T1"), keys.join(run, "T1"), keys.truth_frame(run)):
        yield key, encode(letter(run, m.Done(10**9)))
        yield key, draw.randbytes(50)


FORGED: tuple[Body, ...] = (
    m.Go(1, 0),
    m.Go(2, 3, recover=True),
    m.Enquire(10**6),
    m.Adopt(1, 0, m.Question("alone", 9), "", (("lineShift",),)),
    m.Ask(1, m.Question("alone", 400)),
    m.Execute("T1", 99, (m.SkillCall("lineShift"),)),
    m.Contact("T1", "lost_contact"),
    m.Order("T1", ("77",)),
    m.Impair("*", drop=1.0),
    m.ProcessFault("kill", "world"),
    m.RunOver(False, "it is over", 0, 0),
    m.StepResult(1, "T1", 0, "finished"),
    m.Executed("T1", 0, {"at(w1)": "(9,9)"}),
)
"""Well-formed, and not for the sender to say."""


def letter(run: str, body: Body, src: str = STRANGER, inc: int = 1) -> Envelope:
    number = next(NUMBERS)
    return Envelope(1, run, src, inc, number, f"{STRANGER}.{number}", 0.0, body)  # type: ignore[arg-type]


def deep(levels: int) -> m.Event:
    data: Any = 1
    for _ in range(levels):
        data = [data]
    return m.Event("question", {"data": data})


NUMBERS = iter(range(1, 10**9))
