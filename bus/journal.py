"""What a process must not lose when it is killed: a small SQLite file per process, HOME/NAME.sqlite.

Write-ahead logging with synchronous=NORMAL: a commit survives the death of the process at any moment. (It may be
lost when the machine loses power, but then the whole run is lost.) Without a path everything is in memory.

Tables: `entries` for the owner's keys and values, `replies` that were given, by requester and request, `events`
that were reported, by incarnation and number.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

REPLIES_KEPT = 2000
"""Replies remembered per requester: far more than anybody has unanswered at a time."""

TABLES = """
create table if not exists entries (key text primary key, value blob not null) without rowid;
create table if not exists replies (requester text, request text, number integer not null, packed blob not null,
                                    primary key (requester, request)) without rowid;
create table if not exists events (incarnation integer, number integer, packed blob not null,
                                   primary key (incarnation, number)) without rowid;
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
        self._replies: int = self._db.execute("select coalesce(max(number), 0) from replies").fetchone()[0]
        # Nearly every request is new, which this set knows at once. It may hold more than there is, not less.
        self._answered: set[tuple[str, str]] = set(self._db.execute("select requester, request from replies"))

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
        if (requester, request) not in self._answered:
            return None
        question = "select packed from replies where requester = ? and request = ?"
        row = self._db.execute(question, (requester, request)).fetchone()
        return row[0] if row else None

    def remember_reply(self, requester: str, request: str, packed: bytes) -> None:
        """Keep a reply; the oldest replies to the same requester are let go.

        Raises sqlite3.IntegrityError when there is one already.
        """
        self._replies += 1
        self._answered.add((requester, request))
        self._db.execute("insert into replies values (?, ?, ?, ?)", (requester, request, self._replies, packed))
        if self._replies % 256 == 0:
            order = "select requester, request from replies where requester = ? order by number desc limit -1 offset ?"
            oldest = self._db.execute(order, (requester, REPLIES_KEPT)).fetchall()
            with self.transaction():
                self._db.executemany("delete from replies where requester = ? and request = ?", oldest)
            self._answered.difference_update(oldest)

    def last_event(self, incarnation: int) -> int:
        """The number of the last event of an incarnation; 0 if it reported none."""
        row = self._db.execute("select max(number) from events where incarnation = ?", (incarnation,)).fetchone()
        return row[0] or 0

    def add_event(self, number: int, packed: bytes) -> None:
        """Keep an event of this incarnation."""
        self._db.execute("insert into events values (?, ?, ?)", (self.incarnation, number, packed))

    def events(self, incarnation: int, first: int, limit: int) -> list[bytes]:
        """Up to `limit` events of an incarnation from number `first`, in order."""
        rows = self._db.execute(
            "select packed from events where incarnation = ? and number >= ? order by number limit ?",
            (incarnation, first, limit),
        )
        return [packed for (packed,) in rows]
