"""What a team must not forget, as one value: journalled before anything that follows from it is said or done."""

from __future__ import annotations

from typing import Literal

import msgspec

from bus.journal import Journal
from bus.messages import Diagnosis, Hand, Handover, Question, State, StepResult, Steps, Value

_KEY = "memory"


class Course(msgspec.Struct, frozen=True):
    """The plan that a team follows from global step `start` on. Its own steps count from 0.

    `states[i]` is predicted before step i. `details[i]` holds, by action, what the written action leaves out. `gave`
    and `took` are the robots that it gives and takes, sorted. `refuted` are the questions that were answered no where
    this plan starts.
    """

    start: int
    steps: Steps
    states: tuple[State, ...]
    details: dict[int, dict[str, dict[str, Value]]] = {}
    role: Literal["alone", "lend", "borrow", "share"] = "alone"
    gave: tuple[Hand, ...] = ()
    took: tuple[Hand, ...] = ()
    refuted: tuple[Question, ...] = ()

    @property
    def makespan(self) -> int:
        return len(self.steps)


class Begun(msgspec.Struct, frozen=True):
    """A step that the world has been asked to execute and has not reported yet."""

    step: int
    actions: tuple[str, ...]
    recover: bool = False


class Memory(msgspec.Struct, frozen=True):
    """One team at one moment.

    `step` is the global step that comes next; `observed` the latest sensed state (empty: never looked); `broken` the
    robots known to be broken; `guests` the built names of robots that were borrowed, by the team's own name for them;
    `gave` and `took` all exchanges so far; `since` and `history` the state at the epoch's start and the steps
    executed since, which is what a diagnosis looks at; `open` the explanations that still wait for an inspection;
    `last` the latest report, to be given again when asked again.
    """

    step: int = 0
    epoch: int = 0
    observed: State = {}
    broken: tuple[str, ...] = ()
    guests: dict[str, str] = {}
    gave: tuple[Handover, ...] = ()
    took: tuple[Handover, ...] = ()
    course: Course | None = None
    on_course: bool = False
    begun: Begun | None = None
    since: State = {}
    history: Steps = ()
    open: tuple[Diagnosis, ...] = ()
    last: StepResult | None = None


def load(journal: Journal) -> Memory:
    """The memory as of the last completed write; a fresh one if there is none."""
    kept = journal.get(_KEY)
    return Memory() if kept is None else msgspec.msgpack.decode(kept, type=Memory)


def save(journal: Journal, memory: Memory) -> None:
    journal.put(_KEY, msgspec.msgpack.encode(memory))
