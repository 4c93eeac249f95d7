"""Is this machine fit to run muster? Check after check, each with what was found and, if it is wrong, what to do."""

from __future__ import annotations

import importlib.util
import os
import shutil
import statistics
import sys
from collections.abc import Callable, Iterator
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from bus.clock import date_s, wall_s
from bus.messages import Ping
from bus.node import NoAnswer, NodeConfig, open_node
from bus.transport import TransportError
from ops import registry
from ops.places import runs, shipped
from ops.ports import HOST, free_port
from ops.processes import ROUTER
from ops.supervisor import GaveUpError, Supervisor, TooLongError
from ops.tables import InputError

# What is imported to see whether it works; nothing for those that are only looked up, since importing them is dear.
PACKAGES = {
    "eclipse-zenoh": "zenoh",
    "clingo": "clingo",
    "pymunk": "pymunk",
    "msgpack": "msgpack",
    "msgspec": "msgspec",
    "rich": "rich",
    "mcap": "mcap",
    "ompl": "",
}
OURS = ("bus", "reasoning", "world", "agents", "ops")
OUR_DEFAULT_PORT = 7447
ROUND_TRIPS = 200
SLOW_MS = 20.0
ROOM_MB = 200


class Finding(NamedTuple):
    """One check: `ok`, what was found, and what to do about it (empty when all is well)."""

    check: str
    ok: bool
    found: str
    advice: str = ""


def examine() -> Iterator[Finding]:
    """All findings, the quick ones first. The last one starts a router for a moment."""
    yield _python()
    yield from map(_package, PACKAGES)
    yield _own_packages()
    yield _scenarios()
    yield _clock()
    yield _directory()
    yield _port()
    yield _bus()


def _python() -> Finding:
    ok = sys.version_info >= (3, 11)
    found = f"Python {sys.version.split()[0]} on {sys.platform}, {os.cpu_count()} processors"
    return Finding("python", ok, found, "" if ok else "use Python 3.11 or later")


def _package(name: str) -> Finding:
    advice = "make an environment again: rm -r .venv; make test-fast"
    try:
        if PACKAGES[name]:
            __import__(PACKAGES[name])
        return Finding(name, True, version(name))
    except PackageNotFoundError:
        return Finding(name, False, "is not installed", advice)
    except Exception as error:
        return Finding(name, False, f"cannot be imported: {error}", advice)


def _own_packages() -> Finding:
    """Other software installs packages of the same names: are these ours?"""
    home = Path(__file__).resolve().parents[1]
    foreign = []
    for name in OURS:
        spec = importlib.util.find_spec(name)
        if spec is None or spec.origin is None or Path(spec.origin).resolve().parents[1] != home:
            foreign.append(name)
    if foreign:
        advice = "muster wants an environment of its own; the Makefile makes one"
        return Finding("packages", False, f"{', '.join(foreign)} come from elsewhere than {home}", advice)
    return Finding("packages", True, f"all from {home}")


def _scenarios() -> Finding:
    try:
        return Finding("scenarios", True, f"{len(shipped())} shipped")
    except Exception as error:
        return Finding("scenarios", False, str(error), "reinstall muster")


def _clock() -> Finding:
    """The monotonic clock's smallest step, and a date that makes sense (it is in the names of files only)."""
    steps = []
    for _ in range(20):
        start = wall_s()
        while (now := wall_s()) == start:
            pass
        steps.append(now - start)
    finest_us = min(steps) * 1e6
    ok = finest_us < 1000 and date_s() > 1.7e9
    advice = "" if ok else "set the machine's date; a clock this coarse makes realtime runs uneven"
    return Finding("clock", ok, f"resolution {finest_us:.2f} us", advice)


def _directory() -> Finding:
    try:
        folder = runs()
    except InputError as error:
        found, _, advice = str(error).partition("; ")
        return Finding("directory", False, found, advice)
    free_mb = shutil.disk_usage(folder).free // 1_000_000
    ok = free_mb >= ROOM_MB
    advice = "" if ok else "set XDG_RUNTIME_DIR or TMPDIR to a directory with room"
    return Finding("directory", ok, f"{folder}, {free_mb} MB free", advice)


def _port() -> Finding:
    try:
        running = ", ".join(f"{one.run} at {one.connect}" for one in registry.listing()) or "no system is running"
    except InputError:
        running = "which systems are running cannot be told"
    try:
        free_port(OUR_DEFAULT_PORT)
    except Exception:
        found = f"{OUR_DEFAULT_PORT} is in use, which docker-compose and hand-started processes want; {running}"
        return Finding("ports", True, found, "muster run takes any free port by itself")
    return Finding("ports", True, f"{OUR_DEFAULT_PORT} is free; {running}")


def _bus() -> Finding:
    """A router of its own, two nodes, and messages there and back."""
    advice = f"is something filtering connections to {HOST}? muster needs nothing but the loopback interface"
    try:
        with TemporaryDirectory() as folder, Supervisor(wall_s, lambda *_: None, budget=0) as boss:
            endpoint = f"tcp/{HOST}:{free_port(0)}"
            argv = [sys.executable, "-m", "bus.router", "--connect", endpoint]
            boss.launch(ROUTER, argv, Path(folder) / "router.log")
            times_ms = _round_trips(partial(NodeConfig, run="doctor", connect=endpoint, outsider=True))
            boss.stop()
    except (TransportError, NoAnswer, GaveUpError, TooLongError, OSError) as error:
        return Finding("bus", False, str(error), advice)
    median, worst = statistics.median(times_ms), max(times_ms)
    ok = median < SLOW_MS
    found = f"{len(times_ms)} round trips: median {median:.2f} ms, longest {worst:.2f} ms"
    return Finding("bus", ok, found, "" if ok else "the machine is very busy; realtime runs will lag")


def _round_trips(config: Callable[..., NodeConfig]) -> list[float]:
    from threading import Thread

    times_ms = []
    with open_node(config(name="asker")) as asker, open_node(config(name="answerer")) as answerer:
        thread = Thread(target=lambda: [None for _ in answerer.turns()], daemon=True)
        thread.start()
        for _ in range(ROUND_TRIPS):
            start = wall_s()
            asker.ask("answerer", Ping(), 10.0)
            times_ms.append(1000 * (wall_s() - start))
        answerer.stop()
        thread.join(10.0)
    return times_ms
