"""A small system to try the clock on: a world that lets teams take steps, teams, and a coordinator that is told.

As processes: ``python -m tests.bus.toys ROLE OPTIONS``, with the options of every process.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Callable
from typing import NamedTuple

from bus.clock import run_world
from bus.messages import Body, Enquire, Envelope, Execute, Executed, ProcessFault, Standing
from bus.node import Node, NodeConfig, arguments, open_node

STEPS = 6
PERIOD_S = 1.0
TEAMS = ("T1", "T2", "T3")
Hook = Callable[[str, int], None]


def nothing(name: str, step: int) -> None:
    pass


class Disturbance(NamedTuple):
    at_s: float
    kind: str
    target: str


class World:
    """Every `Execute` takes a period. It remembers in its journal which steps were taken."""

    def __init__(self, node: Node, disturbances: tuple[Disturbance, ...] = ()) -> None:
        self.node = node
        self.executions: list[tuple[str, int]] = []
        self._running: list[tuple[float, Envelope, Execute]] = []
        self._disturbances = [d for d in disturbances if node.journal.get(f"did {d.at_s}") is None]
        self.start_s = float((node.journal.get("now") or b"0").decode())

    def handle(self, mail: tuple[Envelope, ...]) -> None:
        for envelope in mail:
            if not isinstance(envelope.body, Execute):
                continue
            command = envelope.body
            if self.node.journal.get(f"{command.team} {command.step}") is not None:
                self.node.reply(envelope, Executed(command.team, command.step, {}))
                continue
            self.node.emit("step_started", "", team=command.team, step=command.step, command=envelope.id)
            self._running = [r for r in self._running if (r[2].team, r[2].step) != (command.team, command.step)]
            self._running.append((self.node.now_s + PERIOD_S, envelope, command))

    def next_s(self) -> float | None:
        times = [at_s for at_s, _, _ in self._running] + [d.at_s for d in self._disturbances]
        return min(times, default=None)

    def advance(self, to_s: float) -> None:
        ready = [r for r in self._running if r[0] <= to_s]
        self._running = [r for r in self._running if r[0] > to_s]
        for _, envelope, command in ready:
            self.executions.append((command.team, command.step))
            with self.node.journal.transaction():
                self.node.journal.put("now", str(to_s).encode())
                self.node.journal.put(f"{command.team} {command.step}", b"taken")
                self.node.emit("step_ended", "", team=command.team, step=command.step)
                self.node.reply(envelope, Executed(command.team, command.step, {}))
        while self._disturbances and self._disturbances[0].at_s <= to_s:
            todo = self._disturbances.pop(0)
            self.node.journal.put(f"did {todo.at_s}", b"")
            kind = {"kill": "kill", "pause": "pause", "resume": "resume"}[todo.kind]
            self.node.ask("supervisor", ProcessFault(kind, todo.target), timeout_s=10.0)  # type: ignore[arg-type]
            if kind == "resume":
                self.node.expect(todo.target)

    def contact(self, name: str, state: str) -> None:
        self.node.emit("contact", "", name=name, state=state)


def world(
    node: Node,
    participants: tuple[str, ...] = ("coordinator", *TEAMS),
    disturbances: tuple[Disturbance, ...] = (),
    lease_s: float = 3.0,
    return_s: float = 15.0,
) -> World:
    toy = World(node, disturbances)
    run_world(
        node,
        toy,
        participants=participants,
        mode=node.mode,
        factor=node.config.factor,
        start_s=toy.start_s,
        lease_s=lease_s,
        return_s=return_s,
        on_contact=toy.contact,
    )
    return toy


def team(node: Node, hook: Hook = nothing, steps: int = STEPS) -> None:
    """Take steps, telling the coordinator after each; the number of steps taken is journalled."""
    dice = random.Random(f"{node.config.seed} {node.name}")
    step = int((node.journal.get("step") or b"0").decode())

    def next_step() -> None:
        if step < steps:
            node.request("world", Execute(node.name, step))
        else:
            node.emit("team_finished", "", step=step)

    started = False
    for turn in node.turns():
        if not started:
            started = True
            next_step()
        for envelope in turn.mail:
            body: Body = envelope.body
            if isinstance(body, Executed) and body.step == step:
                hook(node.name, step)
                with node.journal.transaction():
                    step += 1
                    node.journal.put("step", str(step).encode())
                    node.emit("plan_adopted", "", start=step, epoch=dice.randrange(100))
                node.request("coordinator", Enquire(step))
            elif isinstance(body, Standing):
                next_step()


def coordinator(node: Node, hook: Hook = nothing) -> None:
    for turn in node.turns():
        for envelope in turn.mail:
            if isinstance(envelope.body, Enquire):
                hook(node.name, envelope.body.epoch)
                node.emit("question", "", team=envelope.src, step=envelope.body.epoch)
                node.reply(envelope, Standing(envelope.body.epoch, envelope.src, 0, False, 0))


def main(role: str, argv: list[str]) -> None:
    disturbances: tuple[Disturbance, ...] = ()
    if "--disturb" in argv:
        place = argv.index("--disturb")
        at_s, kind, target, again_s, again, _ = [*argv[place + 1].split(","), "", "", ""][:6]
        disturbances = (Disturbance(float(at_s), kind, target),)
        if again:
            disturbances += (Disturbance(float(again_s), again, target),)
        del argv[place : place + 2]
    config: NodeConfig = arguments(argv, name=role)
    with open_node(config) as node:
        if role == "world":
            world(node, disturbances=disturbances, lease_s=1.0)
        elif role == "coordinator":
            coordinator(node)
        else:
            team(node)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
