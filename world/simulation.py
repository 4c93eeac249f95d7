"""The world's main loop, as the clock drives it: mail, disturbances, frames, and the journal.

How the teams' steps are carried out is a matter of *windows*: together (`world.common`), or each team's by itself
(`world.own`). Whatever they are, the state of the world is journalled with the answer to a step in one transaction.
"""

from __future__ import annotations

from typing import Protocol

import msgspec

from bus import keys
from bus.clock import ContactState
from bus.messages import Envelope, Execute, Inject, Observe, Observed, Ok, Status, Value
from bus.node import Node
from bus.scene import Scene
from world.common import Common
from world.context import Context
from world.disturbances import COORDINATOR, Disturbances, SavedOrders
from world.faults import Faults, SavedFaults, physical
from world.frames import Frames
from world.herald import Herald
from world.own import Own, SavedWindows
from world.sensors import sense
from world.things import Thing
from world.truth import Truth

SAVED = "world"
IDLE_FRAME_S = 1.0


class Bodies(msgspec.Struct):
    """The world as it was between two steps, or in the middle of steps that are saved as far as they have come."""

    tick: int
    step: int
    things: list[Thing]
    fluents: dict[str, dict[str, Value]]
    windows: SavedWindows


class Saved(msgspec.Struct):
    """The world as it was last: `bodies` are packed `Bodies`."""

    bodies: msgspec.Raw
    faults: SavedFaults
    orders: SavedOrders


class Windows(Protocol):
    """How the teams' steps are carried out. `doing` is what each robot is at, by its id."""

    doing: dict[str, str]

    @property
    def idle(self) -> bool:
        """No step is under way, nor about to be."""

    @property
    def between(self) -> bool:
        """Physical disturbances may happen now, and bodies be saved as they are."""

    @property
    def moving(self) -> bool:
        """Physics has something to do."""

    def busy(self, team: str) -> bool:
        """Looking has to wait for the end of the team's step."""

    def next_tick(self) -> int | None:
        """When there may be something to say."""

    def control_tick(self) -> int | None:
        """When `control` has something to do."""

    def take(self, command: Envelope) -> None:
        """An `Execute` has arrived."""

    def control(self) -> None:
        """Give the commands to drives that are due."""

    def close(self) -> None:
        """End the steps that are over."""

    def open(self) -> None:
        """Begin the steps that may begin."""

    def saved(self) -> SavedWindows:
        """What is under way and is to survive this process."""


