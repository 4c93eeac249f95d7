"""What is sent: numbered, impaired when asked to be, requests repeated until they are answered."""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Callable
from math import inf

import msgspec
from msgspec import Raw
from msgspec.structs import replace

from bus import keys
from bus.clock import wall_s
from bus.codec import encode
from bus.impair import Impairments
from bus.messages import SCHEMA_VERSION, Body, Envelope
from bus.transport import Transport

SLOWEST = 8.0
"""Repetitions slow down to one in so many times the first pause."""
FAST_S = 2.0
"""But in ``fast`` mode to one in so many simulated seconds: time waits for who thinks, so only what is lost goes
unanswered for longer than its work takes, and a step's reply should not wait for the next try as long as the step."""


class _Pending(msgspec.Struct):
    """A request without an answer, and when it is to be repeated on either clock; the receiver decides which counts."""

    to: str
    envelope: Envelope
    pause_s: float
    first_s: float
    since_wall_s: float
    due_s: float
    due_wall_s: float


class Outbox:
    """One per node, used by the node's thread.

    `now` reads simulated time. `is_outsider` says who takes no part in it: requests to them are repeated on the wall.
    """

    def __init__(self, run: str, name: str, incarnation: int, transport: Transport) -> None:
        self.now: Callable[[], float] = lambda: 0.0
        self.is_outsider: Callable[[str], bool] = lambda name: True
        self.round = 0
        self.total = 0
        self.repeated = 0
        self.in_round: Counter[str] = Counter()
        """Mail sent in this round, by receiver."""
        self.longest_s = inf
        """No repetition waits for longer."""
        self.impairments = Impairments()
        self._run, self._name, self._incarnation = run, name, incarnation
        self._transport = transport
        self._seq = 0
        self._requests = 0
        self._pending: dict[str, _Pending] = {}
        self._late: list[tuple[float, int, str, Envelope]] = []

    def seal(self, body: Body | Raw, *, re: str = "", message_id: str = "", seq: int = 0) -> Envelope:
        """Put a body into an envelope of its own; `seq` is given for what is numbered apart from the rest."""
        number = seq or self._next()
        return Envelope(
            v=SCHEMA_VERSION,
            run=self._run,
            src=self._name,
            inc=self._incarnation,
            seq=number,
            id=message_id or f"{self._name}.{self._incarnation}.s{number}",
            at_s=self.now(),
            body=body,  # type: ignore[arg-type]
            re=re,
            round=self.round,
        )

    def mail(self, to: str, envelope: Envelope) -> None:
        """Send mail as the impairments allow."""
        fate = self.impairments.fate(to, envelope.id)
        for _ in range(fate.now):
            self._post(to, envelope)
        for _ in range(fate.later):
            heapq.heappush(self._late, (self.now() + fate.late_s, self._next(), to, envelope))

    def again(self, to: str, envelope: Envelope) -> None:
        """Send mail once more: same id, another number, from the present incarnation."""
        self.repeated += 1
        fresh = replace(envelope, inc=self._incarnation, seq=self._next(), round=self.round, at_s=self.now())
        self.mail(to, fresh)

    def request(self, to: str, body: Body, retry_s: float, request_id: str = "") -> str:
        """Send a request and repeat it every `retry_s` seconds, more and more slowly, until `settle` or `forget`."""
        envelope = self.seal(body, message_id=request_id or self.request_id())
        wall = wall_s()
        self._pending[envelope.id] = _Pending(
            to, envelope, retry_s, retry_s, wall, self.now() + retry_s, wall + retry_s
        )
        self.mail(to, envelope)
        return envelope.id

    def request_id(self) -> str:
        """A new id. Requests are counted apart from everything else, which may hang on the wall's clock: ids are
        recorded, and must be the same when a run is repeated."""
        self._requests += 1
        return f"{self._name}.{self._incarnation}.{self._requests}"

    def settle(self, source: str, request_id: str) -> float | None:
        """An answer has come: wall seconds since the request, or None if nobody waits for it from there."""
        pending = self._pending.get(request_id)
        if pending is None or pending.to != source:
            return None
        del self._pending[request_id]
        return wall_s() - pending.since_wall_s

    def forget(self, request_id: str) -> None:
        """Wait no longer for an answer."""
        self._pending.pop(request_id, None)

    def resend(self, to: str | None = None) -> None:
        """Send all unanswered requests to `to` (None: to anybody) again, now, and begin with the short pauses
        again."""
        for pending in self._pending.values():
            if to is None or pending.to == to:
                pending.pause_s = pending.first_s
                self._repeat(pending)

    def send_due(self) -> None:
        """Send what has been waiting for its time: late mail and repetitions."""
        now = self.now()
        while self._late and self._late[0][0] <= now:
            _, _, to, envelope = heapq.heappop(self._late)
            self._post(to, replace(envelope, seq=self._next(), round=self.round))
        self._repeat_if(lambda pending: not self.is_outsider(pending.to) and now >= pending.due_s)
        self.send_due_on_wall()

    def send_due_on_wall(self) -> None:
        """Send only the repetitions for outsiders."""
        if self._pending:
            wall = wall_s()
            self._repeat_if(lambda pending: self.is_outsider(pending.to) and wall >= pending.due_wall_s)

    def _repeat_if(self, due: Callable[[_Pending], bool]) -> None:
        for pending in [pending for pending in self._pending.values() if due(pending)]:
            slower = min(2.0 * pending.pause_s, SLOWEST * pending.first_s, self.longest_s)
            pending.pause_s = max(slower, pending.first_s)
            self._repeat(pending)

    def next_due_s(self) -> float | None:
        """The simulated time at which `send_due` has something to do, None if never."""
        times = [pending.due_s for pending in self._pending.values() if not self.is_outsider(pending.to)]
        if self._late:
            times.append(self._late[0][0])
        return min(times, default=None)

    def next_due_wall_s(self) -> float | None:
        """The same on the wall's clock, for outsiders."""
        return min((p.due_wall_s for p in self._pending.values() if self.is_outsider(p.to)), default=None)

    def _repeat(self, pending: _Pending) -> None:
        pending.due_s = self.now() + pending.pause_s
        pending.due_wall_s = wall_s() + pending.pause_s
        self.again(pending.to, pending.envelope)

    def _post(self, to: str, envelope: Envelope) -> None:
        self.total += 1
        self.in_round[to] += 1
        self._transport.put(keys.mail(self._run, to, self._name), encode(envelope))

    def _next(self) -> int:
        self._seq += 1
        return self._seq
