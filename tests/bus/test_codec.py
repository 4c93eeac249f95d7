"""Bytes in, values out: an envelope or a refusal with a reason, never an exception."""

from __future__ import annotations

import math
from typing import Any, get_args

import msgpack
import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus import messages as m
from bus.codec import MAX_BYTES, Reason, Refusal, decode, decode_as, encode
from bus.scene import Scene

BODIES: list[m.Body] = [
    m.Execute("T1", 3, (m.SkillCall("move", ("w1", "right", 2), {"tool": "gripper"}),)),
    m.Executed("T1", 3, {"at(w1)": "(1,3)", "effector(w1)": 1}, {"c1": "broken"}),
    m.Standing(1, "T1", 4, False, 7, m.Offer(m.Question("lend", 9, 2), (m.Question("alone", 5),)), ("w3",)),
    m.Ask(1, m.Question("borrow", 8, 1)),
    m.Answer(1, m.Question("alone", 8), "yes", 7, 0, 0.25, 1200),
    m.Adopt(1, 0, m.Question("alone", 2), plan=(("move(w1,right)",), ())),
    m.StepResult(1, "T1", 2, "discrepancy", ("at(w1)",), (m.Diagnosis(("broken(w1)",), {"broken(w1)": (1, 2)}),)),
    m.Contact("T2", "lost_contact"),
    m.Inject("move", "T1.w1", {"x": 2, "y": 1.5}),
    m.Impair("T1", 0.1, 0.2, 0.3, 2.0, 7),
    m.EventsAre(2, 40, (b"\x00\xff", b"")),
    m.Event("question", {"text": "asked", "within": 7, "causes": [["a"], ["b", "c"]]}),
    m.Status("coordinator", "searching", bound=4, best=-1, exchanges=(m.Exchange("w", "T1.w", "T1", 1, "T2", 3, "g"),)),
    m.Frame(1.5, 3, (m.BodyFrame("T1.w1", "w1", "worker", "T1", 1.0, 2.0),)),
    m.Tick("fast", 12, 3.5, 1.0, ("T1", "T2"), {"T1": {"world": 2}}),
    m.Done(12, {"world": 1}, 4.5),
    m.Ping(),
]


def envelope(body: Any, **changes: Any) -> m.Envelope:
    fields = {"v": 1, "run": "r", "src": "T1", "inc": 1, "seq": 5, "id": "T1.1.5", "at_s": 0.5, "body": body}
    return m.Envelope(**{**fields, **changes})


def plain(of: m.Body, **changes: Any) -> Any:
    """What an envelope is on the wire, to be spoilt."""
    return {**msgspec.to_builtins(envelope(of), builtin_types=(bytes,)), **changes}


def reason(value: Any) -> str:
    refusal = decode(value if isinstance(value, bytes) else msgpack.packb(value))
    assert isinstance(refusal, Refusal), refusal
    assert refusal.reason in get_args(Reason)
    return refusal.reason


@pytest.mark.parametrize("body", BODIES, ids=lambda body: type(body).__name__)
def test_what_is_packed_is_unpacked(body: m.Body) -> None:
    packed = encode(envelope(body, re="world.1.4", round=9))
    assert decode(packed) == envelope(body, re="world.1.4", round=9)


def test_a_frame_of_hundreds_of_bodies_passes() -> None:
    body = m.BodyFrame("T1.w1", "w1", "worker", "T1", 1.0, 2.0, attributes={"effector": 1})
    frame = m.Frame(1.0, 2, (body,) * 600)
    assert decode(encode(envelope(frame))) == envelope(frame)


def test_recorded_events_of_any_size_that_passes_can_be_had_again() -> None:
    large = encode(envelope(m.Event("membership", {"robots": ["x" * 60_000] * 8})))
    assert len(large) > 64 << 10
    body = m.EventsAre(1, 1, (large,))
    assert decode(encode(envelope(body))) == envelope(body)


@pytest.mark.parametrize("factor", [0.0, -1.0])
def test_time_neither_stands_still_nor_runs_backwards(factor: float) -> None:
    """Who divides by it would die of it."""
    wire = plain(m.Tick("realtime", 1, 0.0))
    wire["body"]["factor"] = factor
    assert reason(wire) == "invalid"


