"""The agents' side of the clock: turns, in the world's rounds (``fast``), in its pace (``realtime``), or as an
outsider.

A participant repeats `Join` until the world's `Ok` names the round from which it counts. When a `Tick` leaves it
out, or another life of the world ticks, it joins again. In ``fast`` mode, whoever enters throws away what
participants sent it before and asks again all that it had asked; the others, who see it enter, ask it again. So
both sides begin from the same place whatever was lost, at a moment that does not hang on the machine's load.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from math import inf

from bus import keys
from bus.clock import wall_s
from bus.codec import encode
from bus.messages import Body, Done, Envelope, Join, Tick
from bus.options import Mode
from bus.outbox import FAST_S
from bus.post import Post

JOIN_S = 0.25
COAST_S = 1.0
"""How long after the last `Tick` time is extrapolated in ``realtime``: without a world it stands still."""
Turns = Iterator[tuple[float, tuple[Envelope, ...]]]


class ClockError(Exception):
    """This process and the world were started with different clocks."""


class Participant:
    """One node's part in simulated time."""

    def __init__(self, post: Post, mode: Mode, *, outsider: bool) -> None:
        self._post, self._mode, self._outsider = post, mode, outsider
        self._tick = Tick(mode, 0, 0.0)
        self._tick_wall_s = self._join_wall_s = wall_s()
        self._latest_s = 0.0
        self._raw_tick = b""
        self._wakes: list[float] = []
        self._world = 0
        self._join: Envelope | None = None
        self._enters: int | None = None
        self._entered = False
        self._came: set[str] = set()
        self._handled = 0
        self._done: Done | None = None

    def now_s(self) -> float:
        """Simulated seconds: the last tick's, in ``realtime`` extrapolated from there."""
        if self._raw_tick:
            raw, self._raw_tick = self._raw_tick, b""
            envelope = self._post.inbox.open(raw, source=keys.WORLD)
            if envelope is not None and isinstance(envelope.body, Tick):
                if envelope.inc != self._world:
                    self._world, self._latest_s = envelope.inc, 0.0
                self._tick, self._tick_wall_s = envelope.body, wall_s()
        tick = self._tick
        if tick.mode == "fast" or not tick.round:
            return tick.now_s
        # Never backwards: the world may be slower than its factor says.
        self._latest_s = max(self._latest_s, tick.now_s + tick.factor * min(wall_s() - self._tick_wall_s, COAST_S))
        return self._latest_s

    def wake_at(self, at_s: float) -> None:
        """Have a turn at that simulated time, if not before."""
        heapq.heappush(self._wakes, at_s)

    def turns(self) -> Turns:
        """Time and mail, until the node is stopped."""
        self._listen()
        return self._rounds() if self._mode == "fast" and not self._outsider else self._as_it_comes()

    # ------------------------------------------------------------ rounds
    def _rounds(self) -> Turns:
        post, outbox = self._post, self._post.outbox
        while self._await_round():
            tick = self._tick
            post.await_mail(tick.mail.get(post.name, {}), tick.round - 1)
            outbox.round = tick.round
            outbox.in_round.clear()
            entering = not self._entered
            if entering:
                self._entered = True
                first = self._enters or 0
                post.held = [e for e in post.held if e.round >= first or not self._takes_part(e.src)]
                outbox.resend()
            else:
                self._ask_again(self._came | {name for name in post.reborn if not self._takes_part(name)})
            self._came.clear()
            post.reborn.clear()
            mail = post.take(tick.round)
            outbox.send_due()
            if self._due() or mail or entering:
                yield tick.now_s, mail
            post.report_refusals()
            self._handled = tick.round
            times = [at_s for at_s in (outbox.next_due_s(), *self._wakes[:1]) if at_s is not None]
            self._done = Done(tick.round, dict(outbox.in_round), min(times, default=-1.0))
            self._say_done(self._done)

    def _await_round(self) -> bool:
        """Wait for the next round that we take part in; False when the node is to stop."""
        nudged = False
        while not self._post.stopping.is_set():
            self._join_if_due()
            if self._enters is not None and self._tick.round >= self._enters and self._tick.round > self._handled:
                return True
            wanted = self._post.woken.is_set() or any(
                e.round < self._handled or not self._takes_part(e.src) for e in self._post.held
            )
            if wanted and self._entered and not nudged:
                # Only we know: the world may be waiting for somebody to want something.
                self._say_done(Done(self._handled, {}, self.now_s()))
                nudged = True
            self._post.outbox.send_due_on_wall()  # to outsiders, for whom simulated time means nothing
            self._post.wait(JOIN_S)
        return False

    def _say_done(self, done: Done) -> None:
        self._send(keys.done(self._post.run, self._post.name), done)

    # ------------------------------------------------------------ realtime, and outsiders in either mode
    def _as_it_comes(self) -> Turns:
        post, outbox = self._post, self._post.outbox
        while not post.stopping.is_set():
            self._join_if_due()
            self._ask_again(self._came | post.reborn)
            self._came.clear()
            post.reborn.clear()
            outbox.send_due()
            mail = post.take(None)
            entering = self._enters is not None and not self._entered
            self._entered = self._entered or entering
            if self._due() or mail or entering:
                yield self.now_s(), mail
                post.report_refusals()
            else:
                post.wait(self._pause_s())

    def _pause_s(self) -> float:
        """Wall seconds until the next thing to do that is known of."""
        pause_s, outbox = JOIN_S, self._post.outbox
        at_wall_s = outbox.next_due_wall_s()
        if at_wall_s is not None:
            pause_s = min(pause_s, at_wall_s - wall_s())
        for at_s in (outbox.next_due_s(), *self._wakes[:1]):
            if at_s is not None:
                realtime = self._tick.mode == "realtime"
                pause_s = min(pause_s, (at_s - self.now_s()) / self._tick.factor if realtime else 0.05)
        return max(pause_s, 0.001)

    # ------------------------------------------------------------ both
    def _due(self) -> bool:
        """Whether the owner wanted to be woken by now."""
        due = self._post.woken.is_set()
        self._post.woken.clear()
        now = self.now_s()
        while self._wakes and self._wakes[0] <= now:
            heapq.heappop(self._wakes)
            due = True
        return due

    def _ask_again(self, names: set[str]) -> None:
        for name in sorted(names):
            self._post.outbox.resend(name)

    def _takes_part(self, name: str) -> bool:
        return name == keys.WORLD or name in self._tick.participants

    def _listen(self) -> None:
        post = self._post
        post.outbox.now = self.now_s
        if self._outsider:
            # In fast mode there are thousands of ticks a second: look at one only when the time is asked for.
            post.transport.subscribe(keys.tick(post.run), lambda _, payload: setattr(self, "_raw_tick", payload))
        else:
            post.outbox.is_outsider = lambda name: not self._takes_part(name)
            post.outbox.longest_s = FAST_S if self._mode == "fast" else inf
            post.listen(keys.tick(post.run), self._on_tick, source=keys.WORLD)

    def _on_tick(self, envelope: Envelope) -> None:
        tick, before = envelope.body, self._tick
        if not isinstance(tick, Tick) or envelope.inc < self._world:
            return
        if tick.mode != self._mode:
            raise ClockError(f"the world's clock is {tick.mode}, this process was started with --clock {self._mode}")
        if envelope.inc > self._world:
            if self._world:
                self._came.add(keys.WORLD)
                self._latest_s = 0.0
                self._enters = self._join = None
            self._world = envelope.inc
        elif tick.round < before.round:
            return
        elif tick.round == self._handled and self._done is not None:
            self._say_done(self._done)  # the world has not got it
        elif before.round:
            self._came.update(name for name in tick.participants if name not in before.participants)
        if self._enters is not None and tick.round >= self._enters and self._post.name not in tick.participants:
            self._enters = self._join = None
        self._tick, self._tick_wall_s = tick, wall_s()

    def _join_if_due(self) -> None:
        """Ask to take part, again and again until the world has said from when."""
        if self._outsider or self._enters is not None:
            return
        wall, post = wall_s(), self._post
        if self._join is not None and wall - self._join_wall_s < JOIN_S:
            return
        self._join_wall_s = wall
        self._join = self._send(keys.join(post.run, post.name), Join(), self._join.id if self._join else "")
        post.catches[keys.WORLD, self._join.id] = self._on_ok

    def _on_ok(self, envelope: Envelope) -> None:
        if self._enters is None and envelope.inc >= self._world:
            self._world, self._enters, self._entered = envelope.inc, envelope.round, False

    def _send(self, key: str, body: Body, message_id: str = "") -> Envelope:
        envelope = self._post.outbox.seal(body, message_id=message_id)
        self._post.transport.put(key, encode(envelope))
        return envelope
