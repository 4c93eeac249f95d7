"""The world's main loop, as the clock drives it: windows, disturbances, frames, and the journal.

A window opens with the first `Execute` and lasts one period; in its first tenth, while nothing moves, other teams may
still join. At its end every team in it gets what its sensors show, and the state of the world is journalled with these
replies in one transaction. So after a crash either a step is over for everybody, or it never was and is executed again.
"""

from __future__ import annotations

import msgspec

from bus import keys
from bus.clock import ContactState
from bus.messages import Envelope, Execute, Executed, Inject, Observe, Observed, Ok, Order, Status
from bus.node import Node
from bus.scene import Scene
from world.disturbances import COORDINATOR, Disturbances
from world.faults import Faults, SavedFaults, physical
from world.frames import frame, membership
from world.herald import Herald
from world.motion import Motion
from world.sensors import sense
from world.truth import Thing, Truth
from world.window import Window, step_of

JOINING = 0.1
"""The share of a period in which a window waits for the other teams before it begins."""
SAVED = "world"
IDLE_FRAME_S = 1.0


class Saved(msgspec.Struct):
    """The world between two periods. `orders` are changes that the coordinator has not confirmed yet."""

    tick: int
    step: int
    things: list[Thing]
    faults: SavedFaults
    orders: list[Order]