def test_the_reasons() -> None:
    ping, execute = m.Ping(), m.Execute("T1", 1)
    deep: Any = 1
    for _ in range(30):
        deep = [deep]
    assert reason(b"\x00" * (MAX_BYTES + 1)) == "oversized"
    assert reason(b"") == "malformed"
    assert reason(encode(envelope(ping))[:-1]) == "malformed"
    assert reason(encode(envelope(ping)) + b"\x00") == "malformed"
    assert reason(b"\x91" * 5000) == "malformed"
    assert reason({"v": 1, "x": msgpack.Timestamp(1)}) == "malformed"
    assert (
        reason(plain(m.Event("started"), body={"type": "Event", "kind": "started", "data": {"x": deep}})) == "too_deep"
    )
    assert reason(plain(ping, body=deep)) == "too_deep"
    assert reason(plain(ping, v=2)) == "unknown_version"
    assert reason(plain(ping, v=True)) == "unknown_version"
    assert reason([1, 2]) == "unknown_version"
    assert reason(plain(ping, extra=1)) == "invalid"
    assert reason(plain(ping, seq=-1)) == "invalid"
    assert reason(plain(ping, seq="5")) == "invalid"
    assert reason(plain(ping, body={"type": "Unheard"})) == "invalid"
    assert reason(plain(execute, body={"type": "Execute", "team": "T1", "step": 1.5})) == "invalid"
    assert reason(plain(execute, body={"type": "Execute", "team": "T1", "step": 1, "more": 0})) == "invalid"
    assert reason(plain(ping, src="**")) == "invalid"
    assert reason(plain(ping, src="a/b")) == "invalid"
    assert reason(plain(ping, run="*")) == "invalid"


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("single", [True, False], ids=["float32", "float64"])
def test_numbers_that_are_not_finite(number: float, single: bool) -> None:
    for spoilt in (
        plain(m.Ping(), at_s=number),
        plain(m.Ping(), body={"type": "Event", "kind": "k", "data": {"x": [number]}}),
    ):
        refusal = decode(msgpack.packb(spoilt, use_single_float=single))
        assert isinstance(refusal, Refusal)
        assert refusal.reason == "not_finite"


def test_bytes_that_only_look_like_an_infinite_number_pass() -> None:
    body = m.EventsAre(1, 1, (b"\xcb\x7f\xf0\x00\x00\x00\x00\x00\x00",))
    assert decode(encode(envelope(body))) == envelope(body)


def test_a_struct_without_an_envelope() -> None:
    packed = encode(m.SkillCall("move", ("w1",)))
    assert decode_as(packed, m.SkillCall) == m.SkillCall("move", ("w1",))
    refusal = decode_as(packed, Scene)
    assert isinstance(refusal, Refusal)


WIRE: st.SearchStrategy[Any] = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats()
    | st.text(max_size=8)
    | st.binary(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=30,
)


@settings(deadline=None)
@given(st.binary(max_size=200))
def test_any_bytes_are_survived(payload: bytes) -> None:
    assert isinstance(decode(payload), Refusal)


@settings(deadline=None)
@given(st.sampled_from(BODIES), st.data())
def test_spoilt_bytes_are_survived(body: m.Body, data: st.DataObject) -> None:
    packed = bytearray(encode(envelope(body)))
    for _ in range(data.draw(st.integers(1, 4))):
        packed[data.draw(st.integers(0, len(packed) - 1))] = data.draw(st.integers(0, 255))
    assert isinstance(decode(bytes(packed)), Refusal | m.Envelope)


@settings(deadline=None)
@given(st.sampled_from(BODIES), WIRE, st.data())
def test_spoilt_structure_is_survived(body: m.Body, value: Any, data: st.DataObject) -> None:
    wire = plain(body)
    inner = wire["body"]
    target = data.draw(st.sampled_from([wire, inner]))
    target[data.draw(st.sampled_from([*target, "extra"]))] = value
    decoded = decode(msgpack.packb(wire))
    assert isinstance(decoded, Refusal | m.Envelope)
    if isinstance(decoded, m.Envelope):
        assert decode(encode(decoded)) == decoded
