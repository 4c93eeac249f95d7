"""The recorder: no event is lost, none is written twice, and its own death costs at most the last moment."""

from __future__ import annotations

import os
import random
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest

from bus.clock import wall_s
from bus.codec import encode
from bus.memory_transport import MemoryRouter, Mischief
from bus.messages import Beat, Envelope, Event, EventsAre, EventsFrom, Status
from bus.node import Node, NodeConfig, open_node
from ops.accounts import Account, Recorder
from ops.invariants import counts
from ops.recorder import open_part, record
from ops.recording import Writer, load
from tests.ops.synthetic import story

RUN = "made-up"
ALL = [m for m in story(2) if isinstance(m, Envelope) and isinstance(m.body, Event)]


class Journals:
    """Answers for all sources, as their journals would."""

    def __init__(self, said: list[Envelope], at_once: int = 7) -> None:
        self.said, self.at_once = said, at_once
        self.silent: set[str] = set()

    def ask(self, source: str, question: EventsFrom) -> EventsAre | None:
        if source in self.silent:
            return None
        mine = [e for e in self.said if (e.src, e.inc) == (source, question.incarnation)]
        wanted = [encode(e) for e in mine if e.seq >= question.first][: self.at_once]
        return EventsAre(question.incarnation, max((e.seq for e in mine), default=0), tuple(wanted))


def test_an_account_knows_what_is_missing() -> None:
    account = Account()
    assert [account.note(n) for n in (1, 2, 5, 2, 5, 4)] == [True, True, True, False, False, True]
    assert (account.upto, account.recorded, account.missing()) == (2, 4, (3,))
    account.known = 10**15  # as a forged message might say
    assert len(account.missing()) == 20


@pytest.mark.parametrize("seed", range(5))
def test_whatever_is_lost_repeated_or_late_is_recorded_once(tmp_path: Path, seed: int) -> None:
    dice = random.Random(seed)
    journals = Journals(ALL)
    writer = Writer(tmp_path / "run.mcap")
    recorder = Recorder(RUN, writer, journals.ask)
    arriving = [e for e in ALL if dice.random() > 0.3] + [e for e in ALL if dice.random() < 0.2]
    dice.shuffle(arriving)
    for i, envelope in enumerate(arriving):
        recorder.take(envelope)
        if i % 40 == 0:
            recorder.mend()
    summary = recorder.finish()
    writer.close()
    got = load(tmp_path)
    assert sorted(got.events, key=str) == sorted(ALL, key=str)
    assert all(c.sent == c.recorded and not c.missing for c in summary.sources)
    assert list(counts(got)) == []


