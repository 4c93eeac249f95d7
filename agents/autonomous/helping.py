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
| homing     | helper | that its robot has come in, and is back where it was                         |
| coming     | asker  | that the helper's robot leaves for here                                      |
| underway   | asker  | that it has come in                                                          |
| here       | asker  | that it is not needed any more, and has left by the door                     |
| returning  | asker  | that the helper has heard that it left                                       |

`Help` is journalled by its owner at each change. What it still has to tell follows from it (`pending`), so whoever
comes back from the dead goes on telling it, under the same ids. A partner that is lost from sight is given up, unless a
robot is with it or on its way.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

import msgspec
from msgspec.structs import replace

from bus.messages import Body, HelpAnswer, HelpCall, HelpSettled, HelpStands, RobotSent

Phase = Literal[
    "none", "calling", "confirming", "refused", "promised",
    "called", "sending", "lent", "homing", "coming", "underway", "here", "returning",
]  # fmt: skip
ENGAGED = ("called", "sending", "lent", "homing", "coming", "underway", "here", "returning")
"""Phases in which there is a partner whose word is confirmed."""
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
    def asker(self) -> bool:
        return self.phase in ("coming", "underway", "here", "returning")


# ---------------------------------------------------------------- what is still to be told
def pending(me: str, room: str, help_: Help) -> dict[str, tuple[str, Body]]:
    """By the request's id, to whom what is still to be said."""
    told: dict[str, tuple[str, Body]] = {}
    mine = f"{me}.h.{me}{help_.number}"
    if help_.phase == "calling":
        body = HelpCall(help_.number, help_.kind, help_.units, room, help_.strong, help_.about)
        told |= {f"{mine}.{peer}": (peer, body) for peer in help_.asked if peer not in help_.answers}
    if help_.phase == "confirming":
        told[f"{mine}.{help_.partner}.yes"] = help_.partner, HelpSettled(me, help_.number, True)
    for to, caller, number in help_.off:
        told[f"{me}.h.{caller}{number}.{to}.off"] = to, HelpSettled(caller, number, False)
    if help_.phase in ("sending", "returning"):
        back = help_.phase == "returning"
        body_ = RobotSent(help_.caller, help_.call, help_.robot, help_.name, back)
        told[f"{me}.h.{help_.caller}{help_.call}.{'back' if back else 'sent'}"] = help_.partner, body_
    return told


