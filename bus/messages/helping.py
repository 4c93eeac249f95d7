"""Team agent <-> team agent: help for one another; coordinator <-> team agent: begin, and at rest.

A call for help, or an offer of it, goes to all other teams. Who says yes keeps its word until the caller has settled
it: the first yes is confirmed, all others are released. `caller` and `number` name an engagement from then on: the
helper's robot is sent, and sent back.
"""

from __future__ import annotations

from typing import Literal

import msgspec

from bus.messages.basics import Body, Count, Name, Text, Units


class Present(Body, frozen=True):
    """Coordinator -> team: begin, if you have not; these teams, you among them, are in contact now, and those that are
    `stopped` will never be again. The latest `number` counts. Reply: `Ok`."""

    number: Count
    teams: tuple[Name, ...]
    stopped: tuple[Name, ...] = ()


class HelpCall(Body, frozen=True):
    """``want``: who can spare a robot for `units` units of time, `strong` if it is for something heavy? ``offer``: a
    robot of mine could be with you in `units`; who would be helped by it? `number` counts the sender's calls, `room` is
    its room. Reply: `HelpAnswer`."""

    number: Count
    kind: Literal["want", "offer"]
    units: Units
    room: Name
    strong: bool = False
    about: Text = ""


class HelpAnswer(Body, frozen=True):
    """To a want: my robot would be there in `units`. To an offer: so many would be saved. `later`: a no that may become
    a yes. `room` is the room of who answers."""

    number: Count
    yes: bool
    room: Name
    units: Units = 0
    later: bool = False
    reason: Text = ""


class HelpSettled(Body, frozen=True):
    """Your yes to the call `number` of `caller` is confirmed, or you are released; between two who are engaged: I
    withdraw. Reply: `HelpStands`."""

    caller: Name
    number: Count
    confirmed: bool


class RobotSent(Body, frozen=True):
    """The helper's `robot`, under the name it was built with, called `name`, has left for your room, or is on its way
    `back` to it. Reply: `HelpStands`; if it does not stand, the robot is to turn round."""

    caller: Name
    number: Count
    robot: Name
    name: Name
    back: bool = False


class HelpStands(Body, frozen=True):
    """Whether the sender holds to the engagement."""

    stands: bool


class AtRest(Body, frozen=True):
    """Team -> coordinator: nothing more to do, after `steps` steps by `plans` plans. `untidy` says for each thing that
    is not where it belongs why it is not, `late` that the deadline was missed. The latest `number` counts.
    Reply: `Ok`."""

    number: Count
    steps: Count
    plans: Count
    untidy: dict[Name, Text] = msgspec.field(default_factory=dict)
    late: bool = False