class World:
    """Implements `bus.clock.Simulation`."""

    def __init__(self, node: Node, scene: Scene) -> None:
        self.node, self.scene = node, scene
        self.truth = Truth(scene)
        self.participants = (COORDINATOR, *(w.team for w in scene.workspaces))
        packed = node.journal.get(SAVED)
        self.recovered = packed is not None
        # What is said before the clock runs is said at the time at which it will begin to run.
        node.post.outbox.now = lambda: self.now_s
        saved, orders, under_way = SavedFaults(), SavedOrders(), SavedWindows()
        if packed is None:
            self.truth.begin()
        else:
            state = msgspec.msgpack.decode(packed, type=Saved)
            bodies = msgspec.msgpack.decode(state.bodies, type=Bodies)
            saved, orders, under_way = state.faults, state.orders, bodies.windows
            self.truth.tick, self.truth.step = bodies.tick, bodies.step
            self.truth.fluents.update(bodies.fluents)
            self.truth.restore(bodies.things)
        self.faults = Faults(node, self.truth, saved, self.participants)
        self.disturbances = Disturbances(node, self.truth, self.faults, orders, self._save)
        self.herald = Herald(node, COORDINATOR)
        self._context = Context(node, self.truth, self.faults, self.disturbances, self._save, self._show_frame)
        self._waiting: list[Envelope] = []
        self._frame_ticks = max(round(1 / (scene.frame_hz * scene.dt_s)), 1)
        self._frames, self._frame_tick = Frames(self.truth), -1
        self._bodies = msgspec.Raw()
        text = "the world is back with its last complete step" if self.recovered else "the world is up"
        node.emit(
            "started", text, incarnation=node.incarnation, role="world", recovered=self.recovered, step=self.truth.step
        )
        self.windows: Windows = Common(self._context) if scene.conducted else Own(self._context, under_way)
        self._context.tell_membership(self.truth.step)
        self.disturbances.tell()
        node.status(Status("world", "between two steps", step=self.truth.step))
        self._save()
        self._show_frame()

    @property
    def now_s(self) -> float:
        return self.truth.tick * self.scene.dt_s

    # ------------------------------------------------------------ the clock's side
    def handle(self, mail: tuple[Envelope, ...]) -> None:
        for message in mail:
            if message.re:
                self.disturbances.told(message.re)
                self.herald.told(message.re)
                continue
            match message.body:
                case Execute() if message.body.team == message.src and message.src in self.truth.layout.spaces:
                    self.windows.take(message)
                case Observe() if message.body.team == message.src and message.src in self.truth.layout.spaces:
                    self._waiting.append(message)
                case Inject():
                    self._waiting.append(message)
                case Execute() | Observe():
                    self.node.refuse(message, "not_yours")
                case _:
                    self.node.reply(message, Ok())
        self._serve()

    def next_s(self) -> float | None:
        ticks = [self.faults.next_tick(between=self.windows.idle), self.windows.next_tick()]
        times = [tick * self.scene.dt_s for tick in ticks if tick is not None]
        return min(times, default=None)

    def advance(self, to_s: float) -> None:
        truth = self.truth
        # A hair more, so that a time that was made from ticks is not rounded down to the tick before.
        target = int(to_s / self.scene.dt_s + 1e-6)
        # While nothing moves, a frame a second is enough, and a single one after a leap.
        due = idle = max(target, self._frame_tick + round(IDLE_FRAME_S / self.scene.dt_s))
        while True:
            still = False
            self.windows.control()
            self._serve()
            if truth.tick >= due and self._frame_tick != truth.tick:
                self._show_frame()
                still = True
            if truth.tick >= target:
                break
            stops = [target, self.windows.control_tick(), self.windows.next_tick()]
            stops.append(self.faults.next_tick(between=self.windows.idle))
            moving = self.windows.moving
            stop = max(min(tick for tick in stops if tick is not None), truth.tick + 1)
            due = truth.tick - truth.tick % self._frame_ticks + self._frame_ticks if moving else idle
            while due < stop:  # nothing but physics happens on the way
                self._pass(due, moving)
                self._show_frame(still=still)
                due, still = due + self._frame_ticks, True
            self._pass(stop, moving)

    def _pass(self, tick: int, moving: bool) -> None:
        """Let time pass until a tick, without anything happening in between."""
        if moving:
            self.truth.floor.step(tick - self.truth.tick)
        self.truth.tick = tick

    def on_contact(self, name: str, state: ContactState) -> None:
        """Somebody was lost from sight, or is back."""
        words = {"present": "there", "lost_contact": "out of contact", "back": "back", "stopped": "gone for good"}
        self.node.emit("contact", f"{name} is {words[state]}", name=name, state=state)
        if name != COORDINATOR:
            self.herald.tell(name, state)

    # ------------------------------------------------------------ what is due now
    def _serve(self) -> None:
        """Everything that can happen at this tick, in a fixed order."""
        self.windows.close()
        if self.faults.resume():
            self._save()
        self.disturbances.of_script([*self.faults.at_time(between=self.windows.between)])
        self._answer()
        self.windows.open()

    def _answer(self) -> None:
        """Look and disturb on request, unless that has to wait for the end of the period."""
        waiting, self._waiting = self._waiting, []
        for message in waiting:
            body = message.body
            if isinstance(body, Observe):
                if self.windows.busy(body.team):
                    self._waiting.append(message)
                else:
                    self.node.reply(message, Observed(body.team, sense(self.truth, body.team)))
            elif isinstance(body, Inject):
                if physical(body.kind) and not self.windows.between:
                    self._waiting.append(message)
                else:
                    self.disturbances.asked_for(message, body)

    # ------------------------------------------------------------ what is kept and shown
    def _save(self) -> None:
        """In the middle of a step that is not saved itself, bodies stay saved as they were before it: it will be
        carried out anew, and must not begin where it was half over."""
        truth = self.truth
        if self.windows.between:
            bodies = Bodies(truth.tick, truth.step, truth.save(), truth.fluents, self.windows.saved())
            self._bodies = msgspec.Raw(msgspec.msgpack.encode(bodies))
        saved = Saved(self._bodies, self.faults.saved, self.disturbances.orders)
        self.node.journal.put(SAVED, msgspec.msgpack.encode(saved))

    def _show_frame(self, *, still: bool = False) -> None:
        self._frame_tick = self.truth.tick
        self.node.publish(keys.truth_frame(self.node.run), self._frames.frame(self.windows.doing, still=still))