# ---------------------------------------------------------------- what the team itself does
def call(
    me: str, help_: Help, kind: Literal["want", "offer"], units: int, strong: bool, about: str, peers: Iterable[str]
) -> Help:
    """Ask these teams for help, or offer it to them."""
    assert help_.phase in ("none", "refused"), help_.phase
    asked = tuple(sorted(peers))
    return replace(
        _alone(help_),
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
    return _alone(help_)


def withdraw(help_: Help) -> Help:
    """The work was done before the helper has left for here."""
    assert help_.phase == "coming", help_.phase
    return replace(_alone(help_), off=(*help_.off, (help_.partner, help_.caller, help_.call)))


def left(help_: Help) -> Help:
    """The robot has left by the door: the helper's own, or the guest."""
    return replace(help_, phase={"called": "sending", "here": "returning"}[help_.phase])


def chosen(help_: Help, robot: str, name: str) -> Help:
    """The helper knows which of its robots goes."""
    return replace(help_, robot=robot, name=name)


def came(help_: Help) -> Help:
    """The guest has come in."""
    return replace(help_, phase="here")


def home(help_: Help) -> Help:
    """The helper's robot is back where it was."""
    return _alone(help_)


# ---------------------------------------------------------------- what others say
def heard_call(me: str, help_: Help, source: str, body: HelpCall, able: HelpAnswer) -> tuple[Help, HelpAnswer]:
    """A call of another team; `able` is what this team would answer to it if it had no other promise to keep.

    Of two who call at the same time, the one whose name comes first is heard.
    """

    def no(reason: str) -> tuple[Help, HelpAnswer]:
        return help_, HelpAnswer(body.number, False, able.room, 0, True, reason)

    if body.number <= help_.settled.get(source, 0):
        return no("that call is settled")
    if help_.phase == "promised" and help_.partner == source:
        help_ = _alone(help_)  # a newer call: the older one is void
    if help_.engaged or help_.phase in ("promised", "confirming"):
        return no("engaged with another team")
    if help_.phase == "calling" and me < source:
        return no("calling for help itself")
    if not able.yes:
        return help_, able
    off = _released(me, help_, "") if help_.phase == "calling" else ()
    promised = replace(
        _alone(help_),
        phase="promised",
        kind=body.kind,
        caller=source,
        call=body.number,
        partner=source,
        partner_room=body.room,
        units=body.units,
        strong=body.strong,
        about=body.about,
    )
    return replace(promised, off=(*promised.off, *off)), able


def heard_answer(me: str, help_: Help, source: str, body: HelpAnswer) -> Help:
    """An answer to the own call: the first yes is confirmed, all others are released."""
    if help_.phase != "calling" or body.number != help_.number:
        return help_
    help_ = replace(help_, answers={**help_.answers, source: body})
    if body.yes:
        off = (*help_.off, *_released(me, help_, source))
        return replace(help_, phase="confirming", partner=source, partner_room=body.room, call=help_.number, off=off)
    return replace(help_, phase="refused") if all(peer in help_.answers for peer in help_.asked) else help_


def heard_settled(me: str, help_: Help, source: str, body: HelpSettled) -> tuple[Help, HelpStands]:
    """A promise of this team is confirmed or released, or its partner withdraws."""
    ours = (help_.caller, help_.call) == (body.caller, body.number) and help_.partner == source
    if body.caller == source:
        help_ = replace(help_, settled={**help_.settled, source: max(body.number, help_.settled.get(source, 0))})
    if ours and help_.phase == "promised":
        if not body.confirmed:
            return _alone(help_), HelpStands(False)
        return replace(help_, phase="called" if help_.kind == "want" else "coming"), HelpStands(True)
    if ours and not body.confirmed and help_.phase in ("called", "coming"):
        return replace(_alone(help_), phase="refused" if help_.caller == me else "none"), HelpStands(False)
    return help_, HelpStands(ours and help_.engaged and body.confirmed)


def heard_stands(help_: Help, source: str, about: Body, body: HelpStands) -> Help:
    """What became of something that was told: `about` is what this is the reply to."""
    match about:
        case HelpSettled(caller, number, False):
            return replace(help_, off=tuple(o for o in help_.off if o != (source, caller, number)))
        case HelpSettled(_, number, True) if help_.phase == "confirming" and number == help_.number:
            if body.stands:
                return replace(help_, phase="coming" if help_.kind == "want" else "called")
            return replace(_alone(help_), phase="refused")
        case RobotSent(caller, number, back=back) if (caller, number) == (help_.caller, help_.call):
            if help_.phase == "sending" and not back:
                return replace(help_, phase="lent" if body.stands else "homing")
            if help_.phase == "returning" and back:
                return _alone(help_)
    return help_


def heard_sent(help_: Help, source: str, body: RobotSent) -> tuple[Help, HelpStands]:
    """A robot has left for here, or is on its way back."""
    if (help_.caller, help_.call, help_.partner) != (body.caller, body.number, source):
        return help_, HelpStands(False)
    if body.back:
        if help_.phase in ("sending", "lent"):
            help_ = replace(help_, phase="homing")
        return help_, HelpStands(help_.phase == "homing")
    if help_.phase == "coming":
        help_ = replace(help_, phase="underway", robot=body.robot, name=body.name)
    return help_, HelpStands(help_.asker)


def lost(me: str, help_: Help, name: str) -> Help:
    """A team is out of contact: nobody waits for it, unless a robot is with it or on its way."""
    match help_.phase:
        case "calling":
            return heard_answer(me, help_, name, HelpAnswer(help_.number, False, "-", reason="out of contact"))
        case "confirming" | "called" | "coming" | "promised" if help_.partner == name:
            off = () if help_.phase == "promised" else ((name, help_.caller, help_.call),)
            phase: Phase = "refused" if help_.caller == me else "none"
            return replace(_alone(help_), phase=phase, off=(*help_.off, *off))
    return help_


def _alone(help_: Help) -> Help:
    """Engaged with nobody; what is to be cancelled still is."""
    return Help(number=help_.number, off=help_.off, settled=help_.settled)


def _released(me: str, help_: Help, but: str) -> tuple[Cancel, ...]:
    """Whom to release from the own call, all but one: who has not answered as well, since a yes may be on its way."""
    may_hold = (peer for peer in help_.asked if peer not in help_.answers or help_.answers[peer].yes)
    return tuple((peer, me, help_.number) for peer in may_hold if peer != but)
