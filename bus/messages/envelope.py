"""The envelope: what every message travels in."""

from __future__ import annotations

from typing import Annotated

import msgspec

from bus.messages.acting import Execute, Executed, Observe, Observed
from bus.messages.basics import Count, Id, Name, Seconds
from bus.messages.clock import Done, Join, Tick
from bus.messages.common import EventsAre, EventsFrom, Impair, Inject, Injected, Ok, Ping
from bus.messages.helping import AtRest, HelpAnswer, HelpCall, HelpSettled, HelpStands, Present, RobotSent
from bus.messages.news import Contact, Order, ProcessFault, RunOver
from bus.messages.sharing import Adopt, Adopted, Answer, Ask, Enquire, Go, Standing, StepResult, Welcome
from bus.messages.streams import Beat, Event, Frame, Status


class Envelope(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """`v` schema version, `run` the run's name, `src` the sender, `inc` the sender's incarnation, `seq` its
    running number, `id` names a message across repetitions, `re` the id that this answers (or empty),
    `round` the clock's round it was sent in (0 in realtime), `at_s` simulated seconds."""

    v: int
    run: Name
    src: Name
    inc: Count
    seq: Count
    id: Id
    at_s: Seconds
    body: (
        Execute | Executed | Observe | Observed | Enquire | Standing | Ask | Answer | Adopt | Adopted | Welcome | Go
        | StepResult
        | HelpCall | HelpAnswer | HelpSettled | RobotSent | HelpStands | AtRest | Present
        | Contact | Order | ProcessFault | RunOver | Inject | Injected | Impair | Ping | Ok | EventsFrom | EventsAre
        | Event | Status | Frame | Beat | Join | Tick | Done
    )  # fmt: skip
    re: Annotated[str, msgspec.Meta(max_length=200)] = ""
    round: Count = 0
