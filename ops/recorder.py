"""The recorder: writes down a run as it happens, and makes sure that no event is missing from what it wrote.

It asks again for what it missed (`ops.accounts`). When it is told to end, it asks every source for its last number in
each of its lives, writes a summary of sent, received and recorded events, and closes the file.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import threading
from pathlib import Path

from bus import keys
from bus.clock import wall_s
from bus.codec import decode_as
from bus.messages import EventsAre, EventsFrom
from bus.node import NoAnswer, Node, arguments, open_node
from bus.scene import Scene
from bus.transport import TransportError
from ops.accounts import Ask, Recorder
from ops.recording import Summary, Writer, load, parts_of
from reasoning.words import count

LOOK_S = 0.5
"""Wall seconds between two looks at what is missing, and at most so much is unwritten after a crash."""
ANSWER_S, SWEEP_S = 3.0, 15.0
"""Wall seconds to wait for one answer, and for all of them at the end."""
MEET_S = 1.0
"""Wall seconds that it listens at least: everybody shows a sign of life more often, and who did is asked at the end."""
AGAIN_S = 0.3
"""A question is asked again after so many wall seconds: the link may be a bad one."""


def open_part(directory: Path, run: str) -> tuple[Writer, bool]:
    """A new file in the directory, and whether it goes on with a recording of the same run.

    A recording of another run is moved aside (``run.mcap~``), never written over or mixed with this one.
    """
    directory.mkdir(parents=True, exist_ok=True)
    parts = parts_of(directory)
    if parts and load(directory).run not in (run, ""):
        for part in parts:
            part.replace(part.with_name(part.name + "~"))
        parts = []
    number = len(parts)
    return Writer(directory / (f"run.{number}.mcap" if number else "run.mcap")), bool(parts)


def listen(node: Node, recorder: Recorder) -> None:
    """Have the recorder take everything that is said on the run's streams, from now on and kept so far."""
    inbox, run = node.post.inbox, node.run

    def take(key: str, payload: bytes) -> None:
        # The key of the truth does not end in its source's name, which is the world's.
        source = keys.WORLD if key == keys.truth_frame(run) else keys.last(key)
        envelope = inbox.open(payload, source=source)
        if envelope is not None:
            recorder.take(envelope)

    def take_scene(key: str, payload: bytes) -> None:
        scene = decode_as(payload, Scene)
        if isinstance(scene, Scene):
            recorder.take(scene)

    subscribe = node.transport.subscribe
    subscribe(keys.event(run, "*"), inbox.into(take))
    subscribe(keys.beat(run, "*"), inbox.into(take))
    subscribe(keys.status(run, "*"), inbox.into(take), history=True)
    subscribe(keys.truth_frame(run), inbox.into(take))
    subscribe(keys.truth_scene(run), inbox.into(take_scene), history=True)


def asker(node: Node) -> Ask:
    """Questions over the bus."""

    def ask(source: str, question: EventsFrom) -> EventsAre | None:
        try:
            answer = node.ask(source, question, ANSWER_S, retry_s=AGAIN_S)
        except NoAnswer:
            return None
        return answer if isinstance(answer, EventsAre) else None

    return ask


def record(node: Node, directory: Path, stop: threading.Event) -> Summary:
    """Record until `stop` is set (and the node woken), then settle all accounts and close the file."""
    writer, goes_on = open_part(directory, node.run)
    recorder = Recorder(node.run, writer, asker(node))
    if goes_on:
        recorder.resume(directory)
    listen(node, recorder)
    looked_s, met_s = 0.0, wall_s() + MEET_S
    while not stop.is_set() or wall_s() < met_s:
        node.beat(f"{count(recorder.count, 'event')} recorded")
        node.post.wait(LOOK_S)
        if wall_s() - looked_s >= LOOK_S:
            recorder.mend()
            writer.flush()
            looked_s = wall_s()
    while node.post.wait(0.05):
        pass
    end_s = wall_s() + SWEEP_S
    summary = recorder.finish(lambda: wall_s() + ANSWER_S < end_s, node.post.inbox.refused.total())
    node.post.beat_now()
    while node.post.wait(0.05):  # the figures that came with the answers, and our own
        pass
    writer.close()
    return summary


def main(argv: list[str] | None = None) -> int:
    """``python -m ops.recorder``: 0 after SIGTERM or SIGINT, 2 when it cannot begin."""
    own = argparse.ArgumentParser(add_help=False)
    own.add_argument("--record", type=Path, default=os.environ.get("MUSTER_RECORD"))
    mine, rest = own.parse_known_args(argv)
    config = arguments(rest, name="recorder")
    directory = mine.record or config.home
    if directory is None:
        print("recorder: --record DIR is missing (or --home, or MUSTER_RECORD)", file=sys.stderr)
        return 2
    stop = threading.Event()
    try:
        with open_node(config._replace(outsider=True)) as node:

            def on_signal(*_: object) -> None:
                stop.set()
                node.post.inbox.wake()

            # Not `bus.signals`: that gives half a second, and settling the accounts may take longer.
            for number in (signal.SIGTERM, signal.SIGINT):
                signal.signal(number, on_signal)
            record(node, Path(directory), stop)
    except (TransportError, OSError) as error:
        print(f"recorder: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