def test_what_is_said_while_the_accounts_are_closed_is_of_after_the_end(tmp_path: Path) -> None:
    before, after = ALL[: len(ALL) // 2], ALL[len(ALL) // 2 :]
    journals, writer = Journals(before), Writer(tmp_path / "run.mcap")

    def talk() -> None:
        for event in after:
            recorder.take(event)
            recorder.take(msgspec.structs.replace(event, body=Beat(pid=1, events=event.seq)))

    def ask(source: str, question: EventsFrom) -> EventsAre | None:
        answer = journals.ask(source, question)
        talk()  # before its answer is taken in, and while others are asked
        return answer

    recorder = Recorder(RUN, writer, ask)
    for event in before:
        if event.seq % 2:  # the first of everybody, or nobody would know whom to ask
            recorder.take(event)
    summary = recorder.finish()
    talk()
    writer.close()
    got = load(tmp_path)
    assert sorted(got.events, key=str) == sorted(before, key=str)
    assert all(c.sent == c.recorded and not c.missing for c in summary.sources)
    assert list(counts(got)) == []


def test_former_lives_are_asked_about_and_the_silent_are_named(tmp_path: Path) -> None:
    second_life = [msgspec.structs.replace(e, inc=2) for e in ALL[:4]]
    journals = Journals([*ALL, *second_life])
    writer = Writer(tmp_path / "run.mcap")
    recorder = Recorder(RUN, writer, journals.ask)
    recorder.take(second_life[0])
    source = second_life[0].src
    journals.silent = {"T1"}
    recorder.take(msgspec.structs.replace(ALL[0], src="T1", seq=3))
    summary = {(c.source, c.incarnation): c for c in recorder.finish().sources}
    writer.close()
    assert summary[source, 1].recorded == sum(e.src == source for e in ALL)
    assert (summary["T1", 1].sent, summary["T1", 1].missing) == (-1, (1, 2))
    assert any("T1 (life 1): 2 events missing" in s for s in counts(load(tmp_path)))


def test_who_is_silent_at_the_end_is_not_taken_by_an_earlier_word(tmp_path: Path) -> None:
    journals = Journals(ALL[:6])
    writer = Writer(tmp_path / "run.mcap")
    recorder = Recorder(RUN, writer, journals.ask)
    recorder.take(ALL[1])  # ALL[0] is missing, and asked for
    recorder.mend()
    recorder.mend()
    journals.silent = {e.src for e in ALL}
    for envelope in ALL:
        recorder.take(envelope)
    summary = recorder.finish()
    writer.close()
    assert {count.sent for count in summary.sources} == {-1}
    assert list(counts(load(tmp_path))) == []


def test_a_sign_of_life_tells_of_events_that_never_came(tmp_path: Path) -> None:
    writer = Writer(tmp_path / "run.mcap")
    recorder = Recorder(RUN, writer, Journals(ALL).ask)
    number = sum(e.src == "T1" for e in ALL)
    recorder.take(Envelope(1, RUN, "T1", 1, 1, "b", 0.0, Beat(7, events=number)))
    recorder.mend()
    assert recorder.count == 0  # they may be on their way
    recorder.mend()
    writer.close()
    assert sum(e.src == "T1" for e in load(tmp_path).events) == number


def test_another_runs_recording_is_moved_aside(tmp_path: Path) -> None:
    for run, expected in (("made-up", "run.mcap"), ("made-up", "run.1.mcap"), ("other", "run.mcap")):
        writer, goes_on = open_part(tmp_path, run)
        assert goes_on == (expected != "run.mcap")
        assert (tmp_path / expected).exists()
        writer.add("event", msgspec.structs.replace(ALL[0], run=run))
        writer.close()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["run.1.mcap~", "run.mcap", "run.mcap~"]


@pytest.mark.slow
def test_over_a_bus_that_loses_repeats_and_delays(tmp_path: Path) -> None:
    router = MemoryRouter(seed=3)
    router.mischief = Mischief(keyexpr="muster/*/event/**", drop=0.3, repeat=0.2, delay=0.2)
    stop = threading.Event()
    with open_node(NodeConfig(RUN, "recorder", outsider=True), router.connect()) as mine, source(router) as other:
        thread = threading.Thread(target=record, args=(mine, tmp_path, stop))
        thread.start()
        assert until(lambda: "recorder" in heard(other))
        for i in range(300):
            other.emit("bound", f"number {i}", lower=i, best=99)
        stop.set()
        mine.post.inbox.wake()
        # The one node of this test's thread answers the recorder's questions meanwhile.
        assert until(lambda: heard(other) and not thread.is_alive())
        thread.join()
    got = load(tmp_path)
    assert [e.seq for e in got.events] == list(range(1, 301))
    assert list(counts(got)) == []


HEARD: dict[int, set[str]] = {}


def heard(node: Node) -> set[str]:
    node.post.wait(0.05)
    return HEARD[id(node)]


class source:  # noqa: N801 - reads as a function
    """A node that emits events, and hears who else is there."""

    def __init__(self, router: MemoryRouter) -> None:
        self.node = open_node(NodeConfig(RUN, "T1", outsider=True), router.connect())

    def __enter__(self) -> Node:
        HEARD[id(self.node)] = set()
        self.node.post.listen(f"muster/{RUN}/beat/*", lambda e: HEARD[id(self.node)].add(e.src))
        return self.node

    def __exit__(self, *_: object) -> None:
        self.node.close()


def until(condition: Callable[[], object], limit_s: float = 10.0) -> bool:
    end_s = wall_s() + limit_s
    while not condition():
        if wall_s() > end_s:
            return False
    return True


# ---------------------------------------------------------------- real processes
@pytest.fixture
def endpoint(tmp_path: Path) -> Iterator[str]:
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


def start_recorder(endpoint: str, directory: Path) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "ops.recorder", "--run", RUN, "--connect", endpoint]
    return subprocess.Popen([*command, "--home", str(directory / "home"), "--record", str(directory)])


@pytest.mark.slow
def test_kill_9_leaves_a_readable_file_and_the_next_recorder_goes_on(tmp_path: Path, endpoint: str) -> None:
    number = 0

    def emit(node: Node, times: int) -> None:
        nonlocal number
        for _ in range(times):
            number += 1
            node.emit("bound", f"number {number}", lower=number, best=99)
        node.post.wait(0.02)

    def last_read() -> int:
        """All events up to this number can be read."""
        numbers = [e.seq for e in load(tmp_path).events] if (tmp_path / "run.mcap").exists() else []
        return len(numbers) if numbers == list(range(1, len(numbers) + 1)) else 0

    config = NodeConfig(RUN, "T1", connect=endpoint, home=tmp_path / "home", outsider=True)
    recorder = start_recorder(endpoint, tmp_path)
    try:
        with open_node(config) as node:
            node.status(Status("team", "waiting"))
            assert until(lambda: emit(node, 5) or last_read() > 20)
            recorder.send_signal(signal.SIGKILL)
            recorder.wait(10)
            killed = load(tmp_path)
            assert not killed.complete
            assert [e.seq for e in killed.events] == list(range(1, len(killed.events) + 1))
            assert any(isinstance(e.body, Status) for e in killed.statuses)
            emit(node, 50)  # nobody hears these
            recorder = start_recorder(endpoint, tmp_path)
            seen = number
            assert until(lambda: emit(node, 1) or last_read() > seen)
            recorder.send_signal(signal.SIGTERM)
            assert until(lambda: emit(node, 0) or recorder.poll() is not None)
    finally:
        if recorder.poll() is None:
            os.kill(recorder.pid, signal.SIGKILL)
        recorder.wait(10)
    assert recorder.returncode == 0
    whole = load(tmp_path)
    assert whole.complete
    assert [e.seq for e in whole.events] == list(range(1, number + 1))
    assert list(counts(whole)) == []
