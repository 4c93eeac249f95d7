"""What others say of help, taken in: the second half of the state machine of `agents.autonomous.helping`. Pure."""

from __future__ import annotations

from msgspec.structs import replace

from agents.autonomous.helping import Cancel, Help, Phase, alone
from bus.messages import Body, HelpAnswer, HelpCall, HelpSettled, HelpStands, RobotSent


def heard_call(me: str, help_: Help, source: str, body: HelpCall, able: HelpAnswer) -> tuple[Help, HelpAnswer]:
    """A call of another team; `able` is what this team would answer to it if it had no other promise to keep.

    Of two who call at the same time, the one whose name comes first is heard.
    """

    def no(reason: str) -> tuple[Help, HelpAnswer]:
        return help_, HelpAnswer(body.number, False, able.room, 0, True, reason)

    if body.number <= help_.settled.get(source, 0):
        return no("that call is settled")
    if help_.phase == "promised" and help_.partner == source:
        help_ = alone(help_)  # a newer call: the older one is void
    if help_.engaged or help_.phase in ("promised", "confirming"):
        return no("engaged with another team")
    if help_.phase == "calling" and me < source:
        return no("calling for help itself")
    if not able.yes:
        return help_, able
    off = _released(me, help_, "") if help_.phase == "calling" else ()
    promised = replace(
        alone(help_),
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
            return alone(help_), HelpStands(False)
        return replace(help_, phase="called" if help_.kind == "want" else "coming"), HelpStands(True)
    if ours and not body.confirmed and help_.phase in ("called", "coming", "confirming"):
        return replace(alone(help_), phase="refused" if help_.caller == me else "none"), HelpStands(False)
    if ours and not body.confirmed and help_.phase in ("underway", "here", "returning"):
        return alone(help_), HelpStands(False)  # its own team calls the robot home
    if ours and not body.confirmed and help_.phase in ("sending", "lent"):
        return replace(help_, phase="recalling"), HelpStands(False)  # it was sent back while we were out of contact
    return help_, HelpStands(ours and help_.engaged and body.confirmed)


def heard_stands(help_: Help, source: str, about: Body, body: HelpStands) -> Help:
    """What became of something that was told: `about` is what this is the reply to."""
    match about:
        case HelpSettled(caller, number, False):
            return replace(help_, off=tuple(o for o in help_.off if o != (source, caller, number)))
        case HelpSettled(_, number, True) if help_.phase == "confirming" and number == help_.number:
            if body.stands:
                return replace(help_, phase="coming" if help_.kind == "want" else "called")
            return replace(alone(help_), phase="refused")
        case RobotSent(caller, number, back=back) if (caller, number) == (help_.caller, help_.call):
            if help_.phase == "sending" and not back:
                return replace(help_, phase="lent" if body.stands else "homing")
            if help_.phase == "returning" and back:
                return alone(help_)
    return help_


def heard_sent(help_: Help, source: str, body: RobotSent) -> tuple[Help, HelpStands]:
    """A robot has left for here, or is on its way back."""
    if (help_.caller, help_.call, help_.partner) != (body.caller, body.number, source):
        return help_, HelpStands(False)
    if body.back:
        if help_.phase in ("sending", "lent", "recalling"):
            help_ = replace(help_, phase="homing")
        return help_, HelpStands(help_.phase == "homing")
    if help_.phase in ("coming", "confirming"):  # who has left has heard the confirmation
        help_ = replace(help_, phase="underway", robot=body.robot, name=body.name)
    return help_, HelpStands(help_.asker)


def lost(me: str, help_: Help, name: str) -> Help:
    """A team is out of contact: nobody waits for it, unless a robot is with it or on its way to or from it. Who has
    sent its robot back tells it later."""
    match help_.phase:
        case "calling" if name in help_.asked and name not in help_.answers:
            silent = HelpAnswer(help_.number, False, "-", later=True, reason="it is out of contact")
            help_ = replace(help_, off=(*help_.off, (name, me, help_.number)))  # the call may still get there
            return heard_answer(me, help_, name, silent)
        case "returning" if help_.partner == name:
            return replace(alone(help_), off=(*help_.off, (name, help_.caller, help_.call)))
        case "confirming" | "called" | "coming" | "promised" if help_.partner == name:
            off = () if help_.phase == "promised" else ((name, help_.caller, help_.call),)
            phase: Phase = "refused" if help_.caller == me else "none"
            return replace(alone(help_), phase=phase, off=(*help_.off, *off))
    return help_


def _released(me: str, help_: Help, but: str) -> tuple[Cancel, ...]:
    """Whom to release from the own call, all but one: who has not answered as well, since a yes may be on its way."""
    may_hold = (peer for peer in help_.asked if peer not in help_.answers or help_.answers[peer].yes)
    return tuple((peer, me, help_.number) for peer in may_hold if peer != but)
