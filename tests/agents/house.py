"""A house without physics for autonomous teams: real minds on real nodes over the in-memory twin, and a world of cells
in which a step takes the units that it is given. Any process can be killed before any of its writes and sends.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from agents.autonomous.house import House
from agents.autonomous.team import Autonomous
from agents.setups import CoordinatorSetup, TeamSetup
from agents.thinker import Thinker
from bus.codec import decode
from bus.memory_transport import MemoryRouter
from bus.messages import (
    Contact,
    Envelope,
    Event,
    Execute,
    Executed,
    Observe,
    Observed,
    Ok,
    RunOver,
    SkillCall,
    State,
    Value,
)
from bus.node import Node
from reasoning.setup import Refused, Setup, compile_setup
from reasoning.solver import parse
from tests.agents.cells import Cell, cell, grip, stop_before, term
from tests.agents.together import Process, Supervisor

DOMAIN = "housekeeping"
UNIT_S = 3.0
HALLWAY = 2


@dataclass
class Robot:
    id: str
    team: str
    name: str
    at: Cell
    holds: tuple[str, int] | None = None
    there_s: float = 0.0
    came_from: str = ""
    pose: tuple[float, float] | None = None
    broken: bool = False
    weak: bool = False
    called: bool = False


@dataclass
class Thing:
    """`end` is the cell of a heavy thing's other end; `felt`: that it is heavy is known; `seen`: it can be seen."""

    team: str
    name: str
    kind: str
    at: Cell
    end: Cell | None = None
    felt: bool = True
    seen: bool = True


@dataclass
class Doing:
    envelope: Envelope
    due_s: float


