"""What all messages are made of: names, texts, numbers with their ranges, and the base of all bodies."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

SCHEMA_VERSION = 1

Name = Annotated[str, msgspec.Meta(min_length=1, max_length=64)]
Id = Annotated[str, msgspec.Meta(min_length=1, max_length=200)]
"""Of a message: it may be made of several names."""
Text = Annotated[str, msgspec.Meta(max_length=2000)]
Value = int | str
State = dict[str, Value]
Count = Annotated[int, msgspec.Meta(ge=0)]
Units = Annotated[int, msgspec.Meta(ge=0, le=1_000_000)]
"""Of a domain's time; planners count in 32 bits."""
Seconds = Annotated[float, msgspec.Meta(ge=0)]
Step = Annotated[int, msgspec.Meta(ge=0)]
Steps = tuple[tuple[str, ...], ...]
Outcome = Literal["as_planned", "finished", "discrepancy", "order_changed", "recovered", "refused"]


class Body(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag=True):
    """Base of everything that travels inside an `Envelope`."""
