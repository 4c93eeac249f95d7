"""Anybody: disturbing, looking for one another, and asking for events that were missed."""

from __future__ import annotations

from typing import Annotated

import msgspec

from bus.messages.basics import Body, Count, Name, Seconds, Text, Value


class Inject(Body, frozen=True):
    """Disturb the world, its processes or its links; see `bus.faults` for kinds. Reply: `Injected`."""

    kind: Name
    target: Name
    args: dict[str, Value | float] = {}


class Injected(Body, frozen=True):
    accepted: bool
    reason: Text = ""


class Impair(Body, frozen=True):
    """Make the receiver's outgoing mail to `to` (``*``: everybody) unreliable. Probabilities in [0, 1],
    delay in simulated seconds. Reply: `Ok`."""

    to: Name = "*"
    drop: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    repeat: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    late: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    late_s: Seconds = 0.0
    seed: int = 0


class Ping(Body, frozen=True):
    """Are you there? Reply: `Ok`, from the receiver's node itself."""


class Ok(Body, frozen=True):
    """Done; nothing else to say."""


class EventsFrom(Body, frozen=True):
    """Send your recorded events of incarnation `incarnation` from number `first` again. Reply: `EventsAre`."""

    incarnation: Count
    first: Count


class EventsAre(Body, frozen=True):
    """`packed` are encoded `Envelope`s of `Event`s, at most a few hundred; `last` is the highest number
    that the source has emitted in that incarnation."""

    incarnation: Count
    last: Count
    packed: tuple[bytes, ...]
