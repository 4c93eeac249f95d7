"""On from where robots have stopped: by another way, past a robot that steps aside, to a safe cell, or by
another plan."""

from __future__ import annotations

from collections.abc import Callable
from math import dist

from agents.autonomous import recovering
from agents.autonomous.escort import Execute
from agents.autonomous.mind import Mind
from agents.autonomous.ways import NoWay
from reasoning.geometry import Cell


class Detours:
    """`go_on` is called when there is something else to do instead."""

    def __init__(self, mind: Mind, execute: Execute, go_on: Callable[[], None]) -> None:
        self.mind, self._execute, self._go_on = mind, execute, go_on

    def drive_on(self) -> None:
        """Robots that stopped go on from where they stand, by other ways: to the next state of the plan."""
        mind, now = self.mind, self.mind.memory
        try:
            if now.held >= recovering.HELD_UP_TIMES:
                raise NoWay(min(now.stopped), now.stopped)
            going = self._going()
            people = recovering.people(mind.words, now.state)
            calls = tuple(mind.ways.driving(now.state, robot, going, people) for robot in sorted(going))
        except NoWay as error:
            if self.make_way(error):
                return
            if mind.words.persons(now.state) and now.waited < recovering.PATIENCE_UNITS:
                if now.waited == recovering.FACING_UNITS and self.give_way(error.robot):
                    return
                mind.keep(waited=now.waited + 1)
                mind.wait(1)
                self._go_on()
            else:
                self.bar(error)
            return
        for robot in sorted(going):
            x, y = going[robot]
            mind.emit("new_way", f"sends {robot} on to ({x},{y}) by another way", robot=robot, step=now.step)
        self._execute("drive_on", tuple(recovering.term(c) for c in calls), calls)

    def _going(self) -> dict[str, Cell]:
        """Who goes on now, and where to: all, or after somebody was held up, one after the other, round the rest."""
        now, words = self.mind.memory, self.mind.words
        if not now.held:
            return now.stopped
        first = sorted(now.stopped)[now.held % len(now.stopped)]
        held = words.held(now.state, first)
        with_it = set(words.holders(now.state, held[0]).values()) if held is not None else set()
        return {robot: goal for robot, goal in now.stopped.items() if robot in {first, *with_it}}

    def make_way(self, error: NoWay) -> bool:
        """A robot that stands in another one's way steps aside; then those that have stopped, or were about to go, go
        on, and all is planned anew. False if none can, or they did so too often."""
        mind, now = self.mind, self.mind.memory
        people = recovering.people(mind.words, now.state)
        for blocker in error.behind if now.asides < recovering.MOST_ASIDE else ():
            at = mind.ways.aside(now.state, blocker, error, people)
            if at is None:
                continue
            call = mind.ways.driving(now.state, blocker, {blocker: at}, people)
            mind.keep(course=None, need=None, stopped=now.stopped or error.goals, asides=now.asides + 1)
            text = f"has {blocker} step aside to ({at[0]},{at[1]}): {error}"
            mind.emit("made_way", text, step=now.step, robot=blocker, reason=str(error))
            self._execute("aside", (recovering.term(call),), (call,))
            return True
        return False

    def give_way(self, robot: str) -> bool:
        """A robot steps off the line on which the nearest person comes, and waits until that one may have gone by; then
        all is planned anew. False if it cannot, or robots did so too often."""
        mind, now = self.mind, self.mind.memory
        people, here = recovering.people(mind.words, now.state), mind.words.point(now.state, robot)
        person = min(((x, y) for x, y, _ in people), key=lambda at: dist(at, here))
        at = mind.ways.passing(now.state, robot, person, people)
        if at is None or now.asides >= recovering.MOST_GIVEN_WAY:
            return False
        call = mind.ways.driving(now.state, robot, {robot: at}, people)
        mind.keep(course=None, need=None, asides=now.asides + 1)
        mind.wait(recovering.PASSING_UNITS)
        text, reason = f"has {robot} step aside to ({at[0]},{at[1]})", "a person may be waiting for it to go"
        mind.emit("made_way", f"{text}: {reason}", step=now.step, robot=robot, reason=reason)
        self._execute("aside", (recovering.term(call),), (call,))
        return True

    def to_safety(self) -> bool:
        """Robots between cells go to the middle of one, from where can be planned. Those that have no way to any stay
        where they are, which is said once, and are planned for as if they stood in the middle; False if there are no
        others."""
        mind, now = self.mind, self.mind.memory
        off = [robot for robot in mind.words.robots(now.state) if mind.words.between_cells(now.state, robot)]
        goals, stuck = self._safe_cells(off) if now.held < recovering.HELD_UP_TIMES else ({}, tuple(off))
        for robot in sorted({*stuck} - {*now.stuck}):
            text = f"has {robot} stay where it is, since it does not get to any cell"
            mind.emit("stays", text, step=now.step, robot=robot)
        if now.stuck != stuck:
            mind.keep(stuck=stuck)
        if not goals:
            return False
        people = recovering.people(mind.words, now.state)
        calls = tuple(mind.ways.driving(now.state, robot, goals, people) for robot in sorted(goals))
        for robot in sorted(goals):
            x, y = goals[robot]
            mind.emit("safe_state", f"has {robot} go to ({x},{y}), where it is safe", robot=robot, step=now.step)
        self._execute("safe", tuple(recovering.term(c) for c in calls), calls)
        return True

    def _safe_cells(self, off: list[str]) -> tuple[dict[str, Cell], tuple[str, ...]]:
        """For each robot between cells, `off`, the nearest cell whose middle it can get to and where nobody is; and
        those that have none. Robots that carry one thing go together."""
        mind, state = self.mind, self.mind.memory.state
        words = mind.words
        taken = {words.cell(state, robot) for robot in words.robots(state) if robot not in off}
        people = recovering.people(words, state)
        goals: dict[str, Cell] = {}
        stuck: list[str] = []
        for robot in off:
            if robot in goals or robot in stuck:
                continue
            held = words.held(state, robot)
            partner = words.holders(state, held[0]).get(3 - held[1]) if held is not None else None
            if partner is None:
                at = mind.ways.nearest_cell(state, robot, {*taken, *goals.values()}, people)
                found = {robot: at} if at is not None else {}
            else:
                found = mind.ways.nearest_cells(state, robot, partner, {*taken, *goals.values()}, people)
            goals |= found
            stuck += [] if found else [robot, *([partner] if partner is not None else [])]
        return goals, tuple(stuck)

    def bar(self, error: NoWay) -> None:
        """A way of the plan is impossible: plan without it. After too many of them, leave what is left to do."""
        mind, now = self.mind, self.mind.memory
        goal = error.goals[error.robot]
        at = mind.words.cell(now.state, error.robot) or goal
        barred = f"({error.robot},{recovering.written(at)},{recovering.written(goal)})"
        left = mind.words.things(now.state) if len(now.never) >= recovering.MOST_BARRED else []
        why = {thing: str(error) for thing in left}
        mind.keep(never=(*now.never, barred), aside={**why, **now.aside})
        self.replan(str(error))

    def replan(self, why: str) -> None:
        self.mind.emit("plan_dropped", f"plans anew: {why}", step=self.mind.memory.step, reason=why)
        self.mind.keep(course=None, stopped={}, waited=0, held=0, looked=False)
        self._go_on()
