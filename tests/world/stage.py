"""A world on a bus in memory, driven by hand: no clock, no processes. The scene speaks no real domain's language."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from bus import keys
from bus.codec import decode
from bus.memory_transport import MemoryRouter
from bus.messages import (
    Body,
    Envelope,
    Event,
    Execute,
    Executed,
    Inject,
    Injected,
    Observe,
    Observed,
    SkillCall,
    State,
    Value,
)
from bus.node import Node, NodeConfig, open_node
from bus.scene import Action, Entity, Fault, Kind, Scene, Workspace
from world.simulation import World

PERIOD_S = 2.0
KINDS = {
    "hand": Kind("h", "robot", "grid", "at", 0.32, 20.0, layer=1, attributes=("tool",)),
    "tug": Kind("t", "robot", "grid", "at", 0.38, 40.0, layer=2, couples="holds"),
    "piece": Kind("", "object", "line", "line", 0.3, 5.0, layer=3, attributes=("state", "hot")),
}
ACTIONS = {
    "go": Action("drive", ("robot", "direction")),
    "join": Action("couple", ("robot", "partner")),
    "part": Action("uncouple", ("robot",)),
    "push": Action("drive_coupled", ("robot",), direction="up"),
    "pull": Action("drive_coupled", ("robot",), direction="down"),
    "fit": Action("set", ("robot", "value"), attribute="tool"),
    "work": Action("operate", ("robot", "object"), attribute="state", tool="tool", marks="hot", marks_on=1),
    "shift": Action("convey"),
    "give": Action("depart", ("robot",)),
    "take": Action("arrive", ("robot", "x", "y")),
    "mend": Action("repair", ("robot",)),
    "look": Action("inspect", ("robot",)),
}


def hand(team: str, name: str, x: int, y: int, tool: int = 1, broken: bool = False) -> Entity:
    return Entity(f"{team}.{name}", team, name, "hand", f"({x},{y})", {"tool": tool}, broken)


def tug(team: str, name: str, x: int, y: int, holds: str = "none", broken: bool = False) -> Entity:
    return Entity(f"{team}.{name}", team, name, "tug", f"({x},{y})", {"holds": holds}, broken)


def piece(team: str, number: int, position: int, state: int = 0) -> Entity:
    return Entity(f"{team}.{number}", team, str(number), "piece", position, {"state": state, "hot": 0})


def scene(*entities: Entity, teams: int = 1, faults: tuple[Fault, ...] = (), delay: int = 2, **more: Any) -> Scene:
    """Workspaces A, B, ... of 5 x 3 cells with a line of 5."""
    spaces = tuple(Workspace("ABCDEFGHIJ"[i], 5, 3, 5, 1) for i in range(teams))
    settings: dict[str, Any] = {"period_s": PERIOD_S, "dt_s": 0.02, "frame_hz": 5.0, **more}
    return Scene(
        domain="none",
        seed=1,
        transport_delay_steps=delay,
        kinds=KINDS,
        actions=ACTIONS,
        workspaces=spaces,
        entities=entities,
        faults=faults,
        **settings,
    )


def call(text: str, **detail: Value) -> SkillCall:
    """``work(h1,2)`` as a call."""
    name, _, inside = text.partition("(")
    args = [a for a in inside.rstrip(")").split(",") if a]
    return SkillCall(name, tuple(int(a) if re.fullmatch(r"-?\d+", a) else a for a in args), detail)


class Stage:
    """One life of a world, its teams played by hand. Use `again` for the next life."""

    def __init__(self, scene: Scene, home: Path | None = None) -> None:
        self.scene, self.home = scene, home
        self.router = MemoryRouter()
        self.sent: list[tuple[str, Envelope]] = []
        ear = self.router.connect()
        ear.subscribe("muster/**", self._hear)
        self.node: Node = open_node(NodeConfig("test", "world", home=home), self.router.connect())
        self.node.post.outbox.now = lambda: self.now_s
        self.now_s = 0.0
        self.asked: list[Body] = []
        self.node.ask = self._ask  # type: ignore[method-assign]
        self.world = World(self.node, scene)
        self.now_s = self.world.now_s
        self._number = 0

    def again(self) -> Stage:
        """Kill this world and start the next life of it."""
        self.node.close()
        return Stage(self.scene, self.home)

    def _hear(self, key: str, payload: bytes) -> None:
        message = decode(payload)
        assert isinstance(message, Envelope), message
        self.sent.append((key, message))

    def _ask(self, to: str, body: Body, timeout_s: float) -> Body:
        self.asked.append(body)
        return Injected(True)

    # ------------------------------------------------------------ what the others say
    def mail(self, source: str, body: Body, name: str = "") -> Envelope:
        self._number += 1
        name = name or f"{source}.{self.node.incarnation}.{self._number}"
        return Envelope(1, "test", source, 1, self._number, name, self.now_s, body)  # type: ignore[arg-type]

    def deliver(self, *messages: Envelope) -> None:
        """As the node does: in order, and only what is to be handled."""
        self.world.handle(tuple(m for m in messages if self.node.post.accept(m)))

    def advance(self, seconds: float) -> None:
        """Let simulated time pass, stopping where the world wants to."""
        end_s = self.now_s + seconds
        while self.now_s < end_s - 1e-9:
            wish = self.world.next_s()
            self.now_s = min(end_s, wish) if wish is not None and wish > self.now_s else end_s
            self.world.advance(self.now_s)

    def step(self, number: int, **actions: str | list[SkillCall]) -> dict[str, Executed]:
        """All named teams execute a step: ``step(3, A="go(h1,up) shift")``. What they are told at its end."""
        seen = len(self.sent)
        orders = []
        for team, todo in actions.items():
            calls = [call(text) for text in todo.split()] if isinstance(todo, str) else todo
            orders.append(self.mail(team, Execute(team, number, tuple(calls))))
        self.deliver(*orders)
        self.advance(self.scene.period_s)
        replies = [m.body for _, m in self.sent[seen:] if isinstance(m.body, Executed)]
        return {body.team: body for body in replies}

    def state(self, team: str = "A") -> State:
        return self.ask(team, Observe(team), Observed).state

    def inject(self, kind: str, target: str, **args: Value | float) -> Injected:
        return self.ask("operator", Inject(kind, target, args), Injected)

    def ask(self, source: str, body: Body, expected: type[Any]) -> Any:
        seen = len(self.sent)
        self.deliver(self.mail(source, body))
        return next((m.body for _, m in self.sent[seen:] if isinstance(m.body, expected)), None)

    # ------------------------------------------------------------ what was recorded
    def events(self, kind: str) -> list[dict[str, Any]]:
        return [m.body.data for _, m in self.sent if isinstance(m.body, Event) and m.body.kind == kind]

    def reasons(self) -> list[str]:
        return [str(event["reason"]) for event in self.events("skill_failed")]

    def bodies(self, kind: type[Body], to: str = "") -> list[Any]:
        return [
            m.body
            for key, m in self.sent
            if isinstance(m.body, kind) and (not to or key.startswith(keys.mail("test", to, "")))
        ]
