"""What the parts of an autonomous team's agent share: its place on the bus, its memory, its room, and who waits for
which reply."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

from msgspec.structs import replace

from agents.autonomous import helping, memory
from agents.autonomous.beliefs import believed, without
from agents.autonomous.thinking import Thinking
from agents.autonomous.ways import Ways
from agents.autonomous.words import words
from agents.setups import TeamSetup
from agents.thinker import Thinker
from bus import messages as m
from bus.messages import Envelope, State
from bus.node import Node
from reasoning import domain as domains
from reasoning import geometry
from reasoning.solver import parse

WORLD, COORDINATOR = "world", "coordinator"
BEAT_S = 0.3
T = TypeVar("T")


class Mind:
    """`memory` is what the team must not forget; it changes by `keep` alone. `unit_s` is the time of a unit, `delay`
    the units that a robot takes from room to room."""

    def __init__(self, node: Node, setup: TeamSetup, thinker: Thinker) -> None:
        self.node, self.setup, self.thinker = node, setup, thinker
        self.team = setup.team
        self.domain = domains.load(setup.domain)
        self.words = words(self.domain)
        self.memory = memory.load(node.journal)
        self.unit_s = self.domain.data.time["period_s"]
        self.delay = int(setup.static.get("delay", 0))
        self.furnish()
        self._pool = ThreadPoolExecutor(1)
        self._waiting: dict[str, Callable[[Envelope], None]] = {}

    # ------------------------------------------------------------ thinking
    def think(self, work: Callable[[], T], then: Callable[[T], None]) -> None:
        """Have `work` done and call `then` with its result; meanwhile the team shows that it lives."""
        if self.node.mode == "realtime":
            self.thinker.start(lambda _: work(), then)
        else:
            then(self.patiently(work))

    def patiently(self, work: Callable[[], T]) -> T:
        """The result of work that may take seconds. Time stands still for it, so nobody must take it for death: the
        work is done by a thread of its own, and this one gives signs of life."""
        future = self._pool.submit(work)
        while True:
            try:
                return future.result(BEAT_S)
            except TimeoutError:
                self.node.beat("thinking")

    # ------------------------------------------------------------ memory
    def keep(self, **changed: Any) -> None:
        """Write down what has changed, in the transaction under way if there is one."""
        self.memory = replace(self.memory, **changed)
        memory.save(self.node.journal, self.memory)

    def furnish(self) -> None:
        """What is known of the room: its constants with the present deadline, and broken robots, which stand in it like
        furniture."""
        names = self.domain.data.geometry
        self.static = dict(self.setup.static)
        until, key = self.memory.deadline, self.words.deadline_key(self.memory.state)
        if until >= 0:
            self.static.pop(key, None)
            self.static |= {key: until} if until else {}
        here, half_cm = self.words.here(self.memory.state), int(self.static[f"{names['radius']}(robot)"])
        for robot, (x_m, y_m) in self.memory.broken.items():
            x, y = round(100 * x_m), round(100 * y_m)
            corners = [(x + i * half_cm, y + j * half_cm) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            self.static[f"{names['solid']}({here},{robot})"] = f"({','.join(f'({a},{b})' for a, b in corners)})"
        self.thinking = Thinking(self.domain, self.team, self.words, self.static)
        self._ways: Ways | None = None

    def do_without(self, robots: set[str]) -> None:
        """These robots are broken, and stay where they are."""
        where = {robot: self.words.point(self.memory.state, robot) for robot in sorted(robots)}
        self.keep(broken={**self.memory.broken, **where}, state=without(self.memory.state, robots))
        self.furnish()

    def see(self, seen: State) -> State:
        """What is to be believed after a look."""
        room = geometry.room(self.domain, self.static, seen)
        now = self.memory
        here = {now.help.name} if now.help.phase in ("underway", "here") else set()
        hidden = {*now.broken} | {*now.gone} - here  # what is told of guests that are gone may be old
        return without(believed(self.words, room, now.state, seen), hidden)

    def wait(self, units: int) -> None:
        """Do nothing for so many units of time, then look."""
        until_s = self.node.now_s + units * self.unit_s
        self.keep(until_s=until_s, looked=False)
        self.node.wake_at(until_s)

    @property
    def ways(self) -> Ways:
        """Ways in the team's room; only after the first look."""
        if self._ways is None:
            room = geometry.room(self.domain, self.static, self.memory.state)
            assert room is not None, "a team that has not looked knows no room"
            time = self.domain.data.time
            self._ways = Ways(self.words, room, time["fast_m"], time["careful_m"])
        return self._ways

    # ------------------------------------------------------------ requests
    def request(self, to: str, body: m.Body, react: Callable[[Envelope], None], request_id: str = "") -> None:
        """Send a request whose reply goes to `react`; one that is under way already is not sent again."""
        if request_id not in self._waiting:
            self._waiting[self.node.request(to, body, request_id=request_id)] = react

    def forget(self, request_id: str) -> None:
        """Nobody waits for this reply any more."""
        if self._waiting.pop(request_id, None) is not None:
            self.node.forget(request_id)

    def under_way(self, prefix: str) -> list[str]:
        """The ids of unanswered requests that begin so."""
        return [request for request in self._waiting if request.startswith(prefix)]

    def hear(self, reply: Envelope) -> None:
        """Give a reply to who waits for it."""
        react = self._waiting.pop(reply.re, None)
        if react is not None:
            react(reply)

    # ------------------------------------------------------------ telling
    def emit(self, kind: str, text: str, /, **data: object) -> None:
        """Report an event of this team."""
        self.node.emit(kind, f"{self.team} {text}", team=self.team, **data)

    def show(self, doing: str) -> None:
        """Say what the team is doing, to people who watch."""
        now, plan = self.memory, self.memory.course
        ways = {}
        for call in now.begun.calls if now.begun is not None else ():
            if "way" in call.detail:
                points = (geometry.cell(point) for point in map(_text, parse(str(call.detail["way"]))[1]))
                ways[str(call.args[0])] = tuple((x / 1000, y / 1000) for x, y in points)
        self.node.status(
            m.Status(
                "team",
                doing,
                now.step,
                now.step - now.at,
                plan.steps if plan is not None else (),
                finished=now.resting,
                ways=ways,
                helping=said(now.help),
                elapsed=self.words.now(now.state) if now.state else -1,
                deadline=self.words.deadline(self.static, now.state) if now.state else 0,
            )
        )


def said(help_: helping.Help) -> str:
    """Help under way, in a few words for people."""
    wants, partner = "help" if help_.kind == "want" else "to help", help_.partner
    return {
        "none": "",
        "calling": f"asks for help {help_.about}" if help_.kind == "want" else "offers help",
        "confirming": f"confirms {partner}",
        "refused": "nobody can help now",
        "promised": f"has promised {partner} {wants}",
        "called": f"sends a robot to {partner}",
        "sending": f"sends {help_.name} to {partner}",
        "lent": f"{help_.name} helps {partner}",
        "recalling": f"calls {help_.name} home from {partner}",
        "homing": f"{help_.name} comes back from {partner}",
        "coming": f"expects a robot of {partner}",
        "underway": f"expects {help_.name} of {partner}",
        "here": f"{help_.name} of {partner} helps",
        "returning": f"sends {help_.name} back to {partner}",
    }[help_.phase]


def _text(term: object) -> str:
    return str(term)
