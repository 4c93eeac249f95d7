"""What a process must not lose when it is killed: a small SQLite file per process, HOME/NAME.sqlite.

Write-ahead logging with synchronous=NORMAL: a commit survives the death of the process at any moment. (It may be
lost when the machine loses power, but then the whole run is lost.) Without a path everything is in memory.

Tables: `entries` for the owner's keys and values, `replies` that were given, in their order, `events` that were
reported, by incarnation and number in one. Replies and events are only appended, at the end of a tree ordered by one
whole number, which takes a third of what other orders take; which reply is whose is known in memory.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

REPLIES_KEPT = 2000
"""Replies remembered per requester: far more than anybody has unanswered at a time."""
LET_GO = 256
"""So many of the oldest are let go at once."""
LIFE = 1 << 22
"""More events than any process reports in one life."""

TABLES = """
create table if not exists entries (key text primary key, value blob not null) without rowid;
create table if not exists replies (number integer primary key, requester text, request text, packed blob not null);
create table if not exists events (id integer primary key, packed blob not null);
create table if not exists lives (incarnation integer primary key);
"""


class Journal:
    """One per process, used by one thread at a time. Opening it begins a new incarnation."""

    def __init__(self, path: Path | None = None, *, patience_s: float = 5.0) -> None:
        """Open or create the journal, waiting up to `patience_s` for a former life that is still ending.

        Raises sqlite3.Error when the file cannot be used, also because another process lives on it.
        """
        self._db = sqlite3.connect(
            path or ":memory:", timeout=patience_s, isolation_level=None, check_same_thread=False
        )
        # Exclusive: no other process has business here while this one lives, and a commit needs no file locks.
        self._db.execute("pragma locking_mode=exclusive")
        self._db.execute("pragma journal_mode=wal")
        self._db.execute("pragma synchronous=normal")
        self._db.executescript(TABLES)
        self._depth = 0
        self._afterwards: list[Callable[[], None]] = []
        self._db.execute("insert into lives select coalesce(max(incarnation), 0) + 1 from lives")
        self.incarnation: int = self._db.execute("select max(incarnation) from lives").fetchone()[0]
        """1 for the first life of the process, then one more each time."""
        self._last_event = (self.incarnation, 0)
        # The numbers of replies by requester and request, the oldest first. It may hold more than there is, not less.
        self._given: dict[str, dict[str, int]] = {}
        self._replies = 0
        order = "select requester, request, number from replies order by number"
        for requester, request, number in self._db.execute(order):
            self._given.setdefault(requester, {})[request] = self._replies = number

    def close(self) -> None:
        """Close the file; safe to repeat."""
        self._db.close()

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """All of the block is kept, or, if it raises, nothing. May be nested: the outermost one decides."""
        if self._depth == 0:
            self._db.execute("begin immediate")
        self._depth += 1
        try:
            yield
        except BaseException:
            self._depth -= 1
            if self._depth == 0:
                self._db.execute("rollback")
                self._last_event = (-1, 0)
                self._afterwards.clear()
            raise
        self._depth -= 1
        if self._depth == 0:
            self._db.execute("commit")
            todo, self._afterwards = self._afterwards, []
            for action in todo:
                action()

    def afterwards(self, action: Callable[[], None]) -> None:
        """Do it when the current transaction is kept; never if it is not; now if there is none."""
        if self._depth:
            self._afterwards.append(action)
        else:
            action()

    def get(self, key: str) -> bytes | None:
        """The value of `key`, None if it has none."""
        row = self._db.execute("select value from entries where key = ?", (key,)).fetchone()
        return row[0] if row else None

    def put(self, key: str, value: bytes) -> None:
        """Set the value of `key`."""
        self._db.execute(
            "insert into entries values (?, ?) on conflict (key) do update set value = excluded.value", (key, value)
        )

    def delete(self, key: str) -> None:
        """Forget `key`, if it is there."""
        self._db.execute("delete from entries where key = ?", (key,))

    def items(self, prefix: str = "") -> list[tuple[str, bytes]]:
        """Keys that start with `prefix`, sorted, with their values."""
        rows = self._db.execute("select key, value from entries where key >= ? order by key", (prefix,))
        return [(key, value) for key, value in rows if key.startswith(prefix)]

    def reply_to(self, requester: str, request: str) -> bytes | None:
        """The reply that was given to a requester's request of this id."""
        number = self._given.get(requester, {}).get(request)
        if number is None:
            return None
        row = self._db.execute("select packed from replies where number = ?", (number,)).fetchone()
        return row[0] if row else None

    def remember_reply(self, requester: str, request: str, packed: bytes) -> None:
        """Keep a reply; the oldest replies to the same requester are let go.

        Raises ValueError when there is one already.
        """
        if self.reply_to(requester, request) is not None:
            raise ValueError(f"{request!r} of {requester!r} was answered before")
        given = self._given.setdefault(requester, {})
        self._replies += 1
        given[request] = self._replies
        self._db.execute("insert into replies values (?, ?, ?, ?)", (self._replies, requester, request, packed))
        if len(given) >= REPLIES_KEPT + LET_GO:
            oldest = [(given.pop(request),) for request in [*given][:LET_GO]]
            with self.transaction():
                self._db.executemany("delete from replies where number = ?", oldest)

    def last_event(self, incarnation: int) -> int:
        """The number of the last event of an incarnation; 0 if it reported none."""
        if self._last_event[0] == incarnation:
            return self._last_event[1]
        if incarnation > self.incarnation:
            return 0
        first = incarnation * LIFE
        order = "select max(id) from events where id between ? and ?"
        row = self._db.execute(order, (first, first + LIFE - 1)).fetchone()
        return row[0] - first if row[0] else 0

    def add_event(self, number: int, packed: bytes) -> None:
        """Keep an event of this incarnation."""
        self._db.execute("insert into events values (?, ?)", (self.incarnation * LIFE + number, packed))
        self._last_event = (self.incarnation, number)

    def events(self, incarnation: int, first: int, limit: int) -> list[bytes]:
        """Up to `limit` events of an incarnation from number `first`, in order."""
        if incarnation > self.incarnation:
            return []
        start, order = incarnation * LIFE, "select packed from events where id between ? and ? order by id limit ?"
        rows = self._db.execute(order, (start + min(first, LIFE), start + LIFE - 1, limit))
        return [packed for (packed,) in rows]
