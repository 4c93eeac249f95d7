"""Bad links on demand: what happens to a node's outgoing mail while an `Impair` is in force.

The fate of a message hangs on the seed, its id and how often it was sent before, and on nothing else: not on
threads, not on time. A message that is sent again gets another chance.
"""

from __future__ import annotations

import random
from typing import NamedTuple

from bus.messages import Impair

REMEMBERED = 10_000
"""Of so many messages it is known how often they were sent; those that were not sent for longest are forgotten."""


class Fate(NamedTuple):
    """What becomes of a message: so many copies now, and so many after `late_s` simulated seconds."""

    now: int = 1
    later: int = 0
    late_s: float = 0.0


class Impairments:
    """The impairments of one node, one per receiver; ``*`` counts for all that have none of their own."""

    def __init__(self) -> None:
        self._by_receiver: dict[str, Impair] = {}
        self._sent: dict[tuple[str, str], int] = {}
        """How often each message was sent, that of the latest last."""

    def set(self, impair: Impair) -> None:
        """Put an impairment in force; one without effect ends the one before it."""
        if impair.drop or impair.repeat or impair.late:
            self._by_receiver[impair.to] = impair
        else:
            self._by_receiver.pop(impair.to, None)

    def fate(self, receiver: str, message_id: str) -> Fate:
        """Decide about one sending of a message."""
        impair = self._by_receiver.get(receiver) or self._by_receiver.get("*")
        if impair is None:
            return Fate()
        times = self._sent.pop((receiver, message_id), 0) + 1
        self._sent[receiver, message_id] = times
        if len(self._sent) > REMEMBERED:
            del self._sent[next(iter(self._sent))]
        dice = random.Random(f"{impair.seed} {receiver} {message_id} {times}")
        if dice.random() < impair.drop:
            return Fate(now=0)
        copies = 2 if dice.random() < impair.repeat else 1
        if dice.random() < impair.late:
            return Fate(now=0, later=copies, late_s=impair.late_s)
        return Fate(now=copies)
