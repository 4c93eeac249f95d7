"""The language the processes speak: every message, typed, immutable, units in the names.

A message is an `Envelope` around one *body*. Bodies are grouped by who speaks to whom; a request's
docstring names its reply. A `State` maps a fluent to its value, both written as terms of the
domain's language: ``{"at(w1)": "(1,3)", "effector(w1)": 1, "attached(c1)": "none"}``.

Validation is by type (msgspec): unknown fields, wrong types and unknown tags are refused. Limits that
types cannot say (size, depth, finite numbers) are checked in `bus.codec`.

One module for each group; all names are to be had from here.
"""

from bus.messages.acting import Execute, Executed, Observe, Observed, SkillCall
from bus.messages.basics import SCHEMA_VERSION, Body, Count, Name, Outcome, Seconds, State, Step, Steps, Text, Value
from bus.messages.clock import Done, Join, Tick
from bus.messages.common import EventsAre, EventsFrom, Impair, Inject, Injected, Ok, Ping
from bus.messages.envelope import Envelope
from bus.messages.helping import AtRest, HelpAnswer, HelpCall, HelpSettled, HelpStands, Present, RobotSent
from bus.messages.news import Contact, Order, ProcessFault, RunOver
from bus.messages.sharing import (
    Adopt,
    Adopted,
    Answer,
    Ask,
    Diagnosis,
    Enquire,
    Exchange,
    Go,
    Hand,
    Handover,
    Offer,
    Question,
    Standing,
    StepResult,
    Welcome,
)
from bus.messages.streams import Beat, BodyFrame, Event, Frame, Status

__all__ = [
    "SCHEMA_VERSION",
    "Adopt",
    "Adopted",
    "Answer",
    "Ask",
    "AtRest",
    "Beat",
    "Body",
    "BodyFrame",
    "Contact",
    "Count",
    "Diagnosis",
    "Done",
    "Enquire",
    "Envelope",
    "Event",
    "EventsAre",
    "EventsFrom",
    "Exchange",
    "Execute",
    "Executed",
    "Frame",
    "Go",
    "Hand",
    "Handover",
    "HelpAnswer",
    "HelpCall",
    "HelpSettled",
    "HelpStands",
    "Impair",
    "Inject",
    "Injected",
    "Join",
    "Name",
    "Observe",
    "Observed",
    "Offer",
    "Ok",
    "Order",
    "Outcome",
    "Ping",
    "Present",
    "ProcessFault",
    "Question",
    "RobotSent",
    "RunOver",
    "Seconds",
    "SkillCall",
    "Standing",
    "State",
    "Status",
    "Step",
    "StepResult",
    "Steps",
    "Text",
    "Tick",
    "Value",
    "Welcome",
]
