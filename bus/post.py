"""What a node does with mail: exactly once to the owner, answered again to those who ask again, events kept for
those who missed them, and signs of life. `bus.node.Node` is the face of it; the clock's two sides work on it
directly.
"""

from __future__ import annotations

import os
import threading
from collections import Counter
from collections.abc import Callable, Iterable

from bus import keys
from bus.clock import wall_s
from bus.codec import MAX_BYTES, Refusal, decode, decode_as, encode
from bus.events import KINDS
from bus.inbox import Inbox
from bus.journal import Journal
from bus.messages import Beat, Body, Envelope, Event, EventsAre, EventsFrom, Impair, Ok, Ping
from bus.outbox import Outbox
from bus.transport import Transport

BEAT_S = 0.4
MAIL_S = 2.0
REFUSED_S = 1.0
EVENTS_AT_ONCE = 200
LINK = "link to "
"""How the keys of impaired links begin in the journal."""


class Post:
    """One per node, used by the node's thread, except `stop` and `wake`."""

    def __init__(self, run: str, name: str, transport: Transport, journal: Journal) -> None:
        self.run, self.name = run, name
        self.transport, self.journal = transport, journal
        self.inbox = Inbox(run)
        self.outbox = Outbox(run, name, journal.incarnation, transport)
        self.stopping = threading.Event()
        self.woken = threading.Event()
        self.held: list[Envelope] = []
        """Mail that no turn has shown yet."""
        self.catches: dict[tuple[str, str], Callable[[Envelope], None]] = {}
        """Who waits for a reply that is not for a turn, by who was asked and the request's id."""
        self.expected: list[str] = []
        """Who is bound to come back, for the world's clock."""
        self.given_up: list[str] = []
        """Who will never come back."""
        self.reborn: set[str] = set()
        """Who was seen in a new life: the former one may have taken our requests to the grave."""
        self._in_work: set[tuple[str, str]] = set()
        self._lives: dict[str, int] = {}
        self._doing = "starting"
        self._latency_ms = 0.0
        self._events = self._received = 0
        self._beat_wall_s = self._refused_wall_s = 0.0
        self._refused_told: dict[str, int] = {}
        for _, packed in journal.items(LINK):  # a bad link stays bad when its process dies
            impair = decode_as(packed, Impair)
            if isinstance(impair, Impair):
                self.outbox.impairments.set(impair)
        transport.subscribe(keys.mail(run, name, "*"), self.inbox.into(self._on_mail))
        transport.present(keys.live(run, name))

    # ------------------------------------------------------------ from any thread
    def stop(self) -> None:
        self.stopping.set()
        self.inbox.wake()

    def wake(self) -> None:
        self.woken.set()
        self.inbox.wake()

    # ------------------------------------------------------------ waiting
    def wait(self, timeout_s: float) -> bool:
        """Handle what arrives within `timeout_s` wall seconds, at most a beat's pause. True when something came."""
        self.beat_if_due()
        return self.inbox.pump(min(max(timeout_s, 0.0), BEAT_S))

    def listen(self, keyexpr: str, handler: Callable[[Envelope], None], *, source: str = "") -> None:
        """Have `handler` called with every envelope from `source`, or from whom the last part of the key names."""

        def check(key: str, payload: bytes) -> None:
            envelope = self.inbox.open(payload, source=source or keys.last(key))
            if envelope is not None:
                handler(envelope)

        self.transport.subscribe(keyexpr, self.inbox.into(check))

    # ------------------------------------------------------------ mail
    def _on_mail(self, key: str, payload: bytes) -> None:
        envelope = self.inbox.open(payload, source=keys.last(key))
        if envelope is None:
            return
        self._received += 1
        known, self._lives[envelope.src] = self._lives.get(envelope.src, envelope.inc), envelope.inc
        if envelope.inc > known:
            self.reborn.add(envelope.src)
        catch = self.catches.get((envelope.src, envelope.re)) if envelope.re else None
        if catch is not None:
            catch(envelope)
        elif isinstance(envelope.body, Ping | EventsFrom) and not envelope.re and self.outbox.is_outsider(envelope.src):
            self.accept(envelope)  # at once; what a participant asks has its place in the order of things
        else:
            self.held.append(envelope)

    def take(self, before_round: int | None) -> tuple[Envelope, ...]:
        """Take the held mail of outsiders and of earlier rounds (None: all), in the order (source, life, number), for
        a turn. Left out is what the owner need not see."""
        taken: list[Envelope] = []
        kept: list[Envelope] = []
        for e in self.held:
            due = before_round is None or e.round < before_round or self.outbox.is_outsider(e.src)
            (taken if due else kept).append(e)
        self.held = kept
        taken.sort(key=lambda e: (e.src, e.inc, e.seq))
        return tuple(e for e in taken if self.accept(e))

    def await_mail(self, announced: dict[str, int], sent_in_round: int) -> None:
        """Wait until so many messages of each source are there; some wall seconds at most: what was lost will be
        repeated by its sender."""
        end_wall_s = wall_s() + MAIL_S
        while announced and not self.stopping.is_set():
            there = Counter(e.src for e in self.held if e.round == sent_in_round)
            if all(there[source] >= count for source, count in announced.items()) or wall_s() > end_wall_s:
                return
            self.wait(end_wall_s - wall_s())

    def accept(self, envelope: Envelope) -> bool:
        """Whether the owner is to see the message; handles those that it is not to see."""
        if envelope.re:
            waited_s = self.outbox.settle(envelope.src, envelope.re)
            if waited_s is None:
                return False
            self._latency_ms += 0.1 * (1000.0 * waited_s - self._latency_ms)
            return True
        body = envelope.body
        if isinstance(body, Impair) and envelope.src == keys.WORLD:
            self.journal.put(LINK + body.to, encode(body))
            self.answer(envelope, Ok())
            self.outbox.impairments.set(body)
        elif isinstance(body, Impair):
            self.refuse(envelope, "not_yours")
        elif isinstance(body, Ping):
            self.answer(envelope, Ok())
        elif isinstance(body, EventsFrom):
            self.answer(envelope, self._events_from(body))
            self.beat_now()  # who settles accounts wants the latest figures, too
        elif (envelope.src, envelope.id) not in self._in_work:
            packed = self.journal.reply_to(envelope.src, envelope.id)
            if packed is None:
                self._in_work.add((envelope.src, envelope.id))
                return True
            given = decode(packed)
            if not isinstance(given, Refusal):
                self.outbox.again(envelope.src, given)
        return False

    def answer(self, request: Envelope, body: Body) -> None:
        """Reply without remembering it: for what may be asked any number of times."""
        self.outbox.mail(request.src, self._reply_to(request, body))

    def reply(self, request: Envelope, body: Body) -> None:
        """Reply, remembered before it is sent."""
        reply = self._reply_to(request, body)
        self.journal.remember_reply(request.src, request.id, encode(reply))

        def send() -> None:
            self._in_work.discard((request.src, request.id))
            self.outbox.mail(request.src, reply)

        self.journal.afterwards(send)

    def refuse(self, request: Envelope, reason: str) -> None:
        """Count it, answer it, forget it."""
        self.inbox.refuse(reason)
        self._in_work.discard((request.src, request.id))
        self.answer(request, Ok())

    def _reply_to(self, request: Envelope, body: Body) -> Envelope:
        return self.outbox.seal(body, re=request.id, message_id=f"re.{request.id}")

    # ------------------------------------------------------------ events, signs of life
    def emit(self, kind: str, text: str, data: dict[str, object]) -> None:
        if kind not in KINDS:
            raise ValueError(f"no kind of event is called {kind!r}; bus.events has the list")
        with self.journal.transaction():
            number = self.journal.last_event(self.journal.incarnation) + 1
            name = f"{self.name}.{self.journal.incarnation}.e{number}"
            packed = encode(self.outbox.seal(Event(kind, {"text": text, **data}), message_id=name, seq=number))
            self.journal.add_event(number, packed)
            self.journal.afterwards(lambda: self.transport.put(keys.event(self.run, self.name), packed))
        self._events = number

    def _events_from(self, body: EventsFrom) -> EventsAre:
        packed = self.journal.events(body.incarnation, body.first, EVENTS_AT_ONCE)
        return EventsAre(body.incarnation, self.journal.last_event(body.incarnation), tuple(_fitting(packed)))

    def beat(self, doing: str) -> None:
        self._doing = doing[:200]
        self.beat_if_due()

    def beat_if_due(self) -> None:
        if wall_s() - self._beat_wall_s >= BEAT_S:
            self.beat_now()

    def beat_now(self) -> None:
        """Show a sign of life with the latest figures."""
        self._beat_wall_s = wall_s()
        inbox, outbox = self.inbox, self.outbox
        beat = Beat(
            pid=os.getpid(),
            sent=outbox.total,
            received=self._received,
            refused=inbox.refused.total(),
            repeated=outbox.repeated,
            events=self._events,
            latency_ms=self._latency_ms,
            doing=self._doing,
        )
        self.transport.put(keys.beat(self.run, self.name), encode(outbox.seal(beat)), droppable=True)

    def report_refusals(self) -> None:
        """One event for each reason with new refusals, at most once a second."""
        if (
            self.inbox.refused.total() == sum(self._refused_told.values())
            or wall_s() - self._refused_wall_s < REFUSED_S
        ):
            return
        self._refused_wall_s = wall_s()
        counts = dict(self.inbox.refused)
        for reason, count in sorted(counts.items()):
            fresh = count - self._refused_told.get(reason, 0)
            if fresh:
                text = f"refused {fresh} of the messages received: {reason}"
                self.emit("refused", text, {"reason": reason, "count": fresh})
        self._refused_told = counts


def _fitting(packed: Iterable[bytes]) -> Iterable[bytes]:
    """As many as fit into one message, and one at least."""
    size = 0
    for event in packed:
        if size and size + len(event) > MAX_BYTES // 2:
            return
        size += len(event) + 8
        yield event
