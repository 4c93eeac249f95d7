"""Rooms for the tests of the world, in no real domain's language, and what teams say there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bus.messages import Envelope, Execute, Executed, SkillCall, Value
from bus.scene import Action, Entity, Fault, Kind, Scene, Solid, Stop, Workspace
from tests.world.stage import Stage

UNIT_S = 3.0
KINDS = {
    "cart": Kind("r", "robot", "floor", "at", 0.25, 30.0, attributes=("low",), couples="holds", pose="pose"),
    "pot": Kind("", "object", "floor", "at", 0.12, 2.0, attributes=("raised",), end="end", grip="grip", pose="pose"),
    "human": Kind("", "person", "floor", "at", 0.25, 70.0, pose="pose"),
}
ACTIONS = {
    "go": Action("follow", ("robot", "x", "y")),
    "take": Action("grasp", ("robot",), point="what", counts="takes", needs={"low": "raised"}, clears="raised"),
    "drop": Action("release", ("robot",)),
    "out": Action("leave", ("robot", "room")),
    "in": Action("enter", ("robot",)),
    "home": Action("recall", ("robot",)),
}


def cart(team: str, name: str, x: int, y: int, **more: Any) -> Entity:
    return Entity(f"{team}.{name}", team, name, "cart", f"({x},{y})", {"low": 0, "holds": "none"}, **more)


def pot(team: str, name: str, x: int, y: int, end: str = "", **more: Any) -> Entity:
    return Entity(f"{team}.{name}", team, name, "pot", f"({x},{y})", {"raised": 1}, end=end, **more)


def human(team: str, name: str, x: int, y: int, *stops: Stop, again_s: float = 0.0) -> Entity:
    return Entity(f"{team}.{name}", team, name, "human", f"({x},{y})", {}, stops=stops, again_s=again_s)


def room(team: str, *solids: Solid, size: tuple[int, int] = (8, 8), **doors: tuple[int, int, int, int]) -> Workspace:
    """Team A lives in room_a."""
    fluents: dict[str, Value] = {"here": f"room_{team.lower()}", "takes": 0, "clock": 0}
    name = f"room_{team.lower()}"
    return Workspace(team, *size, room=name, solids=solids, doors=doors, fluents=fluents, clock="clock")


def house(*entities: Entity, rooms: tuple[Workspace, ...] = (room("A"),), faults: tuple[Fault, ...] = ()) -> Scene:
    return Scene("none", 1, UNIT_S, 0.02, 5.0, 2, KINDS, ACTIONS, rooms, entities, faults=faults, conducted=False)


def go(robot: str, *points: tuple[float, float], units: int) -> SkillCall:
    """Points in metres."""
    way = ",".join(f"({round(1000 * x)},{round(1000 * y)})" for x, y in points)
    return SkillCall("go", (robot, int(points[-1][0]), int(points[-1][1])), {"way": f"({way},)", "units": units})


def do(name: str, *args: Value, **detail: Value) -> SkillCall:
    return SkillCall(name, args, detail)


class House(Stage):
    """The teams' steps by hand: `act` tells how the step ended."""

    def __init__(self, scene: Scene, home: Path | None = None) -> None:
        super().__init__(scene, home)
        self.steps: dict[str, int] = {}

    def waits(self) -> list[str]:
        """Who was said to wait at a door."""
        return [str(event["text"]) for event in self.events("waits_at_door")]

    def again(self) -> House:
        """Kill this world and start the next life of it."""
        self.node.close()
        other = House(self.scene, self.home)
        other.steps = self.steps
        return other

    def command(self, team: str, *calls: SkillCall) -> Envelope:
        """The team's next step, to be delivered."""
        step = self.steps[team] = self.steps.get(team, -1) + 1
        return self.mail(team, Execute(team, step, calls), f"{team}.step.{step}")

    def act(self, team: str, *calls: SkillCall) -> Executed:
        """Carry out a step and let time pass until it is over."""
        command = self.command(team, *calls)
        self.deliver(command)
        return self.ended(command)

    def ended(self, command: Envelope) -> Executed:
        """Let time pass until a step is over."""
        while True:
            for _, message in reversed(self.sent):
                if message.re == command.id and isinstance(message.body, Executed):
                    return message.body
            wish = self.world.next_s()
            assert wish is not None
            assert wish < 1000
            self.now_s = max(wish, self.now_s)
            self.world.advance(self.now_s)


def where(stage: House, name: str) -> tuple[float, float]:
    """In the coordinates of its room."""
    return stage.world.truth.local(stage.world.truth.things[name])
