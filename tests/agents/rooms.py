"""Tiny set-ups of the painting factory, on a floor of two columns and two rows, and a world without physics."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from bus.messages import Envelope, Execute, Executed, Handover, Observe, Observed, Ok, SkillCall, State
from bus.node import Node
from tests.reasoning.simulator import Floor, Judge, floor, needed
from world.herald import Herald

DOMAIN = "factory"
DELAY = 1
SIZE = (2, 2)
STATIC = {"width": 2, "height": 2, "line": 2, "delay": DELAY}


def room(*workers: tuple[str, int], boxes: Mapping[int, tuple[int, int]], carrier: str = "") -> State:
    """A team's sensed state: `workers` as (cell, effector), `boxes` as (line position, stage)."""
    state: State = {}
    for number, (cell, effector) in enumerate(workers, 1):
        state |= {f"at(w{number})": cell, f"effector(w{number})": effector}
    for box, (place, stage) in boxes.items():
        state |= {f"line({box})": place, f"stage({box})": stage, f"wet({box})": 0}
    return state | ({"at(c1)": carrier, "attached(c1)": "none"} if carrier else {})


WAXED = {1: (2, 2)}
"""A box beside the only cell to work in; a stamper there needs a step, and two line shifts follow."""
ALONE = room(("(1,2)", 3), boxes=WAXED)
"""Four steps: to the line, stamp, shift, shift."""
LENDER = room(("(1,2)", 3), ("(1,1)", 3), boxes=WAXED)
"""Four steps with a worker to spare, who stands in the pit stop."""
BORROWER = room(boxes=WAXED)
"""Nobody to do the work."""
PAINTER = room(("(2,2)", 1), boxes={1: (2, 0)})
"""Painting first: what is wet must dry before it is waxed."""


class World:
    """Says what becomes of commands, each of which it carries out once. Robots in `broken`, by the names they were
    built with, achieve nothing."""

    def __init__(self, node: Node, rooms: Mapping[str, State]) -> None:
        self.node = node
        self.floors: dict[str, Floor] = {team: floor(state, ()) for team, state in rooms.items()}
        self.built = {(team, robot): f"{team}.{robot}" for team, now in self.floors.items() for robot in now.at}
        self.broken: set[str] = set()
        self.bench: dict[str, int] = {}
        self.done: Counter[tuple[str, int]] = Counter()
        self.handed: list[tuple[str, Handover]] = []
        self.herald = Herald(node, "coordinator")
        self._next = dict.fromkeys(rooms, 0)
        self._judge = Judge(SIZE, DELAY, None, {})

    def turn(self, mail: tuple[Envelope, ...]) -> None:
        for envelope in mail:
            match envelope.body:
                case _ if envelope.re:
                    self.herald.told(envelope.re)
                case Execute(team, step, calls):
                    self.node.reply(envelope, self.execute(team, step, calls))
                case Observe(team):
                    self._wait(team, max(self._next.values()))
                    self.node.reply(envelope, Observed(team, self.floors[team].state()))
                case _:
                    self.node.reply(envelope, Ok())

    def execute(self, team: str, step: int, calls: tuple[SkillCall, ...]) -> Executed:
        self.done[team, step] += 1
        self._wait(team, step)
        now, findings = self.floors[team], {}
        tools = self._judge.tools = {}
        actions = []
        broken = {robot for (of, robot), built in self.built.items() if of == team and built in self.broken}
        for call in calls:
            action = f"{call.name}({','.join(map(str, call.args))})" if call.args else call.name
            robot = str(call.args[0]) if call.args else ""
            if call.name == "inspect":
                findings[robot] = "broken" if robot in broken else "sound"
            elif call.name == "repair":
                self.broken.discard(self.built[team, robot])
            elif call.name != "takeRobot":
                actions.append(action)
            elif self.bench.get(str(call.detail["robot"]), step) + DELAY <= step:
                tools[team, step, action] = int(call.detail["effector"])
                now.workers.add(robot)
                actions.append(action)
        effective = self._judge.step(team, now, step, tuple(actions), broken)
        self._hand_over(team, step, calls, effective)
        self._next[team] = step + 1
        return Executed(team, step, now.state(), findings)

    def _hand_over(self, team: str, step: int, calls: tuple[SkillCall, ...], effective: list[str]) -> None:
        for call in calls:
            robot = str(call.args[0]) if call.args else ""
            if call.name == "giveRobot" and f"giveRobot({robot})" in effective:
                built = self.built.pop((team, robot))
                self.bench[built] = step
                self.handed.append((team, Handover(built, step)))
            elif call.name == "takeRobot" and any(needed(a) == [] and a.startswith("take") for a in effective):
                built = str(call.detail["robot"])
                del self.bench[built]
                self.built[team, robot] = built
                self.handed.append((team, Handover(built, step)))

    def _wait(self, team: str, until: int) -> None:
        """While others act, time passes here too: paint dries."""
        for step in range(self._next[team], until):
            self._judge.step(team, self.floors[team], step, ())
            self._next[team] = step + 1

    def finished(self) -> bool:
        floors = self.floors.values()
        return all(s == 3 for now in floors for s in now.stage.values()) and not any(
            place for now in floors for place in now.line.values()
        )
