"""How fast is the world? ``python -m bench.world``, or ``muster bench world``.

Physics steps per second with 100 bodies, 50 of them driven up and down between cells, taken in turns in one process so
that all meet the same machine; the best of several rounds, since what else the machine does only ever costs time.

- *bare*: pymunk with the same bodies, joints and drive commands, and nothing else.
- *world*: ours, on a bus and a journal that do nothing: it judges 50 calls a period, moves bodies by the same physics,
  senses ten teams, packs its state. It leaves bodies out of the physics that lie on a line that stands.
- *process*: the same with all that a run needs: replies and state journalled in SQLite, events, and frames at 10 Hz,
  the rate at which scenarios record if they do not say otherwise.

And how many times faster than real time a world of the size of the published one runs, as a process, alone.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

import pymunk

from bus.clock import wall_s
from bus.memory_transport import MemoryRouter
from bus.messages import Envelope, Execute, SkillCall
from bus.node import NodeConfig, open_node
from bus.scene import Action, Entity, Kind, Scene, Workspace
from world.simulation import World
from world.things import MOVING, RAMP

PERIOD_S, DT_S = 2.0, 0.02
TICKS = round(PERIOD_S / DT_S)
PERIODS = 25
ROUNDS = 12
MASS_KG, BRAKE_N = 20.0, 400.0
TARGET = 0.7


def run(rounds: int = ROUNDS, periods: int = PERIODS) -> dict[str, Any]:
    """Measure: rates in physics steps per second, ratios to bare pymunk, the factor in simulated per wall seconds."""
    with tempfile.TemporaryDirectory() as home:
        contestants: dict[str, Contestant] = {
            "bare": Bare(100, 50),
            "world": Ours(_scene(10, 5, 4, frame_hz=1 / PERIOD_S), None),
            "process": Ours(_scene(10, 5, 4, frame_hz=10.0), Path(home) / "ten"),
            "published": Ours(_scene(4, 2, 5, frame_hz=10.0), Path(home) / "four"),
        }
        best = dict.fromkeys(contestants, float("inf"))
        for number in range(-1, rounds):
            for name, contestant in contestants.items():
                start = wall_s()
                contestant.live(periods)
                if number >= 0:  # what comes before warms up
                    best[name] = min(best[name], wall_s() - start)
    rate = {name: periods * TICKS / seconds for name, seconds in best.items()}
    return {
        "bodies": 100,
        "bare_steps_per_s": rate["bare"],
        "world_steps_per_s": rate["world"],
        "world_ratio": rate["world"] / rate["bare"],
        "target_ratio": TARGET,
        "process_steps_per_s": rate["process"],
        "process_ratio": rate["process"] / rate["bare"],
        "published_realtime_factor": rate["published"] * DT_S,
    }


class Contestant(Protocol):
    def live(self, periods: int) -> None: ...


class Ours:
    """The world with its teams played by a loop; without a home also without bus and journal."""

    def __init__(self, scene: Scene, home: Path | None) -> None:
        node: Any = Silent()
        if home is not None:
            node = open_node(NodeConfig("bench", "world", home=home), MemoryRouter().connect())
        self.world, self.now_s, self.step = World(node, scene), 0.0, 0
        self.movers = {
            w.team: [e.name for e in scene.entities if e.team == w.team and e.kind == "mover"] for w in scene.workspaces
        }

    def live(self, periods: int) -> None:
        for _ in range(periods):
            direction = ("up", "down")[self.step % 2]
            mail = []
            for number, (team, movers) in enumerate(self.movers.items()):
                body = Execute(team, self.step, tuple(SkillCall("move", (name, direction)) for name in movers))
                mail.append(Envelope(1, "bench", team, 1, number, f"{team}.{self.step}", self.now_s, body))
            self.world.handle(tuple(mail))
            self.now_s = self.world.next_s() or 0.0
            self.world.advance(self.now_s)
            self.step += 1


class Silent:
    """A node without a bus and a journal that forgets."""

    def __init__(self) -> None:
        self.name, self.run, self.incarnation = "world", "bench", 1
        self.journal = self.post = self.outbox = self

    def get(self, key: str) -> None:
        return None

    def put(self, key: str, value: bytes) -> None:
        pass

    @contextmanager
    def transaction(self) -> Iterator[None]:
        yield

    def emit(self, *words: object, **data: object) -> None:
        pass

    publish = status = reply = emit


class Bare:
    """Bodies in pymunk, and a loop that does nothing but drive some of them up and down."""

    def __init__(self, bodies: int, driven: int) -> None:
        self.space = pymunk.Space()
        self.drives: list[tuple[pymunk.Body, pymunk.PivotJoint]] = []
        for number in range(bodies):
            body = pymunk.Body(MASS_KG, float("inf"))
            body.position = (number % 10, 6 * (number // 10))
            shape = pymunk.Circle(body, 0.32)
            shape.filter = pymunk.ShapeFilter(categories=2, mask=2)
            control = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            joint = pymunk.PivotJoint(control, body, (0, 0), (0, 0))
            joint.max_bias, joint.max_force = 0.0, BRAKE_N
            self.space.add(body, shape, joint)
            self.drives.append((control, joint))
        del self.drives[driven:]
        self.up = True

    def live(self, periods: int) -> None:
        moving = round(MOVING * TICKS)
        speed = 1.0 / (moving * DT_S)
        for _ in range(periods):
            for control, joint in self.drives:
                control.velocity = (0.0, speed if self.up else -speed)
                joint.max_force = MASS_KG * speed / (RAMP * PERIOD_S)
            self._steps(moving)
            for control, _ in self.drives:
                control.velocity = (0.0, 0.0)
            self._steps(TICKS - moving)
            for _, joint in self.drives:
                joint.max_force = BRAKE_N
            self.up = not self.up

    def _steps(self, times: int) -> None:
        step = self.space.step
        for _ in range(times):
            step(DT_S)


def _scene(teams: int, movers: int, things: int, frame_hz: float) -> Scene:
    """Teams with so many movers, all driven, one carrier, and things on a line."""
    kinds = {
        "mover": Kind("m", "robot", "grid", "at", 0.32, MASS_KG, layer=1, attributes=("tool",)),
        "carrier": Kind("c", "robot", "grid", "at", 0.38, 40.0, layer=2, couples="holds"),
        "thing": Kind("", "object", "line", "line", 0.3, 5.0, layer=3, attributes=("state", "mark")),
    }
    spaces = tuple(Workspace(f"T{i + 1}", 5, 3, 5, 1) for i in range(teams))
    entities = []
    for team in (space.team for space in spaces):
        for i in range(movers):
            entities.append(Entity(f"{team}.m{i}", team, f"m{i}", "mover", f"({i + 1},1)", {"tool": 1}))
        entities.append(Entity(f"{team}.c1", team, "c1", "carrier", "(1,1)"))
        for i in range(things):
            entities.append(Entity(f"{team}.{i}", team, str(i), "thing", i + 6, {"state": 0, "mark": 0}))
    actions = {"move": Action("drive", ("robot", "direction"))}
    return Scene("bench", 1, PERIOD_S, DT_S, frame_hz, 2, kinds, actions, spaces, tuple(entities))


def main() -> None:
    figures = run()
    for name, words in (("bare", "bare pymunk"), ("world", "our world"), ("process", "with bus and journal")):
        rate = figures[f"{name}_steps_per_s"]
        ratio = f"   {figures[f'{name}_ratio']:.2f} of bare" if name != "bare" else ""
        target = f" (target {TARGET})" if name != "bare" else ""
        print(f"{words:22}{rate:9.0f} physics steps/s, {figures['bodies']} bodies{ratio}{target}")
    print(f"{'published size':22}{figures['published_realtime_factor']:9.0f} times real time")


if __name__ == "__main__":
    main()
