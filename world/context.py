"""What the world says of steps, and the parts of the world that windows need: node, truth, disturbances, journal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from bus.messages import Envelope, Executed
from bus.node import Node
from world.disturbances import Disturbances
from world.faults import Faults
from world.frames import membership
from world.tasks import Task
from world.truth import Truth
from world.window import step_of


@dataclass(frozen=True)
class Context:
    """`save` journals the world, `show` publishes a frame."""

    node: Node
    truth: Truth
    faults: Faults
    disturbances: Disturbances
    save: Callable[[], None]
    show: Callable[[], None]

    def tell_begun(self, team: str, command: Envelope, tasks: list[Task]) -> None:
        """A team's step is under way."""
        step, texts = step_of(command), [task.text for task in tasks]
        text = f"{team} begins step {step}: {', '.join(texts) or 'nothing'}"
        self.node.emit("step_started", text, team=team, step=step, command=command.id, actions=texts)

    def tell_failed(self, task: Task, command: Envelope) -> None:
        """If an action had no effect, say so; of who tries again until it has, each reason once."""
        robot = task.robot
        if task.failed and task.again and robot is not None:
            if robot.waits != task.failed:
                robot.waits = task.failed
                step = step_of(command)
                self.node.emit("waits_at_door", task.failed, team=task.team, step=step, robot=robot.id)
        elif task.failed:
            text = f"{task.team}: {task.text} had no effect, {task.failed}"
            self.node.emit(
                "skill_failed", text, team=task.team, step=step_of(command), action=task.text, reason=task.failed
            )

    def tell_ended(self, command: Envelope, told: Executed) -> None:
        """A team's step is over: answer its command."""
        self.node.reply(command, told)
        text = f"{told.team} ends step {told.step}"
        self.node.emit("step_ended", text, team=told.team, step=told.step, command=command.id, state=told.state)

    def tell_membership(self, step: int) -> None:
        """Who is where."""
        self.node.emit("membership", f"who is where after step {step}", **membership(self.truth, step))