class Rooms:
    """The world. `before[(team, text of an action)]` is done when such an action begins."""

    def __init__(self, node: Node, setup: Setup) -> None:
        self.node, self.setup = node, setup
        self.now_s = 0.0
        self.robots: dict[str, Robot] = {}
        self.things: dict[str, Thing] = {}
        self.persons: dict[str, tuple[str, Cell, float]] = {}
        self.attaches: Counter[str] = Counter()
        self.done: Counter[tuple[str, int]] = Counter()
        self.before: dict[tuple[str, str], Callable[[], None]] = {}
        self._doing: list[Doing] = []
        for team, state in setup.states.items():
            for fluent, value in state.items():
                name, args = parse(fluent)
                if name == "connected":
                    robot = str(args[0])
                    weak = state.get(f"light_weight({robot})", 0) == 1
                    at = cell(state[f"at({robot})"])
                    self.robots[f"{team}.{robot}"] = Robot(f"{team}.{robot}", team, robot, at, weak=weak)
                elif name == "kind":
                    thing = str(args[0])
                    end = state.get(f"end({thing})")
                    at = cell(state[f"at({thing})"])
                    self.things[thing] = Thing(team, thing, str(value), at, None if end is None else cell(end))

    # ------------------------------------------------------------ mail
    def turn(self, mail: tuple[Envelope, ...]) -> None:
        for envelope in mail:
            match envelope.body:
                case _ if envelope.re:
                    pass
                case Execute(team, _, calls):
                    texts = {f"{c.name}({','.join(map(str, c.args))})" for c in calls}
                    for key in [k for k in self.before if k[0] == team and k[1] in texts]:
                        self.before.pop(key)()
                    for call in calls:
                        if call.name == "recall":
                            self.robots[str(call.detail["robot"])].called = True
                    units = max((int(c.detail.get("units", 1)) for c in calls), default=1)
                    self._doing.append(Doing(envelope, self.now_s + units * UNIT_S))
                case Observe(team):
                    self.node.reply(envelope, Observed(team, self.state(team)))
                case _:
                    self.node.reply(envelope, Ok())

    def pass_time(self, now_s: float) -> None:
        self.now_s = now_s
        for doing in [d for d in self._doing if d.due_s <= now_s + 1e-9]:
            self._doing.remove(doing)
            body = doing.envelope.body
            assert isinstance(body, Execute)
            self.done[body.team, body.step] += 1
            felt: dict[str, Any] = {}
            for call in body.calls:
                self._carry_out(body.team, call, felt)
            self.node.reply(doing.envelope, Executed(body.team, body.step, self.state(body.team), {}, felt))

    def next_s(self) -> float:
        return min((d.due_s for d in self._doing), default=math.inf)

    # ------------------------------------------------------------ what is seen
    def state(self, team: str) -> State:
        room = self.setup.states[team]["room"]
        seen: dict[str, Value] = {"room": room, "attaches": self.attaches[team]}
        seen["elapsed"] = math.ceil(self.now_s / UNIT_S - 1e-6)
        mine = [r for r in self.robots.values() if r.team == team and not r.called]
        for r in mine:
            seen |= {f"at({r.name})": term(r.at), f"connected({r.name})": grip(r.holds)}
            seen |= {f"light_weight({r.name})": 1} if r.weak else {}
            if r.pose is not None:
                seen[f"pose({r.name})"] = term((round(1000 * r.pose[0]), round(1000 * r.pose[1])))
        for t in self.things.values() if mine else ():
            if t.team == team and t.seen:
                seen |= {f"kind({t.name})": t.kind, f"at({t.name})": term(t.at), f"raised({t.name})": 0}
                seen |= {f"end({t.name})": term(t.end)} if t.end is not None and t.felt else {}
        for name, (where, at, until_s) in self.persons.items():
            if where == team and self.now_s < until_s and mine:
                seen |= {f"kind({name})": "person", f"at({name})": term(at)}
        return seen

    # ------------------------------------------------------------ what is done
    def _carry_out(self, team: str, call: SkillCall, felt: dict[str, Any]) -> None:
        own = (r for r in self.robots.values() if (r.team, r.name, r.called) == (team, call.args[0], False))
        robot = next(own, None)
        if call.name in ("enter", "recall"):
            comer = self.robots[str(call.detail["robot"])]
            if comer.broken:
                return
            if (
                comer.team == "bench"
                and comer.there_s <= self.now_s + 1e-9
                and (not comer.called or call.name == "recall")
            ):
                door = self._door(team, comer.came_from)
                if any((r.team, r.at) == (team, door) for r in self.robots.values()):
                    felt[str(call.args[0])] = "blocked"
                    return
                comer.team, comer.at, comer.called = team, door, False
            elif call.name == "recall" and comer.holds is not None:
                comer.holds = None
            elif call.name == "recall" and comer.team not in ("bench", team):
                self._leave(comer)
        elif robot is None or robot.broken:
            pass
        elif call.name == "goto":
            self._go(robot, call, felt)
        elif call.name == "attach":
            self._attach(robot, str(call.detail["attach_point"]), felt)
        elif call.name == "detach":
            robot.holds = None
        elif call.name == "leave":
            self._leave(robot)

    def _leave(self, robot: Robot) -> None:
        robot.came_from = str(self.setup.states[robot.team]["room"])
        robot.team, robot.there_s = "bench", self.now_s + HALLWAY * UNIT_S

    def _go(self, robot: Robot, call: SkillCall, felt: dict[str, Any]) -> None:
        points = [
            (int(x) / 1000, int(y) / 1000) for x, y in (parse(str(p))[1] for p in parse(str(call.detail["way"]))[1])
        ]
        thing = self.things.get(robot.holds[0]) if robot.holds else None
        if thing is not None and thing.end is not None:
            holders = {r.holds for r in self.robots.values() if r.holds and r.holds[0] == thing.name}
            if len(holders) < 2:
                thing.felt, felt[robot.name] = True, "too_heavy"
                return
        blocks = [(t, t.at) for t in self.things.values() if t.team == robot.team and not t.seen]
        people = [
            (None, at) for where, at, until_s in self.persons.values() if where == robot.team and self.now_s < until_s
        ]
        for other, at in [*blocks, *people]:
            stop = stop_before(points, (at[0] + 0.5, at[1] + 0.5), 0.6 if other is None else 0.37)
            if stop is not None:
                robot.pose, robot.at, felt[robot.name] = stop, (int(stop[0]), int(stop[1])), "blocked"
                if other is not None:
                    other.seen = True
                self._drag(robot)
                return
        robot.pose, robot.at = None, (int(call.args[1]), int(call.args[2]))
        self._drag(robot)

    def _drag(self, robot: Robot) -> None:
        if robot.holds is not None:
            thing = self.things[robot.holds[0]]
            if robot.holds[1] == 1:
                thing.at = robot.at
            else:
                thing.end = robot.at

    def _attach(self, robot: Robot, point: str, felt: dict[str, Any]) -> None:
        name, number = (lambda args: (str(args[0]), int(args[1])))(parse(point)[1])
        thing = self.things.get(name)
        where = None if thing is None or thing.team != robot.team else thing.at if number == 1 else thing.end
        if where != robot.at:
            felt[robot.name] = "nothing_there"
            return
        robot.holds = (name, number)
        self.attaches[robot.team] += 1

    def _door(self, team: str, room: str) -> Cell:
        here = self.setup.states[team]["room"]
        west, _, south, _ = parse(str(self.setup.static[f"area({here},{room})"]))[1]
        return int(west), int(south)


