"""What a team that acts for itself must not forget, as one value: journalled before anything that follows from it is
said or done."""

from __future__ import annotations

from typing import Literal

import msgspec

from agents.autonomous.helping import Help
from agents.autonomous.thinking import Course, Need
from bus.journal import Journal
from bus.messages import AtRest, SkillCall, Value

_KEY = "memory"
Purpose = Literal["plan", "drive_on", "aside", "safe", "door", "leave", "enter", "home", "recall"]
"""Why the world was asked to do something: a step of the plan; to go on after a stop; to let another robot by; to stand
in the middle of a cell; and what help takes."""


class Begun(msgspec.Struct, frozen=True):
    """A step that the world has been asked to carry out and has not reported yet."""

    step: int
    purpose: Purpose
    actions: tuple[str, ...]
    calls: tuple[SkillCall, ...]
    predicted: dict[str, Value] = {}


class Memory(msgspec.Struct, frozen=True):
    """One team at one moment.

    `step` is the number of the step that comes next, `plans` how many plans there were; `state` is what is believed,
    `looked` whether the team has looked since it had reason to; `course` the plan, of which step `at` comes next, and
    `need` the help that is needed after it. `aside` says for each thing that is left as it is why; `late`: the deadline
    does not count any more, `deadline` is another one than it was set up with (negative: it is not), `alone`: nobody
    can help. `stopped` tells where robots were to go that stopped on their way, `waited` for how many units they have
    waited for people, `held` how often they were held up; `asides` is how often robots stepped aside for one another or
    for people, `stuck` are robots between cells that have no way to any; `never` are ways that were found impossible,
    `broken` tells where robots stand that are done without. Nothing is done before `until_s`. `peers` are the other
    teams in contact (None: the coordinator has not said so yet) as of its message number `told`, `known` all that may
    be; `stood` is the cell where the robot stood that helps elsewhere, `silent_s` since when the partner in help under
    way has been out of contact (negative: it is not), `recalls` how often the robot was called home, `gone` are guests
    that their own teams have called home; `offered`: help was offered since it was last asked for. `resting`: there is
    nothing more to do here; `rest` is the latest report of that, `reported` whether it still holds."""

    step: int = 0
    plans: int = 0
    state: dict[str, Value] = {}
    looked: bool = False
    course: Course | None = None
    at: int = 0
    begun: Begun | None = None
    need: Need | None = None
    aside: dict[str, str] = {}
    late: bool = False
    deadline: int = -1
    alone: bool = False
    stopped: dict[str, tuple[int, int]] = {}
    waited: int = 0
    held: int = 0
    asides: int = 0
    stuck: tuple[str, ...] = ()
    broken: dict[str, tuple[float, float]] = {}
    until_s: float = 0.0
    help: Help = Help()
    never: tuple[str, ...] = ()
    peers: tuple[str, ...] | None = None
    known: tuple[str, ...] = ()
    told: int = -1
    stood: str = ""
    silent_s: float = -1.0
    recalls: int = 0
    gone: tuple[str, ...] = ()
    offered: bool = False
    rest: AtRest | None = None
    resting: bool = False
    reported: bool = False

    @property
    def left(self) -> int:
        """How many steps of the plan are left."""
        return 0 if self.course is None else len(self.course.steps) - self.at


def load(journal: Journal) -> Memory:
    """The memory as of the last completed write; a fresh one if there is none."""
    kept = journal.get(_KEY)
    return Memory() if kept is None else msgspec.msgpack.decode(kept, type=Memory)


def save(journal: Journal, memory: Memory) -> None:
    journal.put(_KEY, msgspec.msgpack.encode(memory))
