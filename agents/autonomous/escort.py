"""Robots on their way between rooms: out by the door, in by the door, and back to where they stood."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from agents.autonomous import helping, recovering
from agents.autonomous.beliefs import of_body
from agents.autonomous.helpers import Helpers
from agents.autonomous.memory import Begun, Purpose
from agents.autonomous.mind import Mind
from agents.autonomous.ways import NoWay
from bus.messages import SkillCall, State
from reasoning.geometry import Cell, cell
from reasoning.solver import parse

Execute = Callable[[Purpose, tuple[str, ...], tuple[SkillCall, ...]], None]


class Escort:
    """What help makes a team do besides its plan."""

    def __init__(self, mind: Mind, helpers: Helpers, execute: Execute) -> None:
        self.mind, self.helpers, self._execute = mind, helpers, execute

    # ------------------------------------------------------------ what is to be done
    def duty(self) -> bool:
        """Do what help asks for now; False if that is nothing, and the plan goes on."""
        now = self.mind.memory
        match now.help.phase:
            case "called" | "here" if self._is_missing():
                self.helpers.take(helping.withdraw(now.help))
                return False
            case "called":
                robot = now.help.name or self._choose()
                if self.mind.words.held(now.state, robot) is None:
                    self._send_out(robot)
                elif now.left:
                    return False  # first it brings what it holds to where it is to be
                else:
                    free = self.mind.words.free
                    self._execute("door", (f"{free}({robot})",), (SkillCall(free, (robot,)),))
                return True
            case "underway" if not now.left:
                self.let_in()
                return True
            case "here" if now.resting:
                self._send_out(now.help.name)
                return True
            case "sending" | "lent" if now.silent_s >= 0.0:
                return self._misses(now.silent_s + now.help.term_units * self.mind.unit_s)
            case "recalling":
                self._call_home()
                return True
            case "homing":
                self._fetch_home()
                return True
        return False

    def _is_missing(self) -> bool:
        """Is the robot broken that was to go, or any that could?"""
        now, robots = self.mind.memory, self.mind.words.robots(self.mind.memory.state)
        return now.help.name not in robots if now.help.name else not robots

    def _choose(self) -> str:
        """An offer did not say which robot would go."""
        mind, now = self.mind, self.mind.memory
        robots = mind.words.robots(now.state)
        free = [robot for robot in robots if mind.words.held(now.state, robot) is None]
        robot = (free or robots)[0]
        self.helpers.take(helping.chosen(now.help, f"{mind.team}.{robot}", robot))
        return robot

    def _send_out(self, robot: str) -> None:
        """To the door, and out: the own robot that helps, or the guest."""
        mind, now = self.mind, self.mind.memory
        at, words = mind.words.cell(now.state, robot), mind.words
        doors = words.doors(mind.static, now.state)[now.help.partner_room]
        if at in doors:
            action = f"{words.leave}({robot},{now.help.partner_room})"
            self._execute("leave", (action,), (SkillCall(words.leave, (robot, now.help.partner_room)),))
            return
        if not now.stood and at is not None and not now.help.asker:
            mind.keep(stood=recovering.written(at))
        self._drive("door", robot, doors)

    def entering(self) -> tuple[SkillCall, ...]:
        """The call that lets a robot in that is on its way here."""
        help_ = self.mind.memory.help
        if help_.phase not in ("underway", "homing") or help_.name in self.mind.words.robots(self.mind.memory.state):
            return ()
        return (SkillCall(self.mind.words.enter, (help_.name,), {"robot": help_.robot}),)

    def let_in(self) -> None:
        """Wait for the robot that is on its way here, and leave it room at the door."""
        if not self._clear_door(self.mind.memory.help.name):
            self._execute("enter", (), self.entering())

    def _clear_door(self, comer: str) -> bool:
        """Have a robot step aside if no cell of the door is free of them for the one that comes, or wants to go out.
        False if there is no need, or no place to go."""
        mind, now, words = self.mind, self.mind.memory, self.mind.words
        doors = words.doors(mind.static, now.state)[now.help.partner_room]
        standing = {words.cell(now.state, robot): robot for robot in words.robots(now.state) if robot != comer}
        if not set(doors) <= set(standing):
            return False
        robot, people = standing[doors[0]], recovering.people(words, now.state)
        if (held := words.held(now.state, robot)) is not None and held[0] in words.heavy(now.state):
            return False
        at = mind.ways.nearest_cell(now.state, robot, {*standing, *doors, words.cell(now.state, comer)}, people)
        if at is None:
            return False
        call = mind.ways.driving(now.state, robot, {robot: at}, people)
        reason = f"it stands in the door to {now.help.partner_room}"
        text = f"has {robot} step aside to ({at[0]},{at[1]}): {reason}"
        mind.emit("made_way", text, step=now.step, robot=robot, reason=reason)
        self._execute("aside", (recovering.term(call),), (call,))
        return True

    def _fetch_home(self) -> None:
        mind, now = self.mind, self.mind.memory
        if now.help.name in now.broken:
            self._is_home()
        elif now.help.name not in mind.words.robots(now.state):
            self.let_in()
        elif now.stood and recovering.written(mind.words.cell(now.state, now.help.name) or (-1, -1)) != now.stood:
            self._drive("home", now.help.name, [cell(now.stood)])
        else:
            self._is_home()

    def _misses(self, until_s: float) -> bool:
        """The asker is out of contact; the robot that it has is called home when it has been for too long."""
        mind, now = self.mind, self.mind.memory
        if mind.node.now_s + 1e-9 < until_s:
            mind.node.wake_at(until_s)
            return False
        self.helpers.take(helping.recalled(now.help))
        self._call_home()
        return True

    def _call_home(self) -> None:
        """Have the robot come by itself, from wherever it is: a piece of the way in each step."""
        mind, now = self.mind, self.mind.memory
        name, recall = now.help.name, mind.words.recall
        if now.recalls >= recovering.PATIENCE_UNITS:
            text = f"gives up {name}, which does not come home"
            mind.emit("robot_broken", text, step=now.step, about=name, robot=name)
            self._is_alone()
            return
        if not now.recalls:
            silent = f"{now.help.partner} has been out of contact for {now.help.term_units} units"
            why = silent if now.silent_s >= 0.0 else f"{now.help.partner} needs it no more"
            mind.emit("helper_called", f"calls {name} home: {why}", robot=name, of=now.help.partner)
        mind.keep(recalls=now.recalls + 1)
        self._execute("recall", (f"{recall}({name})",), (SkillCall(recall, (name,), {"robot": now.help.robot}),))

    def _drive(self, purpose: Purpose, robot: str, cells: list[Cell]) -> None:
        """To the first of these cells that is free and can be reached; if there is none, wait a unit."""
        mind, now = self.mind, self.mind.memory
        taken = {mind.words.cell(now.state, other) for other in mind.words.robots(now.state) if other != robot}
        for goal in cells:
            if goal in taken:
                continue
            try:
                call = mind.ways.driving(now.state, robot, {robot: goal}, recovering.people(mind.words, now.state))
            except NoWay:
                continue
            self._execute(purpose, (recovering.term(call),), (call,))
            return
        if purpose == "home":  # it stays where it is: somebody has taken its place
            self._is_home()
        elif not self._clear_door(robot):
            mind.wait(1)

    # ------------------------------------------------------------ what came of it
    def executed(self, begun: Begun, before: State, felt: Mapping[str, str]) -> None:
        """A step on the way between rooms is over; one that failed is tried again, unless its robot did nothing and
        felt nothing."""
        mind, now = self.mind, self.mind.memory
        for robot in (str(parse(action)[1][0]) for action in begun.actions if begun.purpose != "recall"):
            idle = of_body(now.state, robot) == of_body(before, robot)
            if idle and robot in mind.words.robots(now.state) and robot not in felt:
                recovering.broken_outside_plan(mind, robot, begun.step)
                return
        if begun.purpose == "leave" and now.help.name not in mind.words.robots(now.state):
            partner, guest = now.help.partner, now.help.asker
            kind, text = ("helper_sent_back", "sends") if guest else ("helper_left", "has")
            where = f"back to {partner}" if guest else f"leave for {partner}"
            mind.emit(kind, f"{text} {now.help.name} {where}", robot=now.help.name, to=partner)
            mind.keep(help=helping.left(now.help), course=None, looked=False, resting=False)

    def came_in(self) -> None:
        """Has the robot come in that was on its way here?"""
        mind, now = self.mind, self.mind.memory
        if now.help.name not in mind.words.robots(now.state):
            return
        if now.help.phase == "underway":
            text = f"has {now.help.name} of {now.help.partner} at its orders"
            mind.emit("helper_came", text, robot=now.help.name, of=now.help.partner)
            mind.keep(help=helping.came(now.help), course=None, need=None, looked=False, resting=False)
        elif now.help.phase == "recalling":
            mind.keep(help=helping.came(now.help))

    def missed(self, before: State) -> None:
        """Is a robot gone that was there before, without having been sent away?"""
        now, words = self.mind.memory, self.mind.words
        for robot in sorted({*words.robots(before)} - {*words.robots(now.state)}):
            if now.help.phase == "here" and robot == now.help.name:
                self.mind.keep(help=helping.missed(now.help))
            self.helpers.guest_gone(robot)

    def _is_home(self) -> None:
        mind, now = self.mind, self.mind.memory
        text = f"has {now.help.name} back from {now.help.partner}, and resumes its own work"
        mind.emit("helper_returned", text, robot=now.help.name, of=now.help.partner)
        self._is_alone()

    def _is_alone(self) -> None:
        """Helping nobody any more: what is left to do here?"""
        done = helping.home(self.mind.memory.help)
        self.mind.keep(
            help=done, stood="", recalls=0, course=None, looked=False, resting=False, offered=False, silent_s=-1.0
        )
        self.helpers.tell()
