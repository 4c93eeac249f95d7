"""What a run shows to people while it goes on: nothing, plain lines, or the dashboard."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, TextIO

from bus.messages import Envelope, Event
from bus.transport import Transport

if TYPE_CHECKING:
    from ops.dashboard import Model, Picture

# Too many for a reader: their essence is in the others. The recording has them all.
QUIET = frozenset({"started", "step_started", "step_ended", "membership", "question", "refused"})


class Silence:
    """Nothing, for ``--json``."""

    def begin(self, run: str, transport: Callable[[], Transport], stop: Callable[[], None]) -> None:
        pass

    def event(self, envelope: Envelope) -> None:
        pass

    def end(self) -> None:
        pass


class Lines:
    """One line an event: simulated time, who, what. Steps are counted, so that long work shows that it goes on."""

    def __init__(self, out: TextIO | None = None) -> None:
        self._out = out or sys.stdout
        self._step = -1

    def begin(self, run: str, transport: Callable[[], Transport], stop: Callable[[], None]) -> None:
        print(f"run {run}", file=self._out, flush=True)

    def event(self, envelope: Envelope) -> None:
        body = envelope.body
        if not isinstance(body, Event):
            return
        text = str(body.data.get("text") or body.kind)
        step = body.data.get("step")
        if body.kind == "step_started" and isinstance(step, int) and step > self._step:
            self._step, text = step, f"step {step}"
        elif body.kind in QUIET and not body.data.get("recovered"):
            return
        print(f"{envelope.at_s:8.2f} s  {envelope.src:<12} {text}", file=self._out, flush=True)

    def end(self) -> None:
        pass


class Screen:
    """The live dashboard, in a thread of its own; ``q`` ends the run."""

    def __init__(self) -> None:
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._error: BaseException | None = None

    def begin(self, run: str, transport: Callable[[], Transport], stop: Callable[[], None]) -> None:
        self._thread = threading.Thread(target=self._show, args=(run, transport, stop), name="dashboard")
        self._thread.start()

    def event(self, envelope: Envelope) -> None:
        pass

    def end(self) -> None:
        """Give the terminal back, whatever way the run ends; a failure of the dashboard is told then."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join()
        if self._error is not None:
            print(f"the dashboard failed: {self._error!r}", file=sys.stderr)

    def _show(self, run: str, transport: Callable[[], Transport], stop: Callable[[], None]) -> None:
        from ops.dashboard import Feed, Model, Picture, show

        try:
            feed = Feed(transport(), run)
            model: Model = Model(run=run)

            def turn(pressed: list[str]) -> Picture:
                nonlocal model
                model = feed.fold(model)
                return Picture(model)

            show(turn, self._stop)
        except BaseException as error:
            self._error = error
        else:
            if not self._stop.is_set():
                stop()
