"""The clock: rounds of simulated time (see `bus.clock`)."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from bus.messages.basics import Body, Count, Name, Seconds


class Join(Body, frozen=True):
    """I take part from now on."""


class Tick(Body, frozen=True):
    """The world's clock. In ``fast`` mode a round: every participant handles the mail of earlier rounds, of
    which `mail[receiver][sender]` were sent in the round before, and says `Done`. In ``realtime`` mode a
    report of the simulated time and its `factor` against wall time."""

    mode: Literal["fast", "realtime"]
    round: Count
    now_s: Seconds
    factor: Annotated[float, msgspec.Meta(gt=0)] = 1.0
    participants: tuple[Name, ...] = ()
    mail: dict[str, dict[str, Count]] = {}


class Done(Body, frozen=True):
    """I have handled round `round`, sent that many messages to each, and want to be woken at `wake_at_s`
    (negative: only by mail)."""

    round: Count
    sent: dict[str, Count] = {}
    wake_at_s: float = -1.0
