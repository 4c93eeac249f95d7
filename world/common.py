"""Windows that the teams share: their steps are carried out together, in one period.

A window opens with the first `Execute` and lasts one period; in its first tenth, while nothing moves, other teams may
still join. At its end every team in it gets what its sensors show, and the state of the world is journalled with these
replies in one transaction. So after a crash either a step is over for everybody, or it never was and is executed again.
"""

from __future__ import annotations

from bus.messages import Envelope, Executed, Status
from world.context import Context
from world.motion import Motion
from world.own import SavedWindows
from world.sensors import sense
from world.things import BENCH
from world.window import Window, step_of

JOINING = 0.1
"""The share of a period in which a window waits for the other teams before it begins."""


class Common:
    """Implements `world.simulation.Windows`."""

    def __init__(self, context: Context) -> None:
        self._context, self._truth = context, context.truth
        self._motion = Motion(context.truth)
        for thing in context.truth.things.values():
            self._motion.travel(thing)
        self._window: Window | None = None
        self._commands: list[Envelope] = []
        self.doing: dict[str, str] = {}

    # ------------------------------------------------------------ what the world wants to know
    @property
    def idle(self) -> bool:
        return self._window is None

    @property
    def between(self) -> bool:
        return self._window is None or not self._window.begun

    @property
    def moving(self) -> bool:
        return not self.between or any(self._truth.travels(thing) for thing in self._truth.of(BENCH))

    def busy(self, team: str) -> bool:
        return self._window is not None and team in self._window.commands

    def next_tick(self) -> int | None:
        return None if self._window is None else self._window_tick(self._window)

    def control_tick(self) -> int | None:
        return self._motion.next_tick()

    # ------------------------------------------------------------ what happens
    def take(self, command: Envelope) -> None:
        self._commands.append(command)

    def control(self) -> None:
        self._motion.run(self._truth.tick)

    def close(self) -> None:
        window = self._window
        if window is not None and window.begun and self._truth.tick >= self._window_tick(window):
            self._end(window)

    def open(self) -> None:
        self._gather()
        window = self._window
        if window is not None and not window.begun and self._truth.tick >= self._window_tick(window):
            self._begin(window)

    def saved(self) -> SavedWindows:
        return SavedWindows()

    def _window_tick(self, window: Window) -> int:
        """When the window begins, and then when it ends."""
        if window.begun:
            return window.opened + self._truth.period
        everybody = len(window.commands) == len(self._truth.layout.spaces)
        return window.opened + (0 if everybody else round(JOINING * self._truth.period))

    def _gather(self) -> None:
        """Let commands into the window, opening one if need be."""
        if self._commands and self._window is None:
            self._window = Window(self._truth.tick)
        if self._window is None or self._window.begun:
            return
        left: list[Envelope] = []
        for command in self._commands:
            if self._window.commands.setdefault(command.src, command) is not command:
                left.append(command)
        self._commands = left

    def _begin(self, window: Window) -> None:
        context = self._context
        window.prepare(self._truth)
        actions = {f"{task.team}.{task.text}" for task in window.tasks}
        context.disturbances.of_script([*context.faults.at_step(window.step, actions)])
        window.begin(self._truth, self._motion)
        self.doing = window.doing()
        with context.node.journal.transaction():
            for team, command in window.commands.items():
                context.tell_begun(team, command, window.of[team])
        context.node.status(Status("world", f"step {window.step}", step=window.step))

    def _end(self, window: Window) -> None:
        context, truth = self._context, self._truth
        with context.node.journal.transaction():
            window.end(truth)
            for task in window.tasks:
                context.tell_failed(task, window.commands[task.team])
            for team, command in window.commands.items():
                step, state = step_of(command), sense(truth, team)
                context.tell_ended(command, Executed(team, step, state, window.findings(team)))  # type: ignore[arg-type]
            self._window, self.doing = None, {}
            context.tell_membership(truth.step)
            context.save()
        context.show()
