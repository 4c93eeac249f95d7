"""A whole system in one thread: real minds on real nodes over the in-memory twin, and a clock that goes on by itself
when nobody has anything to do. Any process can be killed before any of its writes and sends.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Mapping
from functools import wraps
from itertools import permutations
from pathlib import Path
from typing import Any, Protocol

from agents import setups
from agents.coordinator import Coordinator
from agents.team import Team
from agents.thinker import Thinker
from bus.codec import decode
from bus.memory_transport import MemoryRouter
from bus.messages import Body, Envelope, Event, Ok, Order, RunOver, State
from bus.node import Node, NodeConfig, open_node
from tests.agents.rooms import DELAY, DOMAIN, STATIC, World

TURN_S = 0.5
PATIENCE_S = 400.0


class Killed(BaseException):
    """A process ends here, whatever it was about to do."""


class Mind(Protocol):
    def turn(self, mail: tuple[Envelope, ...]) -> None: ...


class Process:
    """One process of a `System`. `left` counts down its writes and sends to its death (None: it lives on)."""

    def __init__(self, system: System, name: str, make: Callable[[Node], Mind]) -> None:
        self.name = name
        self.left: int | None = None
        self.operations = self.lives = 0
        self.node: Node | None = None
        self.asleep = False
        self.mind: Any = None
        self._system, self._make = system, make

    def live(self) -> None:
        system = self._system
        self.lives += 1
        config = NodeConfig(system.run, self.name, home=system.home)
        node = self.node = open_node(config, system.router.connect())
        node.post.outbox.now = lambda: system.now_s
        node.post.outbox.is_outsider = lambda name: False
        for thing, names in ((node.journal, ("put", "add_event", "remember_reply")), (node.transport, ("put",))):
            for name in names:
                setattr(thing, name, self._counted(getattr(thing, name)))
        self.mind = self._make(node)

    def _counted(self, function: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(function)
        def counted(*args: Any, **options: Any) -> Any:
            self.operations += 1
            if self.left is not None:
                self.left -= 1
                if self.left < 0:
                    self.left = None
                    raise Killed
            return function(*args, **options)

        return counted

    def die(self) -> None:
        assert self.node is not None
        self.node.transport.close()
        self.node.journal.close()
        self.node = self.mind = None

    def turn(self) -> bool:
        """Handle what has arrived; whether there was anything."""
        if self.asleep:
            return False
        try:
            if self.node is None:
                self.live()
                return True
            post = self.node.post
            post.inbox.pump(0)
            for name in sorted(post.reborn):
                post.outbox.resend(name)
            post.reborn.clear()
            post.outbox.send_due()
            mail = post.take(None)
            if mail:
                self.mind.turn(mail)
            return bool(mail)
        except Killed:
            self.die()
            return True

    def poke(self) -> None:
        """A turn without mail: time has passed."""
        try:
            self.mind.turn(())
        except Killed:
            self.die()


class Supervisor:
    def __init__(self, node: Node) -> None:
        self.node = node
        self.over: RunOver | None = None

    def turn(self, mail: tuple[Envelope, ...]) -> None:
        for envelope in mail:
            if isinstance(envelope.body, RunOver):
                self.over = envelope.body
            self.node.reply(envelope, Ok())


class Puppet:
    """Somebody whom the test speaks for."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.mail: list[Envelope] = []

    def turn(self, mail: tuple[Envelope, ...]) -> None:
        self.mail += mail

    def take(self, kind: type[Body]) -> Envelope:
        """The one message of this kind that has come since."""
        (found,) = [e for e in self.mail if isinstance(e.body, kind)]
        self.mail.remove(found)
        return found


