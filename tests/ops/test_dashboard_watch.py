"""Watchers on a bus: late joiners, odd bytes, and one in a real terminal over Zenoh."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
from collections.abc import Iterator

import pytest

from bus import keys
from bus.clock import wall_s
from bus.codec import encode
from bus.memory_transport import MemoryRouter
from bus.messages import Envelope, Frame, Status
from bus.node import NodeConfig, open_node
from bus.scene import Scene
from bus.zenoh_transport import connect
from ops.dashboard import Feed, Model
from tests.ops.synthetic import plan, scene, story
from tests.ops.terminal import Terminal

RUN = "made-up"


def test_a_late_joiner_gets_the_scene_and_the_last_statuses() -> None:
    router = MemoryRouter()
    with open_node(NodeConfig(RUN, "T1", outsider=True), router.connect()) as node:
        node.transport.keep(keys.truth_scene(RUN), encode(scene(4)))
        node.status(Status("team", "thinking"))
        node.status(Status("team", "executing step 3", 3, 0, plan(0)))
        node.emit("refused", "lost on those who come later", reason="x", count=1)
        first, second = Feed(router.connect(), RUN), Feed(router.connect(), RUN)
        node.emit("refused", "two messages were refused", reason="x", count=2)
        for feed in (first, second):
            model = feed.fold(Model(run=RUN))
            assert model.teams == ("T1", "T2", "T3", "T4")
            assert model.statuses["T1"].doing == "executing step 3"
            assert [note.text for note in model.events] == ["two messages were refused"]


def test_bytes_that_are_no_message_are_dropped() -> None:
    router = MemoryRouter()
    feed, other = Feed(router.connect(), RUN), router.connect()
    for key in (keys.truth_scene(RUN), keys.truth_frame(RUN), keys.event(RUN, "T1"), keys.status(RUN, "T1")):
        for payload in (b"", b"\xff" * 50, encode(scene(1))[:-9], encode(scene(1))):
            other.put(key, payload)
    model = feed.fold(Model(run=RUN))
    assert model.teams == ("T1",)
    assert model.frame is None


@pytest.fixture
def endpoint() -> Iterator[str]:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        address = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
    router = subprocess.Popen([sys.executable, "-m", "bus.router", "--connect", address], stdout=subprocess.PIPE)
    try:
        assert router.stdout is not None
        router.stdout.readline()
        yield address
    finally:
        router.terminate()
        router.communicate(timeout=10)


def test_watching_in_a_terminal(endpoint: str) -> None:
    # A process keeps one status: Zenoh's history answers for one key of a session, whatever else it keeps.
    said = list(story(4, 18))
    transports = {source: connect(endpoint) for source in ("scene", "coordinator", "world", "T1", "T2", "T3", "T4")}
    transport = transports["scene"]
    terminal = Terminal(f"from ops.dashboard import watch; watch({endpoint!r}, {RUN!r})", 160, 50)
    try:
        assert isinstance(said[0], Scene)
        transport.keep(keys.truth_scene(RUN), encode(said[0]))
        for message in said[1:]:
            if isinstance(message, Envelope) and isinstance(message.body, Status):
                transports[message.src].keep(keys.status(RUN, message.src), encode(message))
        assert terminal.until(lambda: b"workOn(w2,1)" in terminal.seen), terminal.seen[-3000:]
        frame = [m for m in said if isinstance(m, Envelope) and isinstance(m.body, Frame)][-1]
        again_s = wall_s()

        def frame_is_drawn() -> bool:
            nonlocal again_s
            if wall_s() > again_s:  # frames may be dropped: the world sends another one soon
                transport.put(keys.truth_frame(RUN), encode(frame), droppable=True)
                again_s = wall_s() + 0.2
            return b"stamped" in terminal.seen and b"36.0 s" in terminal.seen

        assert terminal.until(frame_is_drawn), terminal.seen[-3000:]
        terminal.process.send_signal(signal.SIGTERM)
        terminal.must_end_clean()
    finally:
        terminal.close()
        for one in transports.values():
            one.close()
