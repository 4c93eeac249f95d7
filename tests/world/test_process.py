"""The world as a process on a real bus, in both clocks, killed and started again."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from bus import keys
from bus.codec import decode, decode_as
from bus.messages import Contact, Envelope, Event, EventsAre, EventsFrom, Execute, Executed, Frame, Ok
from bus.node import Node, NodeConfig, open_node
from bus.scene import Fault, Scene
from tests.bus.conftest import Threads, end, free_endpoint, start_router
from tests.world.stage import call, hand, piece, scene, tug

STEPS = [
    "shift join(t1,h1)",
    "push(t1)",
    "push(t1)",
    "part(t1) shift",
    "go(h1,right) shift",
    "go(h1,right)",
    "work(h1,1)",
]
LIMIT_S = 30.0


@pytest.fixture
def endpoint() -> Iterator[str]:
    address = free_endpoint()
    router = start_router(address)
    yield address
    end(router)


class Players:
    """The coordinator, who only confirms, and team A, who executes its steps one after the other."""

    def __init__(self, endpoint: str, mode: str, factor: float) -> None:
        self.results: list[Executed] = []
        self.heard: list[object] = []
        self.changed = threading.Condition()
        self.nodes: list[Node] = []
        self.threads = Threads()
        for name, play in (("coordinator", self.confirm), ("A", self.act)):
            node = open_node(NodeConfig("test", name, connect=endpoint, mode=mode, factor=factor))  # type: ignore[arg-type]
            self.nodes.append(node)
            self.threads.stops.append(node.stop)
            self.threads.start(play, node)

    def close(self) -> None:
        self.threads.close()
        for node in self.nodes:
            node.close()

    def confirm(self, node: Node) -> None:
        for turn in node.turns():
            for message in turn.mail:
                self.heard.append(message.body)
                node.reply(message, Ok())

    def act(self, node: Node) -> None:
        number = 0
        for turn in node.turns():
            for message in turn.mail:
                if isinstance(message.body, Executed):
                    with self.changed:
                        self.results.append(message.body)
                        self.changed.notify_all()
            if number == len(self.results) < len(STEPS):
                calls = tuple(call(text) for text in STEPS[number].split())
                node.request("world", Execute("A", number, calls))
                number += 1

    def wait(self, number: int) -> None:
        with self.changed:
            assert self.changed.wait_for(lambda: len(self.results) >= number, LIMIT_S), self.results


def told(file: Path, a_scene: Scene) -> Path:
    file.write_bytes(msgspec.json.encode(a_scene))
    return file


def recorded(node: Node, incarnation: int) -> list[Event]:
    answer = node.ask("world", EventsFrom(incarnation, 1), LIMIT_S)
    assert isinstance(answer, EventsAre)
    return [m.body for m in map(decode, answer.packed) if isinstance(m, Envelope) and isinstance(m.body, Event)]


def start(endpoint: str, home: Path, clock: str) -> subprocess.Popen[str]:
    options = ["--run", "test", "--connect", endpoint, "--home", str(home), "--clock", clock]
    return subprocess.Popen([sys.executable, "-m", "world", *options, "--setup", str(home / "world.json")], text=True)


@pytest.mark.slow
@pytest.mark.parametrize(("clock", "factor"), [("fast", 1.0), ("realtime:40", 40.0)])
def test_a_world_that_is_killed_twice_ends_like_one_that_is_not(
    endpoint: str, tmp_path: Path, clock: str, factor: float
) -> None:
    bodies = (hand("A", "h1", 1, 1), tug("A", "t1", 1, 1), piece("A", 1, 6))
    told(tmp_path / "world.json", scene(*bodies, faults=(Fault("order", "A", at_step=2, args={"add": 1}),)))
    frames: list[Frame] = []
    scenes: list[object] = []

    def watch(key: str, payload: bytes) -> None:
        message = decode(payload)
        if isinstance(message, Envelope) and isinstance(message.body, Frame):
            frames.append(message.body)

    watcher = open_node(NodeConfig("test", "watcher", connect=endpoint, outsider=True))
    watcher.transport.subscribe(keys.truth_frame("test"), watch)
    players = Players(endpoint, clock.partition(":")[0], factor)
    world = start(endpoint, tmp_path, clock)
    try:
        for number in (2, 4):
            players.wait(number)
            end(world)
            world = start(endpoint, tmp_path, clock)
        players.wait(len(STEPS))
        watcher.transport.subscribe(
            keys.truth_scene("test"), lambda _, p: scenes.append(decode_as(p, Scene)), history=True
        )
        # What a killed world had no time to send is in its journal.
        events = [event for life in (1, 2, 3) for event in recorded(watcher, life)]
        assert [result.step for result in players.results] == list(range(len(STEPS)))
        assert players.results[-1].state == {
            "at(h1)": "(3,3)",
            "tool(h1)": 1,
            "at(t1)": "(1,3)",
            "holds(t1)": "none",
            "line(1)": 3,
            "state(1)": 1,
            "hot(1)": 1,
            "line(2)": 4,
            "state(2)": 0,
            "hot(2)": 0,
        }
        world.send_signal(signal.SIGTERM)
        assert world.wait(LIMIT_S) == 0
    finally:
        end(world)
        players.close()
        watcher.close()
    assert [e.data["recovered"] for e in events if e.kind == "started"] == [False, True, True]
    assert len([e for e in events if e.kind == "order"]) == 1
    assert [e.data["step"] for e in events if e.kind == "step_ended"] == list(range(len(STEPS)))
    assert Contact("A", "present") in players.heard
    assert frames[-1].step == len(STEPS) - 1
    assert [isinstance(found, Scene) for found in scenes] == [True]


@pytest.mark.parametrize(
    ("content", "complaint"), [(b"{}", "missing required field"), (b"nonsense", "malformed"), (None, "--setup")]
)
def test_a_wrong_setup_is_told_and_ends_with_exit_code_2(tmp_path: Path, content: bytes | None, complaint: str) -> None:
    options = ["--run", "test"]
    if content is not None:
        (tmp_path / "world.json").write_bytes(content)
        options += ["--setup", str(tmp_path / "world.json")]
    done = subprocess.run(
        [sys.executable, "-m", "world", *options], capture_output=True, text=True, timeout=LIMIT_S, check=False
    )
    assert done.returncode == 2
    assert complaint in done.stderr