class Home:
    """Coordinator, teams, the world and somebody to hear the last word. Events are collected as they are sent."""

    def __init__(self, home: Path, teams: Mapping[str, Any], **house: Any) -> None:
        found = compile_setup(DOMAIN, {"house": {"geometry": "none", "hallway": HALLWAY, **house}, "teams": teams})
        assert not isinstance(found, Refused), found
        self.home, self.run, self.now_s = home, "test", 0.0
        self.router = MemoryRouter(seed=1)
        self.events: list[tuple[str, Event]] = []
        self.router.connect().subscribe("muster/test/event/*", self._hear)
        setup = CoordinatorSetup(tuple(teams), HALLWAY, conducted=False)
        makers: dict[str, Callable[[Node], Any]] = {
            "supervisor": Supervisor,
            "world": lambda node: Rooms(node, found),
            "coordinator": lambda node: House(node, setup),
        }
        for name in teams:
            made = TeamSetup(DOMAIN, name, dict(found.static))
            makers[name] = lambda node, made=made: Autonomous(node, made, Thinker(node, threaded=False))
        self.processes = {name: Process(self, name, make) for name, make in makers.items()}  # type: ignore[arg-type]
        for process in self.processes.values():
            process.live()
        self.world: Rooms = self.processes["world"].mind
        for name in ("coordinator", *teams):
            self.processes[name].mind.turn(())

    def _hear(self, key: str, payload: bytes) -> None:
        envelope = decode(payload)
        assert isinstance(envelope, Envelope)
        assert isinstance(envelope.body, Event)
        self.events.append((envelope.src, envelope.body))

    def contact(self, name: str, state: Any) -> None:
        """The world tells the coordinator; who is out of contact does nothing meanwhile."""
        self.processes[name].asleep = state in ("lost_contact", "stopped")
        self.world.node.request("coordinator", Contact(name, state))

    @property
    def over(self) -> RunOver | None:
        return self.processes["supervisor"].mind.over

    def kinds(self, team: str = "") -> list[str]:
        return [event.kind for source, event in self.events if team in ("", source)]

    def until(self, condition: Callable[[], Any], limit_s: float = 600.0) -> None:
        turns = 0
        while not condition():
            turns += 1
            assert self.now_s < limit_s, f"not within {limit_s} s: {self.story()}"
            assert turns < 20_000, f"it goes in circles: {self.story()}"
            busy = [process.turn() for process in self.processes.values()]
            if not any(busy):
                self.now_s += 0.5
                self.world.pass_time(self.now_s)
                self.router.flush()
                for name, process in self.processes.items():
                    if process.node is not None and not process.asleep and name not in ("world", "supervisor"):
                        process.poke()

    def end(self) -> RunOver:
        self.until(lambda: self.over)
        assert self.over is not None
        twice = [where for where, times in self.world.done.items() if times > 1]
        assert not twice, f"{twice} was carried out twice"
        return self.over

    def story(self) -> str:
        lines = [f"{source}: {e.kind} {json.dumps(e.data, default=str)[:300]}" for source, e in self.events]
        return "\n".join(lines)

    def close(self) -> None:
        for process in self.processes.values():
            if process.node is not None:
                process.die()
