"""Windows of their own: every team's step is carried out by itself, whatever the others do.

A window begins with the team's `Execute` and ends when all that it asks for has ended, which is noticed from time to
time; an `Execute` without calls lasts a period. The end is journalled with its answer, and so is everybody else's step
as far as it has come: after a crash steps are over, under way as they were then, or never were.
"""

from __future__ import annotations

import msgspec

from bus.messages import Envelope, Executed, Status
from world import following, stores
from world.context import Context
from world.driving import Driver, Trip
from world.persons import Persons
from world.sensors import sense
from world.skills import SKILLS
from world.tasks import Felt, Task
from world.window import Window, step_of

NOTICES = 15
"""So many times a period it is noticed that a step has ended, besides at its end."""


class Done(msgspec.Struct):
    """How far a call has come; `trip` is the number of its drive, or -1; `again` as of a `world.tasks.Task`."""

    failed: str
    felt: Felt | None
    trip: int
    again: bool


class Saved(msgspec.Struct):
    """A step under way."""

    command: Envelope
    begun: int
    calls: list[Done]


class SavedWindows(msgspec.Struct):
    """All steps and drives that are under way."""

    windows: list[Saved] = []
    trips: list[Trip] = []


class Own:
    """Implements `world.simulation.Windows`."""

    def __init__(self, context: Context, saved: SavedWindows) -> None:
        self._context, self._truth = context, context.truth
        self._driver, self._persons = Driver(context.truth), Persons(context.truth)
        self._windows: dict[str, Window] = {}
        self._commands: list[Envelope] = []
        self._controlled = -1
        self._notice = max(context.truth.period // NOTICES, 1)
        self.doing: dict[str, str] = {}
        self._driver.take_up(saved.trips)
        for window in saved.windows:
            self._resume(window)

    # ------------------------------------------------------------ what the world wants to know
    @property
    def idle(self) -> bool:
        return True

    @property
    def between(self) -> bool:
        return True

    @property
    def moving(self) -> bool:
        return bool(self._windows) or self._persons.next_tick() == self._truth.tick + 1

    def busy(self, team: str) -> bool:
        return team in self._windows

    def next_tick(self) -> int | None:
        now, every = self._truth.tick, (self._notice, self._truth.period)
        rests = [n - (now - window.opened) % n for window in self._windows.values() for n in every]
        return now + min(rests) if rests else None

    def control_tick(self) -> int | None:
        driving = any(not trip.outcome for trip in self._driver.trips)
        return self._truth.tick + 1 if driving else self._persons.next_tick()

    # ------------------------------------------------------------ what happens
    def take(self, command: Envelope) -> None:
        # A step that was under way when the world died goes on: it is not asked for a second time.
        if not any(command.id == other.id for window in self._windows.values() for other in window.commands.values()):
            self._commands.append(command)

    def control(self) -> None:
        if self._controlled < self._truth.tick:
            self._controlled = self._truth.tick
            self._persons.control()
            self._driver.walking = self._persons.walking
            self._driver.control()

    def close(self) -> None:
        for window in [*self._windows.values()]:
            passed = self._truth.tick - window.opened
            noticed = passed % self._notice == 0 or passed % self._truth.period == 0
            if passed and noticed and self._over(window, passed):
                self._end(window)

    def open(self) -> None:
        commands, self._commands = self._commands, []
        for command in commands:
            if command.src in self._windows:
                self._commands.append(command)
            else:
                self._begin(command)

    def saved(self) -> SavedWindows:
        """For the journal."""
        trips, windows = self._driver.trips, []
        for team, window in self._windows.items():
            calls = [
                Done(t.failed, t.felt, -1 if t.trip is None else trips.index(t.trip), t.again) for t in window.of[team]
            ]
            windows.append(Saved(window.commands[team], window.opened, calls))
        return SavedWindows(windows, trips)

    # ------------------------------------------------------------ one step
    def _begin(self, command: Envelope) -> None:
        context, team, window = self._context, command.src, self._prepared(command, self._truth.tick)
        actions = {f"{team}.{task.text}" for task in window.tasks}
        context.disturbances.of_script([*context.faults.at_step(step_of(command), actions, team)])
        self._try(window.tasks)
        following.set_out(self._truth, self._driver, window.tasks)
        self._tell_begun(team, window)
        context.node.status(Status("world", f"at work for {', '.join(sorted(self._windows))}", step=self._truth.step))

    def _resume(self, saved: Saved) -> None:
        """What takes a period begins again, drives go on."""
        window = self._prepared(saved.command, saved.begun)
        for task, done in zip(window.tasks, saved.calls, strict=True):
            task.failed, task.felt, task.again = done.failed, done.felt, done.again
            task.trip = None if done.trip < 0 else self._driver.trips[done.trip]
        self._try(window.tasks)
        self._tell_begun(saved.command.src, window)

    def _prepared(self, command: Envelope, begun: int) -> Window:
        window = Window(begun)
        window.commands = {command.src: command}
        window.prepare(self._truth)
        return window

    def _try(self, tasks: list[Task]) -> None:
        """What is possible of what has not been tried yet?"""
        for task in sorted(tasks, key=lambda task: SKILLS[task.action.skill].rank):
            if task.trip is not None or task.again:
                own = self._truth.find(task.team, str(task.arg("robot")))
                task.robot = own or self._truth.things.get(str(task.call.detail.get("robot")))
            elif not task.failed:
                task.failed = SKILLS[task.action.skill].begin(self._truth, task) or stores.lacks(task)
                task.failed = task.failed or self._elsewhere(task)
            if not task.failed:
                task.board.enter(task)

    def _elsewhere(self, task: Task) -> str:
        """What a robot still does for another team, or nothing."""
        for window in self._windows.values():
            for other in window.tasks:
                if other.team != task.team and other.robot is task.robot is not None and not other.failed:
                    task.again = True
                    return f"{task.robot.id} waits until {other.text} of {other.team} is over"
        return ""

    def _tell_begun(self, team: str, window: Window) -> None:
        self._windows[team] = window
        self.doing |= window.doing()
        with self._context.node.journal.transaction():
            self._context.tell_begun(team, window.commands[team], window.tasks)

    def _over(self, window: Window, passed: int) -> bool:
        """Has all of it ended? What was impossible from the start takes a period, too."""
        period = self._truth.period
        drives = [task.trip for task in window.tasks if task.trip is not None]
        timed = len(drives) < len(window.tasks) or not window.tasks
        return (not timed or passed >= period) and all(
            trip.outcome and (trip.outcome not in ("there", "stopped") or passed >= trip.ticks) for trip in drives
        )

    def _end(self, window: Window) -> None:
        context, truth = self._context, self._truth
        ((team, command),) = window.commands.items()
        step = step_of(command)
        with context.node.journal.transaction():
            for task in sorted(window.tasks, key=lambda task: SKILLS[task.action.skill].rank):
                task.failed = task.failed or SKILLS[task.action.skill].end(truth, task)
                if not task.failed:
                    stores.drain(task)
                    self._count(task)
                context.tell_failed(task, command)
            own = [task.trip for task in window.tasks if task.trip is not None]
            for trip in [trip for trip in self._driver.trips if any(trip is other for other in own)]:
                self._driver.end(trip)
            del self._windows[team]
            self.doing = {robot: text for other in self._windows.values() for robot, text in other.doing().items()}
            truth.step = max(truth.step, step)
            felt = {str(task.arg("robot")): task.felt for task in window.tasks if task.felt is not None}
            findings = window.findings(team)
            context.tell_ended(command, Executed(team, step, sense(truth, team), findings, felt))  # type: ignore[arg-type]
            context.tell_membership(step)
            context.save()
        context.show()

    def _count(self, task: Task) -> None:
        fluents, name = self._truth.fluents[task.team], task.action.counts
        if isinstance(number := fluents.get(name), int):
            fluents[name] = number + 1
