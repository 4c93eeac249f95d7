"""How teams help one another, as a pure state machine: what a team holds to, and what it still has to tell others.

Of two who are engaged, the *asker* gets the robot and the *helper* sends it; who of them *called* differs: a want is
called by the asker, an offer by the helper.

| phase      | who    | what it waits for                                                            |
|------------|--------|------------------------------------------------------------------------------|
| none       |        |                                                                              |
| calling    | caller | everybody's answer, or the first yes                                         |
| confirming | caller | that the one who said yes first holds to it                                  |
| refused    | caller | nobody can, or not any more: what to do now is decided by who called         |
| promised   | other  | being confirmed or released                                                  |
| called     | helper | that its robot is free, and has left by the door                             |
| sending    | helper | that the asker has heard that it left                                        |
| lent       | helper | that the asker sends the robot back                                          |
| recalling  | helper | that its robot has come in, which it calls home itself                       |
| homing     | helper | that its robot has come in, and is back where it was                         |
| coming     | asker  | that the helper's robot leaves for here                                      |
| underway   | asker  | that it has come in                                                          |
| here       | asker  | that it is not needed any more, and has left by the door                     |
| returning  | asker  | that the helper has heard that it left                                       |

`Help` is journalled by its owner at each change. What it still has to tell follows from it (`pending`), so whoever
comes back from the dead goes on telling it, under the same ids. A partner that is lost from sight is given up, unless a
robot is with it or on its way. An asker that has been out of contact for as long as it was to have the robot
(`term_units`) is not waited for any more: the helper calls the robot home, and tells the asker when that is back. A
helper that is out of contact when its robot leaves for home learns of that when it is back.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

import msgspec
from msgspec.structs import replace

from bus.messages import Body, HelpAnswer, HelpCall, HelpSettled, RobotSent

Phase = Literal[
    "none", "calling", "confirming", "refused", "promised",
    "called", "sending", "lent", "recalling", "homing", "coming", "underway", "here", "returning",
]  # fmt: skip
ENGAGED = ("called", "sending", "lent", "recalling", "homing", "coming", "underway", "here", "returning")
"""Phases in which there is a partner whose word is confirmed."""
LEAST_TERM_UNITS = 4
"""So long a robot stays with who is out of contact at least: it may be on its way there."""
Cancel = tuple[str, str, int]
"""Whom to tell that the engagement of this caller and number is off."""


class Help(msgspec.Struct, frozen=True):
    """`number` counts the own calls. `caller` and `call` name the engagement or promise under way, `partner` is the
    other one in it, `partner_room` its room. `robot` is the helper's by the name it was built with, `name` what teams
    call it. `asked` are those who got the own call under way, `answers` what they said, `off` what has to be cancelled,
    `settled` by caller the last number that is."""

    phase: Phase = "none"
    number: int = 0
    kind: Literal["want", "offer"] = "want"
    units: int = 0
    strong: bool = False
    about: str = ""
    asked: tuple[str, ...] = ()
    answers: dict[str, HelpAnswer] = {}
    caller: str = ""
    call: int = 0
    partner: str = ""
    partner_room: str = ""
    robot: str = ""
    name: str = ""
    off: tuple[Cancel, ...] = ()
    settled: dict[str, int] = {}

    @property
    def engaged(self) -> bool:
        return self.phase in ENGAGED

    @property
    def arrival_units(self) -> int:
        """Units from when the asker and the helper are agreed until the robot is there."""
        answer = self.answers.get(self.partner)
        return answer.units if answer is not None else self.units

    @property
    def term_units(self) -> int:
        """So long the asker has the robot, as it was told; so long it may be out of contact."""
        return max(self.units, LEAST_TERM_UNITS)

    @property
    def asker(self) -> bool:
        return self.phase in ("coming", "underway", "here", "returning")


# ---------------------------------------------------------------- what is still to be told
def pending(me: str, room: str, help_: Help) -> dict[str, tuple[str, Body]]:
    """By the request's id, to whom what is still to be said."""
    told: dict[str, tuple[str, Body]] = {}
    mine = f"{me}.h.{me}.{help_.number}"
    if help_.phase == "calling":
        body = HelpCall(help_.number, help_.kind, help_.units, room, help_.strong, help_.about)
        told |= {f"{mine}.{peer}": (peer, body) for peer in help_.asked if peer not in help_.answers}
    if help_.phase == "confirming":
        told[f"{mine}.{help_.partner}.yes"] = help_.partner, HelpSettled(me, help_.number, True)
    for to, caller, number in help_.off:
        told[f"{me}.h.{caller}.{number}.{to}.off"] = to, HelpSettled(caller, number, False)
    if help_.phase in ("sending", "returning"):
        back = help_.phase == "returning"
        body_ = RobotSent(help_.caller, help_.call, help_.robot, help_.name, back)
        told[f"{me}.h.{help_.caller}.{help_.call}.{'back' if back else 'sent'}"] = help_.partner, body_
    return told


# ---------------------------------------------------------------- what the team itself does
def call(
    me: str, help_: Help, kind: Literal["want", "offer"], units: int, strong: bool, about: str, peers: Iterable[str]
) -> Help:
    """Ask these teams for help, or offer it to them."""
    assert help_.phase in ("none", "refused"), help_.phase
    asked = tuple(sorted(peers))
    return replace(
        alone(help_),
        phase="calling" if asked else "refused",
        number=help_.number + 1,
        kind=kind,
        units=units,
        strong=strong,
        about=about,
        asked=asked,
        caller=me,
    )


def give_up(help_: Help) -> Help:
    """Call no more: the work has gone away, or nobody can do it."""
    return alone(help_)


def withdraw(help_: Help) -> Help:
    """The work was done before the helper has left for here; or its robot broke before it has left, or with the asker,
    who cannot send it back."""
    assert help_.phase in ("coming", "called", "here"), help_.phase
    return replace(alone(help_), off=(*help_.off, (help_.partner, help_.caller, help_.call)))


def left(help_: Help) -> Help:
    """The robot has left by the door: the helper's own, or the guest."""
    return replace(help_, phase={"called": "sending", "here": "returning"}[help_.phase])


def recalled(help_: Help) -> Help:
    """The asker has been out of contact for too long: the helper calls its robot home, wherever it is."""
    assert help_.phase in ("sending", "lent"), help_.phase
    return replace(help_, phase="recalling", off=(*help_.off, (help_.partner, help_.caller, help_.call)))


def missed(help_: Help) -> Help:
    """The guest is gone: its own team has called it home."""
    assert help_.phase == "here", help_.phase
    return alone(help_)


def chosen(help_: Help, robot: str, name: str) -> Help:
    """The helper knows which of its robots goes."""
    return replace(help_, robot=robot, name=name)


def came(help_: Help) -> Help:
    """The guest has come in, or the own robot that was called home."""
    return replace(help_, phase={"underway": "here", "recalling": "homing"}[help_.phase])


def home(help_: Help) -> Help:
    """The helper's robot is back where it was."""
    return alone(help_)


def alone(help_: Help) -> Help:
    """Engaged with nobody; what is to be cancelled still is."""
    return Help(number=help_.number, off=help_.off, settled=help_.settled)
