"""Real processes over Zenoh: they live, die and end as they should, and the fast clock is the same on every run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from bus import keys, zenoh_transport
from bus.clock import wall_s
from bus.codec import decode
from bus.messages import Envelope, Event, EventsAre, EventsFrom, Ok, ProcessFault
from bus.node import NodeConfig, open_node
from tests.bus.conftest import Collected, end, free_endpoint, start_router
from tests.bus.test_rounds import Said, kinds, taken
from tests.bus.toys import TEAMS

NAMES = ("world", "coordinator", *TEAMS)


class Town:
    """The toy system in processes, with a supervisor that carries out what the world asks for."""

    def __init__(self, endpoint: str, run: str, home: Path) -> None:
        self._options = ["--run", run, "--connect", endpoint, "--home", str(home)]
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        self.events: Collected[Said] = Collected()
        self.node = open_node(NodeConfig(run, "supervisor", endpoint, outsider=True))
        self.node.transport.subscribe(keys.event(run, "*"), self._on_event)
        self._thread = threading.Thread(target=self._supervise)
        self._thread.start()

    def start(self, name: str, *more: str) -> None:
        role = name if name in ("world", "coordinator") else "team"
        line = [sys.executable, "-m", "tests.bus.toys", role, *self._options, "--name", name, *more]
        self.processes[name] = subprocess.Popen(line)

    def finish(self, teams: tuple[str, ...] = TEAMS, limit_s: float = 40.0) -> list[Said]:
        self.events.wait(lambda items: {e[0] for e in items if e[4] == "team_finished"} >= set(teams), limit_s)
        return sorted(self.events.items, key=lambda e: (e[3], e[0], e[1], e[2]))

    def close(self) -> None:
        for process in self.processes.values():
            process.kill()
            process.wait()
        self.node.stop()
        self._thread.join()
        self.node.close()

    def events_of(self, name: str, incarnation: int) -> list[bytes]:
        """What a process has in its journal."""
        config = self.node.config._replace(name="recorder")
        found: list[bytes] = []
        with open_node(config) as recorder:
            while True:
                answer = recorder.ask(name, EventsFrom(incarnation, len(found) + 1), timeout_s=10.0)
                assert isinstance(answer, EventsAre)
                found += answer.packed
                if len(found) == answer.last:
                    return found

    def _on_event(self, _: str, payload: bytes) -> None:
        self.events.add(self.said(payload))

    def said(self, payload: bytes) -> Said:
        envelope = decode(payload)
        assert isinstance(envelope, Envelope)
        assert isinstance(envelope.body, Event)
        said = sorted((key, str(value)) for key, value in envelope.body.data.items())
        return envelope.src, envelope.inc, envelope.seq, envelope.at_s, envelope.body.kind, str(said)

    def _supervise(self) -> None:
        for turn in self.node.turns():
            for message in turn.mail:
                if isinstance(message.body, ProcessFault):
                    self._disturb(message.body)
                    self.node.reply(message, Ok())

    def _disturb(self, fault: ProcessFault) -> None:
        process = self.processes[fault.target]
        if fault.kind == "kill":
            process.kill()
            process.wait()
            self.start(fault.target)
        else:
            process.send_signal(signal.SIGSTOP if fault.kind == "pause" else signal.SIGCONT)


@pytest.fixture
def towns(endpoint: str, tmp_path: Path) -> Iterator[list[Town]]:
    """Two of them, to compare."""
    opened = [Town(endpoint, f"town{number}-{os.getpid()}-{wall_s():.0f}", tmp_path / str(number)) for number in (1, 2)]
    yield opened
    for town in opened:
        town.close()


def live(town: Town, *world: str) -> list[Said]:
    for name in NAMES:
        town.start(name, *(world if name == "world" else ()))
    events = town.finish()
    assert taken(events)
    return events


@pytest.mark.slow
def test_two_runs_have_the_same_events(towns: list[Town]) -> None:
    first, second = (live(town) for town in towns)
    assert first == second


@pytest.mark.slow
def test_a_kill_has_the_same_effect_on_every_run(towns: list[Town]) -> None:
    first, second = (live(town, "--disturb", "2.5,kill,T2") for town in towns)
    assert first == second
    assert {e[1] for e in first if e[0] == "T2"} == {1, 2}
    assert [e for e in kinds(first, "contact") if "lost" in e[5]] == []


@pytest.mark.slow
def test_a_pause_has_the_same_effect_on_every_run(towns: list[Town]) -> None:
    first, second = (live(town, "--disturb", "2.5,pause,T2,4.5,resume,T2") for town in towns)
    assert first == second
    contacts = [(e[3], "lost_contact" in e[5]) for e in kinds(first, "contact") if "'T2'" in e[5]]
    assert contacts == [(0.0, False), (2.5, True), (4.5, False)]


@pytest.mark.slow
def test_a_world_that_dies_goes_on_from_its_journal(endpoint: str, tmp_path: Path) -> None:
    town = Town(endpoint, f"world-{os.getpid()}-{wall_s():.0f}", tmp_path)
    try:
        for name in NAMES:
            town.start(name)
        town.events.wait(lambda items: len(kinds(items, "step_ended")) >= 7)
        town.processes["world"].kill()
        town.processes["world"].wait()
        town.start("world")
        town.finish()
        # The last event before the end may be in the journal and nowhere else.
        events = [town.said(packed) for life in (1, 2) for packed in town.events_of("world", life)]
        assert taken(events)
    finally:
        town.close()


@pytest.mark.slow
def test_the_router_may_die_too(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    router = start_router(endpoint)
    town = Town(endpoint, "router", tmp_path)
    try:
        for name in NAMES:
            town.start(name)
        town.events.wait(lambda items: len(kinds(items, "step_ended")) >= 4)
        end(router)
        router = start_router(endpoint)
        # Events of the interruption are lost to this observer, which does not ask for them again.
        events = town.finish()
        assert max(e[3] for e in events) >= 5.0
    finally:
        town.close()
        end(router)


# ---------------------------------------------------------------- how processes end
def process(endpoint: str, code: str) -> subprocess.Popen[str]:
    """A process that opens node `x` of run ``ends`` and runs `code` in its ``with`` block."""
    lines = "\n".join("    " + line for line in code.splitlines())
    script = f"""
