"""World -> coordinator, supervisor: what has changed."""

from __future__ import annotations

from typing import Literal

from bus.messages.basics import Body, Count, Name, Text, Units


class Contact(Body, frozen=True):
    """A process was lost from sight, or is back. Losing contact is not failing. Only of one that is ``stopped`` it is
    known that nobody will start it again. Reply: `Ok`."""

    name: Name
    state: Literal["present", "lost_contact", "back", "stopped"]


class Order(Body, frozen=True):
    """Work was added to or taken from a team's order, or it has another `deadline`, in units of time since the run
    began (0: none any more). Reply: `Ok`."""

    team: Name
    added: tuple[Name, ...] = ()
    cancelled: tuple[Name, ...] = ()
    deadline: Units | None = None


class ProcessFault(Body, frozen=True):
    """Ask the supervisor to disturb a process, for `for_s` simulated seconds where that applies. Reply: `Ok`."""

    kind: Literal["kill", "pause", "resume", "restart", "stop"]
    target: Name


class RunOver(Body, frozen=True):
    """The coordinator's last word. Reply: `Ok`."""

    goal: bool
    reason: Text
    makespan: Count
    replans: Count
