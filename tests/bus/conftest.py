"""Fixtures of the bus: a transport of either kind, nodes on it, and waiting for conditions."""

from __future__ import annotations

import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path
from typing import Any, Generic, TypeVar

import pytest

from bus.memory_transport import MemoryRouter
from bus.messages import Envelope, Observe, Observed
from bus.node import Node, NodeConfig, open_node
from bus.transport import Transport

T = TypeVar("T")
LIMIT_S = 10.0
_numbers = count(1)


class Collected(Generic[T]):
    """A list that other threads fill and a test waits on."""

    def __init__(self) -> None:
        self.items: list[T] = []
        self._changed = threading.Condition()

    def add(self, item: T) -> None:
        with self._changed:
            self.items.append(item)
            self._changed.notify_all()

    def pair(self, *item: Any) -> None:
        """`add` for callbacks of several arguments."""
        self.add(item)  # type: ignore[arg-type]

    def wait(self, enough: Callable[[list[T]], Any], limit_s: float = LIMIT_S) -> list[T]:
        """Wait until the items are `enough`; they are, or the test fails."""
        with self._changed:
            assert self._changed.wait_for(lambda: enough(self.items), limit_s), f"not enough: {self.items}"
            return list(self.items)

    def wait_for(self, item: T) -> None:
        self.wait(lambda items: item in items)


def wait(limit_s: float, event: threading.Event | None = None) -> None:
    """Hold a thread up for a while, or until the event, to play somebody who is slow."""
    (event or threading.Event()).wait(limit_s)


class Bus:
    """Transports and nodes of one test, all closed at its end."""

    def __init__(self, connect: Callable[[], Transport]) -> None:
        self.run = f"test{next(_numbers)}"
        self._connect = connect
        self._open: list[Any] = []

    def transport(self) -> Transport:
        transport = self._connect()
        self._open.append(transport)
        return transport

    def node(self, name: str, *, home: Path | None = None, **options: Any) -> Node:
        config = NodeConfig(self.run, name, home=home, **options)
        node = open_node(config, self._connect())
        self._open.append(node)
        return node

    def close(self) -> None:
        for thing in reversed(self._open):
            thing.close()


class Threads:
    """Functions that run beside a test; what they raise fails it."""

    def __init__(self) -> None:
        self._threads: list[threading.Thread] = []
        self._errors: list[BaseException] = []
        self.stops: list[Callable[[], None]] = []

    def start(self, function: Callable[..., Any], *args: Any) -> threading.Thread:
        def body() -> None:
            try:
                function(*args)
            except BaseException as error:
                self._errors.append(error)

        thread = threading.Thread(target=body, daemon=True)
        self._threads.append(thread)
        thread.start()
        return thread

    def join(self) -> None:
        """Wait for all of them to end by themselves."""
        for thread in self._threads:
            thread.join(30.0)
            assert not thread.is_alive(), "a thread did not end"
        if self._errors:
            raise self._errors[0]

    def close(self) -> None:
        for stop in self.stops:
            stop()
        self.join()


def serve(node: Node, seen: Collected[Envelope] | None = None) -> None:
    """Answer everything that wants to look."""
    for turn in node.turns():
        for message in turn.mail:
            if seen is not None:
                seen.add(message)
            if isinstance(message.body, Observe):
                node.reply(message, Observed(message.body.team, {"seen": 1}))


def free_endpoint() -> str:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def start_router(endpoint: str) -> subprocess.Popen[str]:
    router = subprocess.Popen(
        [sys.executable, "-m", "bus.router", "--connect", endpoint], stdout=subprocess.PIPE, text=True
    )
    assert router.stdout is not None
    assert "listening" in router.stdout.readline()
    return router


def end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.communicate()


@pytest.fixture(scope="session")
def endpoint() -> Iterator[str]:
    """The endpoint of a router process that all tests share; every test has a run of its own on it."""
    address = free_endpoint()
    router = start_router(address)
    yield address
    end(router)


@pytest.fixture(params=["memory", "zenoh"])
def bus(request: pytest.FixtureRequest) -> Iterator[Bus]:
    """The same test over both transports."""
    if request.param == "memory":
        connect: Callable[[], Transport] = MemoryRouter().connect
    else:
        address = request.getfixturevalue("endpoint")

        def connect() -> Transport:
            from bus import zenoh_transport

            return zenoh_transport.connect(address)

    opened = Bus(connect)
    yield opened
    opened.close()


@pytest.fixture
def router() -> MemoryRouter:
    return MemoryRouter(seed=1)


@pytest.fixture
def memory_bus(router: MemoryRouter) -> Iterator[Bus]:
    opened = Bus(router.connect)
    yield opened
    opened.close()


@pytest.fixture
def threads() -> Iterator[Threads]:
    running = Threads()
    yield running
    running.close()


@pytest.fixture
def server(bus: Bus, threads: Threads) -> Node:
    node = bus.node("server", outsider=True)
    threads.stops.append(node.stop)
    threads.start(serve, node)
    return node
