"""One action under way, and what all skills ask of its robot."""

from __future__ import annotations

from dataclasses import dataclass, field
from re import fullmatch
from typing import Literal

from bus.messages import SkillCall, Value
from bus.scene import Action
from world.driving import Trip
from world.physics import Point
from world.things import WORD, Thing
from world.truth import Truth

Cell = tuple[int, int]
Felt = Literal["blocked", "too_heavy", "nothing_there"]


def written(call: SkillCall) -> str:
    """The call as a term: ``go(r1,right)``, ``shift``."""
    return f"{call.name}({','.join(map(str, call.args))})" if call.args else call.name


@dataclass(slots=True)
class Task:
    """A call of a team's step. `begun`: it was possible so far; `failed` says why nothing came of it, `felt` what the
    robot noticed of that.

    `goal` is the cell that `bodies` are to get to, `leaves` that they go away; `way`, its `units` of time and `trip`
    are of a robot that follows a way; `again`: nothing has come of it yet, and who asked will ask again; `board` is
    shared by all of a window.
    """

    team: str
    call: SkillCall
    action: Action
    text: str
    board: Board = field(repr=False)
    begun: bool = False
    failed: str = ""
    robot: Thing | None = None
    other: Thing | None = None
    goal: Cell | None = None
    bodies: tuple[Thing, ...] = ()
    leaves: bool = False
    finding: str = ""
    felt: Felt | None = None
    again: bool = False
    way: list[Point] = field(default_factory=list)
    units: int = 0
    trip: Trip | None = None

    def arg(self, role: str) -> Value | None:
        """The argument that plays this role."""
        roles = self.action.args
        return self.call.args[roles.index(role)] if role in roles else None

    def whole(self, role: str) -> int | None:
        """The same, if it is a whole number."""
        value = self.arg(role)
        return value if isinstance(value, int) else None


@dataclass
class Board:
    """Who does what in a window: tasks that have begun, by the id of their robot, by the object worked on, by the team
    whose line they hold or move, and by the name that a robot will have in its new team."""

    busy: dict[str, Task] = field(default_factory=dict)
    worked: dict[str, Task] = field(default_factory=dict)
    lines: dict[str, Task] = field(default_factory=dict)
    coming: dict[tuple[str, str], Task] = field(default_factory=dict)

    def enter(self, task: Task) -> None:
        """A task has begun."""
        task.begun = True
        skill = task.action.skill
        # Who is only looked at can do something else meanwhile.
        if task.robot is not None and skill != "inspect":
            self.busy[task.robot.id] = task
        if skill == "operate" and task.other is not None:
            self.worked[task.other.id] = task
        if skill in ("operate", "convey"):
            self.lines.setdefault(task.team, task)
        if skill == "arrive":
            self.coming[task.team, str(task.arg("robot"))] = task


def present(truth: Truth, task: Task) -> str:
    """Its robot is there, and has nothing else to do."""
    name = str(task.arg("robot"))
    thing = truth.find(task.team, name)
    if thing is None or truth.kind(thing).role != "robot":
        return f"there is no robot {name}"
    if thing.called:
        return f"{name} is called home by its own team"
    task.robot = thing
    other = task.board.busy.get(thing.id)
    return f"{name} is busy with {other.text}" if other is not None else ""


def able(truth: Truth, task: Task) -> str:
    """Its robot is there, free and in working order."""
    reason = present(truth, task)
    return reason or (f"{task.robot.name} is broken" if task.robot is not None and task.robot.broken else "")


def ill_named(truth: Truth, team: str, name: str) -> str:
    """Why a robot cannot come to a team under this name, or empty."""
    if not fullmatch(WORD, name):
        return f"a robot cannot be called {name[:64]}"
    return f"there is a {name} already" if truth.find(team, name) is not None else ""
