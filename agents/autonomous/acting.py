"""An autonomous team does one thing after the other: it looks, thinks, carries out its plan step by step, goes on after
what stopped it, helps and is helped, takes a final look, and rests when there is nothing more to do.

What comes next follows from the memory alone, so a team that was killed goes on where it was.
"""

from __future__ import annotations

from typing import Any

from agents.autonomous import helping, recovering
from agents.autonomous.asking import Asking
from agents.autonomous.detours import Detours
from agents.autonomous.escort import Escort
from agents.autonomous.helpers import Helpers
from agents.autonomous.memory import Begun, Purpose
from agents.autonomous.mind import COORDINATOR, WORLD, Mind
from agents.autonomous.thinking import GUEST, Need, Thought
from agents.autonomous.ways import NoWay
from bus import messages as m
from bus.messages import Envelope
from reasoning.values import Value


class Acting:
    """At most one thing is under way: a look, a thought, or a step."""

    def __init__(self, mind: Mind) -> None:
        self.mind = mind
        self.helpers = Helpers(mind, self.go_on)
        self.escort = Escort(mind, self.helpers, self.execute)
        self.detours = Detours(mind, self.execute, self.go_on)
        self.asking = Asking(mind, self.helpers, self.go_on)
        self._looking = self._thinking = False

    def resume(self) -> None:
        """After a restart: a step that was begun is asked for again under the same id, so it happens once; so is what
        was to be told."""
        if self.mind.memory.begun is not None:
            self._send(self.mind.memory.begun)
        if self.mind.memory.rest is not None:
            self._report(self.mind.memory.rest)
        self.helpers.tell()

    # ------------------------------------------------------------ what comes next
    def go_on(self) -> None:
        """Do the next thing, unless something is under way or there is reason to wait."""
        mind, now = self.mind, self.mind.memory
        if now.begun is not None or self._looking or self._thinking or now.peers is None:
            return
        if now.until_s > mind.node.now_s + 1e-9:
            mind.node.wake_at(now.until_s)
        elif not now.looked:
            self._look()
        elif now.stopped:
            self.detours.drive_on()
        elif (now.course is None and self.detours.to_safety()) or self.escort.duty():
            pass
        elif now.left:
            self._step()
        elif now.need is not None and now.course is not None:
            self.asking.ask()
        elif now.course is not None and not now.resting:
            mind.emit("final_look", "has nothing more to do, and looks at the whole room again", step=now.step)
            mind.keep(course=None, looked=False)
            self.go_on()
        elif now.course is None:
            self._think()
        elif self.finished and not now.reported:
            self._rest()
        else:
            mind.keep(reported=now.reported and self.finished)
            mind.show("at rest")

    # ------------------------------------------------------------ looking and thinking
    def _look(self) -> None:
        self._looking = True
        self.mind.show("looking")
        self.mind.request(WORLD, m.Observe(self.mind.team), self._looked)

    def _looked(self, envelope: Envelope) -> None:
        self._looking = False
        if isinstance(envelope.body, m.Observed):
            before = self.mind.memory.state
            self.mind.keep(state=self.mind.see(envelope.body.state), looked=True)
            if not before:  # only now it knows which room is its own
                self.mind.furnish()
            self.escort.missed(before)
        self.go_on()

    def _think(self) -> None:
        """Make a plan from what is believed now."""
        mind, now = self.mind, self.mind.memory
        if not mind.words.robots(now.state):
            if now.help.engaged:
                mind.show("waiting for its robot")
            else:
                undone = mind.patiently(lambda: mind.thinking.misplaced(now.state, now.aside))
                self._thought(Thought(None, None, dict.fromkeys(undone, "no robot is left that works") | now.aside))
            return
        self._thinking = True
        mind.show("planning")
        helped, deadline = now.alone or now.help.phase == "here", now.deadline

        def think() -> Thought:
            mind.thinking.never = now.never
            if now.help.phase in ("coming", "underway") and not (now.need is not None and now.need.strong):
                doors = mind.words.doors(mind.static, now.state)[now.help.partner_room]
                arrival = mind.words.now(now.state) + now.help.arrival_units
                course = mind.thinking.with_helper(now.state, now.aside, doors[0], arrival)
                need = None if course is not None else Need(0, "before going on")
                return Thought(course, need, now.aside, now.late, "feasible", "with a robot that is on its way")
            return mind.thinking.consider(now.state, now.aside, helped=helped, late=now.late)

        def then(thought: Thought) -> None:
            if mind.memory.deadline == deadline and mind.memory.looked:
                self._thought(thought)
            else:  # it has thought of another deadline than it has by now, or of a room that has changed since
                self._thinking = False
                self.go_on()

        mind.think(think, then)

    def _thought(self, thought: Thought) -> None:
        self._thinking = False
        mind, now = self.mind, self.mind.memory
        course = thought.course or recovering.nothing(now.state)
        late = thought.late and mind.words.deadline(mind.static, now.state) > 0
        with mind.node.journal.transaction():
            for thing in sorted(set(thought.aside) - set(now.aside)):
                why = thought.aside[thing]
                mind.emit("set_aside", f"leaves {thing} as it is: {why}", thing=thing, reason=why)
            if late and not now.late:
                mind.emit("deadline_missed", "cannot meet its deadline, and does what it can", step=now.step)
            if course.steps:
                recovering.tell_plan(mind, thought, course)
            mind.keep(
                course=course,
                at=0,
                need=thought.need,
                aside=thought.aside,
                late=now.late or late,
                plans=now.plans + bool(course.steps),
            )
            if not course.steps and thought.need is None:
                mind.keep(resting=True)
                if now.help.phase == "coming":
                    self.helpers.take(helping.withdraw(now.help))
        self.helpers.attend()
        self.go_on()

    # ------------------------------------------------------------ steps
    def _step(self) -> None:
        """The next step of the plan."""
        mind, now = self.mind, self.mind.memory
        course, words = now.course, mind.words
        assert course is not None
        actions = course.steps[now.at]
        if any(f"({GUEST}" in action for action in actions):
            if now.help.phase == "underway":
                self.escort.let_in()
            elif now.help.phase == "coming":
                mind.show(f"waiting for the robot of {now.help.partner}")
            else:
                self.detours.replan("nobody comes to help")
            return
        units = words.now(course.states[now.at + 1]) - words.now(course.states[now.at])
        try:
            details = course.details.get(now.at, {})
            calls = mind.patiently(lambda: mind.ways.calls(now.state, actions, details, units))
        except NoWay as error:
            if not self.detours.make_way(error):
                self.detours.bar(error)
            return
        self.execute("plan", actions, calls, course.states[now.at + 1])

    def execute(
        self,
        purpose: Purpose,
        actions: tuple[str, ...],
        calls: tuple[m.SkillCall, ...],
        predicted: dict[str, Value] | None = None,
    ) -> None:
        """Have the world carry out a step."""
        entering = self.escort.entering() if purpose == "plan" else ()
        begun = Begun(self.mind.memory.step, purpose, actions, (*calls, *entering), predicted or {})
        self.mind.keep(begun=begun)
        self._send(begun)

    def _send(self, begun: Begun) -> None:
        """Ask the world; the id is the step's own, so that a repetition after a restart is the same command."""
        team = self.mind.team
        self.mind.show("executing" if begun.purpose == "plan" else recovering.DOING[begun.purpose])
        body = m.Execute(team, begun.step, begun.calls)
        self.mind.request(WORLD, body, self._executed, f"{team}.step.{begun.step}")

    def _executed(self, envelope: Envelope) -> None:
        body, begun = envelope.body, self.mind.memory.begun
        if not isinstance(body, m.Executed) or begun is None or body.step != begun.step:
            return
        mind, before = self.mind, self.mind.memory
        with mind.node.journal.transaction():
            mind.keep(step=begun.step + 1, begun=None, state=mind.see(body.state))
            self.escort.came_in()
            if begun.purpose != "leave":
                self.escort.missed(before.state)
            if begun.purpose == "plan":
                mind.keep(at=before.at + 1)
                recovering.after_step(mind, begun, before, body)
            elif begun.purpose in ("drive_on", "aside", "safe"):
                recovering.after_driving(mind, begun, before, body)
            else:
                self.escort.executed(begun, before.state, body.felt)
        self.helpers.catch_up()
        self.go_on()

    # ------------------------------------------------------------ rest
    def _rest(self) -> None:
        """Nothing more to do: tell the coordinator."""
        mind, now = self.mind, self.mind.memory
        number = now.rest.number + 1 if now.rest is not None else 1
        report = m.AtRest(number, now.step, now.plans, now.aside, now.late)
        mind.keep(rest=report, reported=True)
        left = f", but for {', '.join(sorted(now.aside))}" if now.aside else ""
        mind.emit("team_finished", f"is done{left} after {now.step} steps", step=now.step, untidy=sorted(now.aside))
        mind.node.journal.afterwards(lambda: self._report(report))

    def _report(self, report: m.AtRest) -> None:
        self.mind.request(COORDINATOR, report, lambda _: None, f"{self.mind.team}.rest.{report.number}")

    def ordered(self, order: m.Order) -> None:
        """Something has changed: a team at rest looks again, one with another deadline plans anew."""
        mind, now = self.mind, self.mind.memory
        again: dict[str, Any] = {"resting": False, "reported": False, "course": None, "stopped": {}, "looked": False}
        if order.deadline is not None and order.deadline != now.deadline:
            mind.keep(**again, deadline=order.deadline, late=False, alone=False, offered=False)
            mind.furnish()
            until = f"it has until {order.deadline} units" if order.deadline else "it has no deadline any more"
            mind.emit("plan_dropped", f"plans anew: {until}", step=now.step, reason=until)
        elif now.resting:
            mind.keep(**again)

    @property
    def finished(self) -> bool:
        """Is there nothing to do, and nobody in contact to wait for?"""
        now = self.mind.memory
        untold = [to for to, _, _ in now.help.off if to in (now.peers or ())]
        return now.resting and now.help.phase in ("none", "refused") and not untold
