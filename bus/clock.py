"""Time. The only module that reads the wall clock, and the world's side of simulated time (`run_world`).

The agents' side is in `bus.participant`. How the two modes work is under *Time* in docs/architecture.md.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, Protocol

from bus.messages import Envelope

if TYPE_CHECKING:
    from bus.node import Node
    from bus.options import Mode

ContactState = Literal["present", "lost_contact", "back", "stopped"]
OnContact = Callable[[str, ContactState], None]


def wall_s() -> float:
    """Seconds on a clock that never jumps; only differences mean something."""
    return time.monotonic()


def date_s() -> float:
    """Seconds since 1970, for file names and logs."""
    return time.time()


class Simulation(Protocol):
    """What the clock drives. All calls come from one thread, in order of simulated time."""

    def handle(self, mail: tuple[Envelope, ...]) -> None:
        """Take mail that has arrived at the node's `now_s`."""

    def next_s(self) -> float | None:
        """The next simulated time at which there is something to say; None: not until mail arrives."""

    def advance(self, to_s: float) -> None:
        """Live on until `to_s`; `now_s` of the node is `to_s` already."""


def run_world(
    node: Node,
    simulation: Simulation,
    *,
    participants: tuple[str, ...],
    mode: Mode,
    factor: float = 1.0,
    start_s: float = 0.0,
    lease_s: float = 3.0,
    return_s: float = 15.0,
    on_contact: OnContact,
) -> None:
    """Own simulated time for a run, from `start_s`, until `node.stop()`, SIGTERM or SIGINT.

    It begins when all `participants` have joined. One whose presence token vanishes has `return_s` wall seconds to
    join again; one that shows no sign of life for `lease_s` wall seconds is out of contact at once. `on_contact`
    hears of every change, on this thread, between rounds.
    """
    # Here, not above: both modules need the clock's readings from this one.
    from bus import pace, rounds
    from bus.contacts import Contacts
    from bus.signals import stopping

    contacts = Contacts(node.post, participants, lease_s=lease_s, return_s=return_s)
    with stopping(node.stop):
        if mode == "fast":
            rounds.run(node.post, simulation, contacts, start_s, on_contact)
        else:
            pace.run(node.post, simulation, contacts, start_s, factor, on_contact)
