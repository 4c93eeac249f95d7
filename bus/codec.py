"""Envelopes to bytes and back. Whatever bytes arrive, `decode` returns a value: an `Envelope` or a `Refusal`.

The order: size, msgpack with all limits set, schema version, types, and whether all numbers are finite.
"""

from __future__ import annotations

import re
from math import isfinite
from typing import Any, Literal, NamedTuple, TypeVar

import msgpack
import msgspec

from bus.keys import NAME
from bus.messages import SCHEMA_VERSION, Envelope, Event

MAX_BYTES = 1 << 20
MAX_DEPTH = 12
LIMITS: dict[str, Any] = {
    "raw": False,
    "strict_map_key": True,
    "max_str_len": 64 << 10,
    "max_bin_len": MAX_BYTES,  # an event of any size that passes may be asked for again
    "max_array_len": 8192,
    "max_map_len": 8192,
    "max_ext_len": 0,  # also refuses timestamps, which an ext_hook alone would let through
}

Reason = Literal["oversized", "malformed", "too_deep", "not_finite", "unknown_version", "invalid"]
T = TypeVar("T")


class Refusal(NamedTuple):
    """Why bytes were not taken; `detail` is for people."""

    reason: Reason
    detail: str


_pack = msgspec.msgpack.Encoder().encode
_maybe_not_finite = re.compile(rb"\xca[\x7f\xff][\x80-\xff]|\xcb[\x7f\xff][\xf0-\xff]", re.DOTALL).search
"""Finds the bytes of every number that is not finite, and sometimes bytes that only look like one."""


def encode(message: msgspec.Struct) -> bytes:
    """Pack a message: an `Envelope`, or a struct that travels without one (`bus.scene.Scene`).

    Raises OverflowError for an integer beyond 64 bits, TypeError for data that msgpack has no form for; what else
    `decode` would refuse is not looked for here.
    """
    return _pack(message)


def decode(payload: bytes) -> Envelope | Refusal:
    """Unpack and validate an envelope. Never raises."""
    value = _unpack(payload)
    if isinstance(value, Refusal):
        return value
    version = value.get("v") if isinstance(value, dict) else None
    if version != SCHEMA_VERSION or isinstance(version, bool | float):
        return Refusal("unknown_version", f"expected version {SCHEMA_VERSION}, got {version!r:.40}")
    envelope = _convert(value, payload, Envelope)
    if isinstance(envelope, Envelope) and not (NAME.fullmatch(envelope.src) and NAME.fullmatch(envelope.run)):
        return Refusal("invalid", f"source {envelope.src!r:.40} or run {envelope.run!r:.40} is not a name")
    return envelope


def decode_as(payload: bytes, kind: type[T]) -> T | Refusal:
    """Unpack and validate a struct that travels without an envelope. Never raises."""
    value = _unpack(payload)
    return value if isinstance(value, Refusal) else _convert(value, payload, kind)


def _unpack(payload: bytes) -> Any:
    """Plain Python data within the limits, or a `Refusal`."""
    if len(payload) > MAX_BYTES:
        return Refusal("oversized", f"{len(payload)} bytes, at most {MAX_BYTES}")
    try:
        return msgpack.unpackb(payload, **LIMITS)
    except (ValueError, TypeError, RecursionError) as error:  # TypeError: a map as a key
        return Refusal("malformed", f"{type(error).__name__}: {error}"[:200])


def _convert(value: Any, payload: bytes, kind: type[T]) -> T | Refusal:
    """The typed value. Types bound the depth of all but an event's data, and the bytes show whether a number may not
    be finite, so most messages need no walk through all their values."""
    try:
        typed = msgspec.convert(value, kind, strict=True, builtin_types=(bytes,))
    except (msgspec.ValidationError, RecursionError, OverflowError) as error:
        return _flaw(value) or Refusal("invalid", str(error)[:200])
    if _maybe_not_finite(payload) or isinstance(getattr(typed, "body", None), Event):
        return _flaw(value) or typed
    return typed


def _flaw(value: Any) -> Refusal | None:
    """What is wrong with the values as such."""
    level = [value]
    for _ in range(MAX_DEPTH):
        below: list[Any] = []
        for item in level:
            kind = type(item)
            if kind is dict:
                below.extend(item.values())
            elif kind is list:
                below.extend(item)
            elif kind is float and not isfinite(item):
                return Refusal("not_finite", "a number is not finite")
        if not below:
            return None
        level = below
    return Refusal("too_deep", f"nested deeper than {MAX_DEPTH}")