class System:
    """Coordinator, teams, a made-up world and somebody to hear the last word. Events are collected as they are sent.
    The `puppets` among them are played by the test. With `robots`, by kind, sharing is general."""

    def __init__(
        self,
        home: Path,
        rooms: Mapping[str, State],
        plan: setups.GivenPlan | None = None,
        puppets: tuple[str, ...] = (),
        robots: Mapping[str, int] | None = None,
    ) -> None:
        self.home, self.run = home, "test"
        self.router = MemoryRouter(seed=1)
        self.now_s = 0.0
        self.events: list[tuple[str, Event]] = []
        self.router.connect().subscribe("muster/test/event/*", self._hear)
        shared = dict(robots or {})
        delays = tuple((giver, taker, DELAY) for giver, taker in permutations(rooms, 2)) if shared else ()
        setup = setups.CoordinatorSetup(tuple(rooms), DELAY, plan, delays=delays, robots=shared)
        static = STATIC | ({"sharing": "general"} if shared else {})
        makers: dict[str, Callable[[Node], Mind]] = {
            "supervisor": Supervisor,
            "world": lambda node: World(node, rooms),
            "coordinator": lambda node: Coordinator(node, setup),
        }
        for name in rooms:
            made = setups.TeamSetup(DOMAIN, name, static, guests=shared)
            makers[name] = lambda node, made=made: Team(node, made, Thinker(node, threaded=False))
        makers |= dict.fromkeys(puppets, Puppet)
        self.processes = {name: Process(self, name, make) for name, make in makers.items()}
        for name in ("supervisor", "world", *puppets):
            self.processes[name].live()
        self.world: World = self.processes["world"].mind

    def _hear(self, key: str, payload: bytes) -> None:
        envelope = decode(payload)
        assert isinstance(envelope, Envelope)
        assert isinstance(envelope.body, Event)
        self.events.append((envelope.src, envelope.body))

    def __getitem__(self, name: str) -> Process:
        return self.processes[name]

    @property
    def coordinator(self) -> Coordinator:
        mind = self.processes["coordinator"].mind
        assert isinstance(mind, Coordinator)
        return mind

    def puppet(self, name: str) -> Puppet:
        mind = self.processes[name].mind
        assert isinstance(mind, Puppet)
        return mind

    def send(self, name: str, to: str, body: Body) -> str:
        """A puppet asks for something."""
        return self.puppet(name).node.request(to, body)

    def restart(self, name: str) -> None:
        """Kill a process between two turns; it comes back at once."""
        self.processes[name].die()
        self.processes[name].live()

    @property
    def over(self) -> RunOver | None:
        return self.processes["supervisor"].mind.over

    def said(self, kind: str) -> list[dict[str, object]]:
        return [event.data for _, event in self.events if event.kind == kind]

    def contact(self, name: str, state: Any) -> None:
        """The world tells the coordinator; who is out of contact does nothing meanwhile."""
        self.processes[name].asleep = state == "lost_contact"
        self.world.herald.tell(name, state)

    def grow(self, team: str, box: int, place: int) -> None:
        """A new object enters a team's line, and the coordinator is told."""
        now = self.world.floors[team]
        now.line[box], now.stage[box] = place, 0
        node = self.processes["world"].node
        assert node is not None
        node.request("coordinator", Order(team, (str(box),)))

    def tick(self) -> None:
        """A turn for everybody; time goes on when there was nothing to do."""
        busy = [process.turn() for process in self.processes.values()]
        if not any(busy):
            self.now_s += TURN_S
            self.router.flush()

    def until(self, condition: Callable[[], Any], limit_s: float = PATIENCE_S) -> None:
        turns = 0
        while not condition():
            turns += 1
            assert self.now_s < limit_s, f"not within {limit_s} s: {self.story()}"
            assert turns < 5000, f"it goes in circles: {self.story()}"
            self.tick()

    def end(self) -> RunOver:
        """Go on until the last word, and see that everything is as it should be."""
        self.until(lambda: self.over)
        assert self.over is not None
        if self.over.goal:
            assert self.world.finished(), self.story()
        twice = [where for where, times in self.world.done.items() if times > 1]
        assert not twice, f"{twice} was carried out twice"
        places = Counter([*self.world.built.values(), *self.world.bench])
        assert set(places.values()) <= {1}
        return self.over

    def story(self) -> str:
        return "\n".join(f"{source}: {e.kind} {json.dumps(e.data, default=str)}" for source, e in self.events)

    def close(self) -> None:
        for process in self.processes.values():
            if process.node is not None:
                process.die()
