"""What the bus costs: ``python -m bench.bus``, or ``muster bench bus``.

Two figures. The round trip of a command, from `Node.ask` to a node that answers in its main loop and journals the
reply, beside a bare Zenoh query of the same size over the same router, taken in turns so that both meet the same
machine. And a state feed of 100 Hz to twelve processes: how late frames arrive and how many are missing.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median, quantiles
from typing import Any

from bench.loopback import child, free_endpoint, ready
from bus import keys
from bus.clock import wall_s
from bus.codec import Refusal, decode, encode
from bus.messages import BodyFrame, Frame, Observe, Observed
from bus.node import Node, NodeConfig, open_node
from bus.zenoh_transport import open_client

RUN = "bench"
SAMPLES = 4000
SUBSCRIBERS = 12
FEED_HZ = 100
FEED_S = 10.0
BODIES = 40


def run(samples: int = SAMPLES, feed_s: float = FEED_S) -> dict[str, Any]:
    """Measure; times in microseconds (`_us`) and milliseconds (`_ms`)."""
    endpoint = free_endpoint()
    with child("bus.router", "--connect", endpoint) as router, tempfile.TemporaryDirectory() as home:
        ready(router)
        return {"command": _command(endpoint, home, samples), "feed": _feed(endpoint, feed_s)}


def _command(endpoint: str, home: str, samples: int) -> dict[str, float]:
    ours: list[float] = []
    bare: list[float] = []
    config = NodeConfig(RUN, "asker", connect=endpoint, outsider=True)
    with (
        child("bench.bus", "answer", endpoint, home) as answerer,
        open_node(config) as node,
        open_client(endpoint) as session,
    ):
        ready(answerer)
        query = b"x" * 100
        for number in range(-200, samples):
            start = wall_s()
            node.ask("answerer", Observe("T1"), timeout_s=5.0)
            middle = wall_s()
            replies = list(session.get("bare/answerer", payload=query))
            end = wall_s()
            if len(replies) != 1:
                raise RuntimeError("the bare query was not answered")
            if number >= 0:  # what comes before warms up
                ours.append(middle - start)
                bare.append(end - middle)
    figures = {}
    for name, values in (("ours", ours), ("bare", bare)):
        figures[f"{name}_median_us"] = 1e6 * median(values)
        figures[f"{name}_p99_us"] = 1e6 * quantiles(values, n=100)[98]
    figures["ratio"] = figures["ours_median_us"] / figures["bare_median_us"]
    return figures


def _feed(endpoint: str, feed_s: float) -> dict[str, float]:
    names = [f"watcher{n}" for n in range(SUBSCRIBERS)]
    watchers: list[subprocess.Popen[str]] = []
    with open_node(NodeConfig(RUN, keys.WORLD, connect=endpoint, outsider=True)) as node:
        try:
            watchers = [child("bench.bus", "watch", endpoint, name) for name in names]
            for watcher in watchers:
                ready(watcher)
            sent = _send_frames(node, feed_s)
            delays: list[float] = []
            for watcher in watchers:
                out, _ = watcher.communicate(timeout=20)
                delays.extend(float(word) for word in out.split())
        finally:
            for watcher in watchers:
                watcher.kill()
                watcher.wait()
    return {
        "sent": sent,
        "subscribers": SUBSCRIBERS,
        "missing": sent * SUBSCRIBERS - len(delays),
        "median_ms": 1e3 * median(delays),
        "p99_ms": 1e3 * quantiles(delays, n=100)[98],
        "max_ms": 1e3 * max(delays),
    }


def _send_frames(node: Node, feed_s: float) -> int:
    bodies = tuple(BodyFrame(f"T1.w{n}", f"w{n}", "worker", "T1", 1.0 + n, 2.0) for n in range(BODIES))
    start, count = wall_s(), int(feed_s * FEED_HZ)
    for number in range(count):
        while (left := start + number / FEED_HZ - wall_s()) > 0:
            node.post.wait(left)
        # The wall clock is the same for all processes of a machine, so that a frame can carry when it was sent.
        node.publish(keys.truth_frame(RUN), Frame(wall_s(), number, bodies))
    while (left := start + (count + 10) / FEED_HZ - wall_s()) > 0:
        node.post.wait(left)  # or the last frame might replace one that nobody has read yet
    node.transport.put(keys.truth_frame(RUN), encode(node.post.outbox.seal(Frame(wall_s(), count, ()))))
    return count


# ---------------------------------------------------------------- the processes at the other end
def _answer(endpoint: str, home: str) -> None:
    config = NodeConfig(RUN, "answerer", connect=endpoint, home=Path(home), outsider=True)
    with open_node(config) as node, open_client(endpoint) as session:
        session.declare_queryable("bare/answerer", lambda query: query.reply("bare/answerer", query.payload))
        print("ready", flush=True)
        reply = Observed("T1", {"at(w1)": "(1,3)"})
        for turn in node.turns():
            for request in turn.mail:
                node.reply(request, reply)


def _watch(endpoint: str, name: str) -> None:
    """Note how late frames are, until the last one, which has no bodies."""
    delays: list[str] = []

    with open_node(NodeConfig(RUN, name, connect=endpoint, outsider=True)) as node:

        def on_frame(_: str, payload: bytes) -> None:
            arrived_s = wall_s()
            envelope = decode(payload)
            if isinstance(envelope, Refusal) or not isinstance(envelope.body, Frame):
                return
            if envelope.body.bodies:
                delays.append(f"{arrived_s - envelope.body.at_s:.6f}")
            else:
                node.stop()

        node.transport.subscribe(keys.truth_frame(RUN), on_frame, latest=True)
        print("ready", flush=True)
        for _ in node.turns():
            pass
    print(" ".join(delays))


def main() -> None:
    """Measure and print, or be one of the other processes."""
    if sys.argv[1:2] == ["answer"]:
        return _answer(*sys.argv[2:])
    if sys.argv[1:2] == ["watch"]:
        return _watch(*sys.argv[2:])
    result = run()
    command, feed = result["command"], result["feed"]
    print("command round trip      median      p99")
    for name, label in (("ours", "Node.ask"), ("bare", "bare Zenoh query")):
        print(f"  {label:<18} {command[name + '_median_us']:8.0f} us {command[name + '_p99_us']:8.0f} us")
    print(f"  ratio of medians   {command['ratio']:8.2f}")
    print(f"state feed, {FEED_HZ} Hz to {feed['subscribers']} processes, {feed['sent']} frames")
    print("  " + ", ".join(f"{name[:-3]} {feed[name]:.2f} ms" for name in ("median_ms", "p99_ms", "max_ms")))
    print(f"  missing {feed['missing']} of {feed['sent'] * feed['subscribers']}")
    return None


if __name__ == "__main__":
    main()
