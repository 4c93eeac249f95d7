"""On from where robots have stopped: by another way, to a safe cell, or by another plan."""

from __future__ import annotations

from collections.abc import Callable

from agents.autonomous import recovering
from agents.autonomous.escort import Execute
from agents.autonomous.mind import Mind
from agents.autonomous.ways import NoWay


class Detours:
    """`go_on` is called when there is something else to do instead."""

    def __init__(self, mind: Mind, execute: Execute, go_on: Callable[[], None]) -> None:
        self.mind, self._execute, self._go_on = mind, execute, go_on

    def drive_on(self) -> None:
        """Robots that stopped go on from where they stand, by other ways: to the next state of the plan."""
        mind, now = self.mind, self.mind.memory
        try:
            if now.held >= recovering.HELD_UP_TIMES:
                raise NoWay(*min(now.stopped.items()))
            calls = tuple(
                mind.ways.driving(now.state, robot, now.stopped, recovering.people(mind.words, now.state))
                for robot in sorted(now.stopped)
            )
        except NoWay as error:
            if mind.words.persons(now.state) and now.waited < recovering.PATIENCE_UNITS:
                mind.keep(waited=now.waited + 1)
                mind.wait(1)
                self._go_on()
            else:
                self.bar(error)
            return
        for robot in sorted(now.stopped):
            x, y = now.stopped[robot]
            mind.emit("new_way", f"sends {robot} on to ({x},{y}) by another way", robot=robot, step=now.step)
        self._execute("drive_on", tuple(recovering.term(c) for c in calls), calls)

    def to_safety(self) -> None:
        """Robots between cells go to the middle of one: only from there can be planned."""
        mind, now = self.mind, self.mind.memory
        goals = recovering.safe_cells(mind, now.state)
        calls = tuple(mind.ways.driving(now.state, robot, goals, ()) for robot in sorted(goals))
        for robot in sorted(goals):
            x, y = goals[robot]
            mind.emit("safe_state", f"has {robot} go to ({x},{y}), where it is safe", robot=robot, step=now.step)
        self._execute("safe", tuple(recovering.term(c) for c in calls), calls)

    def bar(self, error: NoWay) -> None:
        """A way of the plan is impossible: plan without it. After too many of them, leave what is left to do."""
        mind, now = self.mind, self.mind.memory
        at = mind.words.cell(now.state, error.robot) or error.goal
        barred = f"({error.robot},{recovering.written(at)},{recovering.written(error.goal)})"
        left = mind.words.things(now.state) if len(now.never) >= recovering.MOST_BARRED else []
        why = {thing: str(error) for thing in left}
        mind.keep(never=(*now.never, barred), aside={**why, **now.aside})
        self.replan(str(error))

    def replan(self, why: str) -> None:
        self.mind.emit("plan_dropped", f"plans anew: {why}", step=self.mind.memory.step, reason=why)
        self.mind.keep(course=None, stopped={}, waited=0, held=0, looked=False)
        self._go_on()
