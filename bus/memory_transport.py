"""The in-memory twin of the Zenoh transport: nodes of one process, joined by a `MemoryRouter`.

Messages are delivered on the sender's thread, at once and in order, unless the router is told to misbehave.
"""

from __future__ import annotations

import random
import re
import threading
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

from bus.transport import Notice, Receive


class Mischief(NamedTuple):
    """What the router does to a message whose key matches `keyexpr`: probabilities of losing it, of delivering it
    twice and of holding it back until up to `hold` later messages have passed it (delay and reordering)."""

    keyexpr: str = "**"
    drop: float = 0.0
    repeat: float = 0.0
    delay: float = 0.0
    hold: int = 3


class _Subscription(NamedTuple):
    owner: MemoryTransport
    matches: Callable[[str], object]
    callback: Receive


class _Watch(NamedTuple):
    owner: MemoryTransport
    matches: Callable[[str], object]
    callback: Notice


class MemoryRouter:
    """Joins transports. `mischief` may be replaced at any time; its dice are seeded."""

    def __init__(self, seed: int = 0) -> None:
        self.mischief = Mischief()
        self._dice = random.Random(seed)
        self._lock = threading.RLock()
        self._subscriptions: tuple[_Subscription, ...] = ()
        self._watches: tuple[_Watch, ...] = ()
        self._tokens: dict[str, MemoryTransport] = {}
        self._kept: dict[str, tuple[MemoryTransport, bytes]] = {}
        self._held: list[tuple[int, str, bytes]] = []

    def connect(self) -> MemoryTransport:
        """A new client of this router."""
        return MemoryTransport(self)

    def flush(self) -> None:
        """Deliver all messages that are held back."""
        with self._lock:
            held, self._held = self._held, []
            for _, key, payload in held:
                self._deliver(key, payload)

    def _route(self, key: str, payload: bytes) -> None:
        with self._lock:
            todo = self.mischief
            if todo[1:4] == (0.0, 0.0, 0.0) or not _matcher(todo.keyexpr)(key):
                self._deliver(key, payload)
            else:
                roll = self._dice.random
                copies = 0 if roll() < todo.drop else 2 if roll() < todo.repeat else 1
                for _ in range(copies):
                    if roll() < todo.delay:
                        self._held.append((self._dice.randint(1, todo.hold) + 1, key, payload))
                    else:
                        self._deliver(key, payload)
            waiting, self._held = [(left - 1, k, p) for left, k, p in self._held], []
            for left, k, p in waiting:
                if left > 0:
                    self._held.append((left, k, p))
                else:
                    self._deliver(k, p)

    def _deliver(self, key: str, payload: bytes) -> None:
        for subscription in self._subscriptions:
            if subscription.matches(key):
                subscription.callback(key, payload)

    def _notify(self, key: str, there: bool) -> None:
        for watch in self._watches:
            if watch.matches(key):
                watch.callback(key, there)


class MemoryTransport:
    """One client of a `MemoryRouter`; see `bus.transport.Transport`."""

    def __init__(self, router: MemoryRouter) -> None:
        self._router = router
        self._open = True

    def put(self, key: str, payload: bytes, *, droppable: bool = False) -> None:
        if self._open:
            self._router._route(key, payload)

    def keep(self, key: str, payload: bytes) -> None:
        with self._router._lock:
            if self._open:
                self._router._kept[key] = (self, payload)
                self._router._route(key, payload)

    def subscribe(self, keyexpr: str, callback: Receive, *, latest: bool = False, history: bool = False) -> None:
        # Delivery is on the sender's thread: a slow callback slows the sender, so there is nothing to skip.
        matches = _matcher(keyexpr)
        with self._router._lock:
            self._router._subscriptions += (_Subscription(self, matches, callback),)
            if history:
                for key, (_, payload) in list(self._router._kept.items()):
                    if matches(key):
                        callback(key, payload)

    def present(self, key: str) -> None:
        with self._router._lock:
            self._router._tokens[key] = self
            self._router._notify(key, True)

    def watch(self, keyexpr: str, callback: Notice) -> None:
        matches = _matcher(keyexpr)
        with self._router._lock:
            self._router._watches += (_Watch(self, matches, callback),)
            for key in list(self._router._tokens):
                if matches(key):
                    callback(key, True)

    def close(self) -> None:
        router = self._router
        with router._lock:
            if not self._open:
                return
            self._open = False
            router._subscriptions = tuple(s for s in router._subscriptions if s.owner is not self)
            router._watches = tuple(w for w in router._watches if w.owner is not self)
            router._kept = {key: kept for key, kept in router._kept.items() if kept[0] is not self}
            gone = [key for key, owner in router._tokens.items() if owner is self]
            for key in gone:
                del router._tokens[key]
                router._notify(key, False)


@lru_cache(maxsize=1024)
def _matcher(keyexpr: str) -> Callable[[str], object]:
    """Zenoh's key expressions: ``*`` stands for one part of a key, ``**`` for any number of them."""
    if "*" not in keyexpr:
        return keyexpr.__eq__
    pattern = "/".join({"**": ".*", "*": "[^/]+"}.get(part) or re.escape(part) for part in keyexpr.split("/"))
    return re.compile(pattern.replace("/.*", "(/.*)?")).fullmatch