class World:
    """Implements `bus.clock.Simulation`."""

    def __init__(self, node: Node, scene: Scene) -> None:
        self.node, self.scene = node, scene
        self.truth = Truth(scene)
        self.motion = Motion(self.truth)
        self.participants = (COORDINATOR, *(w.team for w in scene.workspaces))
        packed = node.journal.get(SAVED)
        self.recovered = packed is not None
        # What is said before the clock runs is said at the time at which it will begin to run.
        node.post.outbox.now = lambda: self.now_s
        saved, untold = SavedFaults(), []
        if packed is None:
            self.truth.begin()
        else:
            state = msgspec.msgpack.decode(packed, type=Saved)
            saved, untold = state.faults, state.orders
            self.truth.tick, self.truth.step = state.tick, state.step
            self.truth.restore(state.things)
            for thing in state.things:
                self.motion.travel(thing)
        self.faults = Faults(node, self.truth, saved, self.participants)
        self.disturbances = Disturbances(node, self.truth, self.faults, self._save)
        self.herald = Herald(node, COORDINATOR)
        self.window: Window | None = None
        self._commands: list[Envelope] = []
        self._waiting: list[Envelope] = []
        self._doing: dict[str, str] = {}
        self._frame_ticks = max(round(1 / (scene.frame_hz * scene.dt_s)), 1)
        self._frame_tick = -1
        text = "the world is back with its last complete step" if self.recovered else "the world is up"
        node.emit(
            "started", text, incarnation=node.incarnation, role="world", recovered=self.recovered, step=self.truth.step
        )
        self._tell_membership()
        for order in untold:
            self.disturbances.tell(order)
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
                    self._commands.append(message)
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
        ticks = [self.faults.next_tick(between=self.window is None)]
        if self.window is not None:
            ticks.append(self._window_tick(self.window))
        times = [tick * self.scene.dt_s for tick in ticks if tick is not None]
        return min(times, default=None)

    def advance(self, to_s: float) -> None:
        truth = self.truth
        # A hair more, so that a time that was made from ticks is not rounded down to the tick before.
        target = int(to_s / self.scene.dt_s + 1e-6)
        # While nothing moves, a frame a second is enough, and a single one after a leap.
        due = idle = max(target, self._frame_tick + round(IDLE_FRAME_S / self.scene.dt_s))
        while True:
            self.motion.run(truth.tick)
            self._serve()
            if truth.tick >= due and self._frame_tick != truth.tick:
                self._show_frame()
            if truth.tick >= target:
                break
            stops = [target, self.motion.next_tick(), self.faults.next_tick(between=self.window is None)]
            if self.window is not None:
                stops.append(self._window_tick(self.window))
            moving = self._moving()
            due = truth.tick - truth.tick % self._frame_ticks + self._frame_ticks if moving else idle
            stop = max(min(tick for tick in (*stops, due) if tick is not None), truth.tick + 1)
            if moving:
                truth.floor.step(stop - truth.tick)
            truth.tick = stop

    def on_contact(self, name: str, state: ContactState) -> None:
        """Somebody was lost from sight, or is back."""
        words = {"present": "is there", "lost_contact": "is out of contact", "back": "is back"}
        self.node.emit("contact", f"{name} {words[state]}", name=name, state=state)
        if name != COORDINATOR:
            self.herald.tell(name, state)

    # ------------------------------------------------------------ what is due now
    def _serve(self) -> None:
        """Everything that can happen at this tick, in a fixed order."""
        window = self.window
        if window is not None and window.begun and self.truth.tick >= self._window_tick(window):
            self._end(window)
        if self.faults.resume():
            self._save()
        between = self.window is None or not self.window.begun
        self.disturbances.of_script([*self.faults.at_time(between=between)])
        self._answer()
        self._gather()
        if self.window is not None and not self.window.begun and self.truth.tick >= self._window_tick(self.window):
            self._begin(self.window)

    def _window_tick(self, window: Window) -> int:
        """When the window begins, and then when it ends."""
        if window.begun:
            return window.opened + self.truth.period
        everybody = len(window.commands) == len(self.truth.layout.spaces)
        return window.opened + (0 if everybody else round(JOINING * self.truth.period))

    def _gather(self) -> None:
        """Let commands into the window, opening one if need be."""
        if self._commands and self.window is None:
            self.window = Window(self.truth.tick)
        if self.window is None or self.window.begun:
            return
        left: list[Envelope] = []
        for command in self._commands:
            if self.window.commands.setdefault(command.src, command) is not command:
                left.append(command)
        self._commands = left

    def _begin(self, window: Window) -> None:
        window.prepare(self.truth)
        actions = {f"{task.team}.{task.text}" for task in window.tasks}
        self.disturbances.of_script([*self.faults.at_step(window.step, actions)])
        window.begin(self.truth, self.motion)
        self._doing = window.doing()
        with self.node.journal.transaction():
            for team, command in window.commands.items():
                step, texts = step_of(command), [task.text for task in window.of[team]]
                text = f"{team} begins step {step}: {', '.join(texts) or 'nothing'}"
                self.node.emit("step_started", text, team=team, step=step, command=command.id, actions=texts)
        self.node.status(Status("world", f"step {window.step}", step=window.step))

    def _end(self, window: Window) -> None:
        node, truth = self.node, self.truth
        with node.journal.transaction():
            window.end(truth)
            for task in window.tasks:
                if task.failed:
                    step = step_of(window.commands[task.team])
                    text = f"{task.team}: {task.text} had no effect, {task.failed}"
                    node.emit("skill_failed", text, team=task.team, step=step, action=task.text, reason=task.failed)
            for team, command in window.commands.items():
                step, state = step_of(command), sense(truth, team)
                node.reply(command, Executed(team, step, state, window.findings(team)))  # type: ignore[arg-type]
                node.emit(
                    "step_ended", f"{team} ends step {step}", team=team, step=step, command=command.id, state=state
                )
            self._tell_membership()
            self.window, self._doing = None, {}
            self._save()
        self._show_frame()

    def _answer(self) -> None:
        """Look and disturb on request, unless that has to wait for the end of the period."""
        window, waiting = self.window, self._waiting
        self._waiting = []
        for message in waiting:
            body = message.body
            if isinstance(body, Observe):
                if window is not None and body.team in window.commands:
                    self._waiting.append(message)
                else:
                    self.node.reply(message, Observed(body.team, sense(self.truth, body.team)))
            elif isinstance(body, Inject):
                if physical(body.kind) and window is not None and window.begun:
                    self._waiting.append(message)
                else:
                    self.disturbances.asked_for(message, body)

    # ------------------------------------------------------------ what is kept and shown
    def _tell_membership(self) -> None:
        self.node.emit("membership", f"who is where after step {self.truth.step}", **membership(self.truth))

    def _save(self) -> None:
        truth = self.truth
        saved = Saved(truth.tick, truth.step, truth.save(), self.faults.saved, self.disturbances.untold)
        self.node.journal.put(SAVED, msgspec.msgpack.encode(saved))

    def _moving(self) -> bool:
        window, truth = self.window, self.truth
        return (window is not None and window.begun) or any(truth.travels(thing) for thing in truth.of("bench"))

    def _show_frame(self) -> None:
        self._frame_tick = self.truth.tick
        self.node.publish(keys.truth_frame(self.node.run), frame(self.truth, self._doing))
