"""A window: one period in which the steps of one or more teams are carried out together."""

from __future__ import annotations

from bus.messages import Envelope, Execute, SkillCall
from bus.scene import Action
from world import moving, stores
from world.motion import Motion
from world.skills import SKILLS
from world.tasks import Board, Task, written
from world.truth import Truth

UNKNOWN = Action("inspect")


class Window:
    """Opened with the first command; others may join until it begins. `opened` is the tick at which it was."""

    def __init__(self, opened: int) -> None:
        self.opened = opened
        self.begun = False
        self.commands: dict[str, Envelope] = {}
        self.tasks: list[Task] = []
        self.of: dict[str, list[Task]] = {}

    @property
    def step(self) -> int:
        """The global step that is executed."""
        return max(step_of(command) for command in self.commands.values())

    def prepare(self, truth: Truth) -> None:
        """Read the commands; what cannot be understood is a task that has failed already."""
        order = [w.team for w in truth.scene.workspaces]
        self.commands = dict(sorted(self.commands.items(), key=lambda item: order.index(item[0])))
        board = Board()
        for team, command in self.commands.items():
            self.of[team] = [_task(truth, board, team, call) for call in calls_of(command)]
        self.tasks = [task for tasks in self.of.values() for task in tasks]

    def begin(self, truth: Truth, motion: Motion) -> None:
        """Decide what is possible, and set it going."""
        self.begun = True
        truth.fade()
        for task in sorted(self.tasks, key=lambda task: SKILLS[task.action.skill].rank):
            task.failed = task.failed or SKILLS[task.action.skill].begin(truth, task) or stores.lacks(task)
            if not task.failed:
                task.board.enter(task)
        moving.look(truth, self.tasks)
        moving.launch(truth, motion, self.tasks)

    def end(self, truth: Truth) -> None:
        """The period is over: movements first, for what others need, then everything else."""
        truth.fade()
        truth.step = max(truth.step, self.step)
        for moved in (True, False):
            for task in self.tasks:
                if not task.failed and (task.action.skill in moving.SKILLS) is moved:
                    task.failed = SKILLS[task.action.skill].end(truth, task)
                    if not task.failed:
                        stores.drain(task)

    def doing(self) -> dict[str, str]:
        """What each robot is at, by its id."""
        return {t.robot.id: t.text for t in self.tasks if t.robot is not None and t.begun and not t.failed}

    def findings(self, team: str) -> dict[str, str]:
        """What the inspections of a team found, by the robot's name."""
        return {str(task.arg("robot")): task.finding for task in self.of[team] if task.finding and not task.failed}


def step_of(command: Envelope) -> int:
    assert isinstance(command.body, Execute)
    return command.body.step


def calls_of(command: Envelope) -> tuple[SkillCall, ...]:
    assert isinstance(command.body, Execute)
    return command.body.calls


def _task(truth: Truth, board: Board, team: str, call: SkillCall) -> Task:
    action, failed = truth.scene.actions.get(call.name), ""
    if action is None:
        action, failed = UNKNOWN, "there is no such action"
    elif len(call.args) != len(action.args):
        failed = f"it takes {len(action.args)} arguments"
    return Task(team, call, action, written(call), board, failed=failed)
