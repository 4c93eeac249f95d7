"""From the bus to the model: everything that a watcher may hear, folded in when the watcher has time for it."""

from __future__ import annotations

import threading
from dataclasses import replace
from pathlib import Path
from queue import Empty, SimpleQueue

from bus import keys
from bus.clock import wall_s
from bus.codec import Refusal, decode, decode_as
from bus.messages import Envelope
from bus.scene import Scene
from bus.signals import stopping
from bus.transport import Transport
from ops.dashboard import screen
from ops.dashboard.model import Model, update

WAITING = 50_000
"""Messages waiting at most: more means that the terminal hangs, and the newest state comes anyway."""
QUIET_S = 5.0


class Feed:
    """Subscribes to a run's streams. A late joiner gets the scene and everybody's last status at once."""

    def __init__(self, transport: Transport, run: str) -> None:
        self._queue: SimpleQueue[tuple[str, bytes]] = SimpleQueue()
        self._heard_s = wall_s()
        self._scene_key = keys.truth_scene(run)
        transport.subscribe(self._scene_key, self._put, history=True)
        transport.subscribe(keys.status(run, "*"), self._put, history=True)
        transport.subscribe(keys.event(run, "*"), self._put)
        transport.subscribe(keys.beat(run, "*"), self._put)
        transport.subscribe(keys.truth_frame(run), self._put, latest=True)

    def _put(self, key: str, payload: bytes) -> None:
        if self._queue.qsize() < WAITING:
            self._queue.put((key, payload))

    def take(self) -> list[Envelope | Scene]:
        """What has arrived since the last time and can be understood."""
        out: list[Envelope | Scene] = []
        try:
            while len(out) < WAITING:
                key, payload = self._queue.get_nowait()
                value = decode_as(payload, Scene) if key == self._scene_key else decode(payload)
                if not isinstance(value, Refusal):
                    out.append(value)
        except Empty:
            pass
        return out

    def fold(self, model: Model) -> Model:
        """The model after all that has arrived."""
        now = wall_s()
        for message in self.take():
            model = update(model, message, now)
            self._heard_s = now
        # The clock goes on in silence too, or nobody would be seen to be silent; a new value means a new picture.
        if model.clock_s is None or now - model.clock_s >= 1.0:
            model = replace(model, clock_s=now)
        return model

    def note(self) -> str:
        """What to say beside the clock: that nothing is heard any more, or yet."""
        silence = wall_s() - self._heard_s
        return f"nothing heard for {silence:.0f} s" if silence >= QUIET_S else ""


def watch(connect: str, run: str, identity: Path | None = None) -> None:
    """The dashboard of a running system, until ``q``, Ctrl-C or SIGTERM. Any number may watch, from anywhere.

    Raises `bus.transport.TransportError` when the router cannot be reached.
    """
    from bus.zenoh_transport import connect as open_transport  # slow to import, and a replay does not need it

    transport = open_transport(connect, identity)
    stop = threading.Event()
    try:
        with stopping(stop.set):
            feed = Feed(transport, run)
            model = Model(run=run)

            def turn(pressed: list[str]) -> screen.Picture:
                nonlocal model
                model = feed.fold(model)
                return screen.Picture(model, feed.note())

            screen.show(turn, stop)
    finally:
        transport.close()
