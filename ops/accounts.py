"""The recorder's accounts: which events of whom are written, which are missing, and how it gets them. No bus in here.

Events are numbered by their source from 1, per incarnation, and journalled there. A number that is skipped, or that a
sign of life mentions and nobody has seen, is asked for again, also from a source that was restarted meanwhile.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from bus.codec import Refusal, decode
from bus.messages import Beat, Envelope, Event, EventsAre, EventsFrom, Frame, Status
from bus.scene import Scene
from ops.recording import SourceCount, Summary, Writer, load

Ask = Callable[[str, EventsFrom], EventsAre | None]
"""Puts a question to a source and returns its answer, or None when none came in time."""

STREAM_OF = {Event: "event", Status: "status", Frame: "frame", Beat: "beat"}
MISSING_TOLD = 20
MOST_LIVES = 1000
"""Above that an incarnation is a date, of somebody who keeps no journal: there is nothing to ask about former lives."""


@dataclass
class Account:
    """The events of one source in one incarnation: all numbers up to `upto` are recorded, and those in `beyond`."""

    upto: int = 0
    beyond: set[int] = field(default_factory=set)
    known: int = 0
    received: int = 0
    sent: int = -1
    looked: int = -1

    def note(self, number: int) -> bool:
        """An event arrived; true when it is new."""
        self.received += 1
        self.known = max(self.known, number)
        if number <= self.upto or number in self.beyond:
            return False
        self.beyond.add(number)
        while self.upto + 1 in self.beyond:
            self.upto += 1
            self.beyond.discard(self.upto)
        return True

    @property
    def recorded(self) -> int:
        return self.upto + len(self.beyond)

    def missing(self) -> tuple[int, ...]:
        last = max(self.known, self.sent)
        return tuple(islice((n for n in range(self.upto + 1, last + 1) if n not in self.beyond), MISSING_TOLD))


class Recorder:
    """Takes messages in any order, with repetitions and gaps; writes each event once."""

    def __init__(self, run: str, writer: Writer, ask: Ask) -> None:
        self.run = run
        self.accounts: dict[tuple[str, int], Account] = {}
        self._writer = writer
        self._ask = ask
        self._closing = False

    def resume(self, directory: Path) -> None:
        """Go on after an earlier recorder of the same run: what it wrote counts as recorded."""
        for envelope in load(directory).events:
            self._account(envelope.src, envelope.inc).note(envelope.seq)

    def take(self, message: Envelope | Scene) -> None:
        """Write a message down, unless it is an event that is written already, or is said after the accounts are being
        closed: then a source's last word is its answer."""
        if not (self._closing and isinstance(message, Envelope) and self._late(message)):
            self._write(message)

    def _late(self, message: Envelope) -> bool:
        body, account = message.body, self._account(message.src, message.inc)
        return isinstance(body, Event) or (isinstance(body, Beat) and body.events > max(account.known, account.sent))

    def _write(self, message: Envelope | Scene) -> None:
        if isinstance(message, Scene):
            self._writer.add("scene", message)
            return
        body = message.body
        if isinstance(body, Event) and not self._account(message.src, message.inc).note(message.seq):
            return
        if isinstance(body, Beat):
            account = self._account(message.src, message.inc)
            account.known = max(account.known, body.events)
        stream = STREAM_OF.get(type(body))
        if stream is not None:
            self._writer.add(stream, message)

    def mend(self) -> None:
        """Ask for what was missing at the last look already; what is missing for the first time may be on its way.
        A source that does not answer is asked next time."""
        silent: set[str] = set()
        for (source, incarnation), account in sorted(self.accounts.items()):
            patient, account.looked = account.looked != account.upto, account.upto
            if patient or source in silent or not account.missing():
                continue
            if not self._fetch(source, incarnation, account):
                silent.add(source)

    @property
    def count(self) -> int:
        """Events written so far."""
        return sum(account.recorded for account in self.accounts.values())

    def finish(self, in_time: Callable[[], bool] = lambda: True, refused: int = 0) -> Summary:
        """Ask every source for its last number in each incarnation, fetch what is missing, write the summary.

        `in_time` says whether there is time for one more question; sources not asked count as unknown.
        """
        silent: set[str] = set()
        self._closing = True
        for account in self.accounts.values():
            account.sent = -1  # what it said in the middle of the run is not its last word
        for (source, incarnation), account in sorted(self.accounts.items()):
            if source in silent or not in_time():
                continue
            if not self._fetch(source, incarnation, account):
                silent.add(source)
        summary = self.summary(refused)
        self._writer.add("summary", summary)
        return summary

    def summary(self, refused: int = 0) -> Summary:
        counts = tuple(
            SourceCount(source, incarnation, a.sent, a.received, a.recorded, a.missing())
            for (source, incarnation), a in sorted(self.accounts.items())
            if a.known or a.sent > 0
        )
        return Summary(self.run, counts, refused)

    def _account(self, source: str, incarnation: int) -> Account:
        # A source in its third life had two before: their events are in its journal.
        for earlier in range(1, incarnation if incarnation <= MOST_LIVES else 1):
            self.accounts.setdefault((source, earlier), Account())
        return self.accounts.setdefault((source, incarnation), Account())

    def _fetch(self, source: str, incarnation: int, account: Account) -> bool:
        """Ask until nothing is missing or nothing new comes; false when the source did not answer."""
        while True:
            answer = self._ask(source, EventsFrom(incarnation, account.upto + 1))
            if answer is None:
                return False
            # A source without a journal forgets its former lives: then what it sent is not known.
            account.sent = answer.last if answer.last >= account.known else -1
            before = account.recorded
            for packed in answer.packed:
                envelope = decode(packed)
                if not isinstance(envelope, Refusal) and (envelope.src, envelope.inc) == (source, incarnation):
                    self._write(envelope)
            if not account.missing() or account.recorded == before:
                return True
