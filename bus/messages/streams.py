"""Streams: what everybody may watch."""

from __future__ import annotations

from typing import Literal

import msgspec

from bus.messages.basics import Body, Count, Name, Seconds, Steps, Text, Value
from bus.messages.sharing import Exchange


class Event(Body, frozen=True):
    """Something that happened, for the record. `kind` is one of `bus.events.KINDS`."""

    kind: Name
    data: dict[str, object] = {}


class Status(Body, frozen=True):
    """What a process is doing now, for people who watch; the latest value wins.

    `plan` is the team's adopted plan from global step `start`; `bound` and `best` are the coordinator's
    proven lower bound and best makespan so far (-1: none yet).

    Of teams that drive along ways and keep deadlines: `ways` by robot, each the whole way of its present action in
    metres in the frame of the room that it is in (watchers draw what is left of it); `helping` says in a few words
    what help is asked for, promised, given or under way, empty if none; `elapsed` and `deadline` in units of the
    domain's time since the run began (-1: not counted; 0: no deadline).
    """

    role: Literal["team", "coordinator", "world", "supervisor", "recorder"]
    doing: Text
    step: int = -1
    start: int = 0
    plan: Steps = ()
    bound: int = -1
    best: int = -1
    epoch: Count = 0
    questions: Count = 0
    finished: bool = False
    exchanges: tuple[Exchange, ...] = ()
    ways: dict[Name, tuple[tuple[float, float], ...]] = {}
    helping: Text = ""
    elapsed: int = -1
    deadline: Count = 0


class BodyFrame(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One body of the world as it truly is. `place` is a team's name, ``bench`` or ``gone``; `name` is what
    the team calls it; `id` is the name it was built with; `x_m`, `y_m` count from the place's own origin."""

    id: Name
    name: Name
    kind: Name
    place: Name
    x_m: float
    y_m: float
    heading_rad: float = 0.0
    attributes: dict[str, Value] = {}
    broken: bool = False
    coupled_to: str = ""
    doing: str = ""


class Frame(Body, frozen=True):
    """Ground truth, for recorder and dashboard alone."""

    at_s: Seconds
    step: int
    bodies: tuple[BodyFrame, ...]


class Beat(Body, frozen=True):
    """A sign of life from a process's main loop, with its counters since it started: mail sent, received and sent
    again, messages of any stream that were refused, events reported."""

    pid: Count
    sent: Count = 0
    received: Count = 0
    refused: Count = 0
    repeated: Count = 0
    events: Count = 0
    latency_ms: float = 0.0
    doing: str = ""