from bus.node import *
import hashlib
with open_node(NodeConfig("ends", "x", "{endpoint}", outsider=True)) as node:
    node.transport.subscribe("muster/**", lambda key, payload: None)
    node.transport.subscribe("muster/**", lambda key, payload: None, latest=True)
{lines}
"""
    return subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


LOOP = "for turn in node.turns():\n    print('up', flush=True)\n"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize(
    "busy", ["", "    hashlib.pbkdf2_hmac('sha256', b'', b'', 40_000_000)\n"], ids=["waiting", "deep in C"]
)
def test_a_signal_ends_a_process_soon(endpoint: str, number: signal.Signals, busy: str) -> None:
    child = process(endpoint, "node.wake_soon()\n" + LOOP + busy)
    assert child.stdout is not None
    assert child.stdout.readline() == "up\n"
    began_s = wall_s()
    child.send_signal(number)
    _, errors = child.communicate(timeout=10)
    assert (child.returncode, errors) == (0, "")
    assert wall_s() - began_s < 3.0, "half a second, and more where the machine is busy"


def test_an_exception_ends_a_process_and_its_presence(endpoint: str) -> None:
    seen: Collected[tuple[str, bool]] = Collected()
    watcher = zenoh_transport.connect(endpoint)
    watcher.watch(keys.live("ends", "*"), seen.pair)
    child = process(endpoint, "raise RuntimeError('a bug')")
    _, errors = child.communicate(timeout=10)
    assert child.returncode == 1
    assert "RuntimeError: a bug" in errors
    seen.wait(lambda items: [there for _, there in items] == [True, False])
    watcher.close()


def test_a_router_that_cannot_listen_says_so(endpoint: str) -> None:
    second = subprocess.run(
        [sys.executable, "-m", "bus.router", "--connect", endpoint],
        capture_output=True,
        text=True,
        timeout=20,
        check=False,
    )
    assert second.returncode == 2
    assert second.stdout == ""
    assert second.stderr == f"router: {endpoint} is in use: is another run going on? Stop it, or choose another port.\n"


def test_a_router_that_is_given_nonsense_says_so() -> None:
    router = subprocess.run(
        [sys.executable, "-m", "bus.router", "--connect", "tcp/nowhere"], capture_output=True, text=True, check=False
    )
    assert router.returncode == 2
    assert router.stderr.startswith("router: cannot listen on tcp/nowhere, expected tcp/HOST:PORT: ")
    assert router.stderr.count("\n") == 1
    assert ".rs" not in router.stderr


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_router_ends_when_told(number: signal.Signals) -> None:
    router = start_router(free_endpoint())
    router.send_signal(number)
    router.communicate(timeout=5)
    assert router.returncode == 0
