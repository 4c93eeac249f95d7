"""``muster replay``: the dashboard from a recording, at any speed, with pause and steps."""

from __future__ import annotations

import threading
from bisect import bisect_right
from pathlib import Path

from bus.clock import wall_s
from bus.messages import Envelope, Event
from bus.signals import stopping
from ops.dashboard.model import Model, update
from ops.dashboard.screen import Picture, show
from ops.recording import Recording, load

KEYS = "space pause ←→ step ↑↓ speed tab team q quit"


class Player:
    """Where a replay stands. `turn` is called with the keys pressed and returns what to show."""

    def __init__(self, recording: Recording, speed: float = 1.0) -> None:
        """`speed`: simulated seconds per second of the wall. Raises ValueError if it is not positive."""
        if speed <= 0:
            raise ValueError(f"speed must be greater than 0, not {speed}")
        self._recording = recording
        self._messages = recording.everything()
        self._times = [message.at_s for message in self._messages]
        self._marks = step_times(self._messages)
        self._speed = speed
        self.paused = False
        self._wall_s = wall_s()
        self.at_s = self._times[0] if self._times else 0.0
        self._shown = 0
        self._model = self._start()

    @property
    def ended(self) -> bool:
        return self._shown >= len(self._messages)

    def turn(self, pressed: list[str]) -> Picture:
        """Let the time pass since the last call, act on keys, fold in what has come due."""
        wall, before = wall_s(), self._wall_s
        self._wall_s = wall
        for key in pressed:
            self._act(key)
        if not self.paused and not self.ended:
            self.at_s += (wall - before) * self._speed
        self._seek()
        note = "end of the recording" if self.ended else "paused" if self.paused else f"replay x{self._speed:g}"
        if not self._recording.complete:
            note += " (cut off)"
        return Picture(self._model, note)

    def _act(self, key: str) -> None:
        if key == " ":
            self.paused = not self.paused
        elif key in ("right", "left"):
            self.paused = True
            later = [t for t in self._marks if t > self.at_s + 1e-9]
            earlier = [t for t in self._marks if t < self.at_s - 1e-9]
            if key == "right":
                self.at_s = later[0] if later else self._times[-1] if self._times else 0.0
            else:
                self.at_s = earlier[-1] if earlier else self._times[0] if self._times else 0.0
        elif key in ("up", "down"):
            self._speed = min(max(self._speed * (2 if key == "up" else 0.5), 1 / 64), 1024.0)

    def _seek(self) -> None:
        due = bisect_right(self._times, self.at_s)
        if due < self._shown:  # backwards: a model knows no way back, so fold from the start
            self._shown, self._model = 0, self._start()
        for message in self._messages[self._shown : due]:
            self._model = update(self._model, message)
        self._shown = due

    def _start(self) -> Model:
        model = Model(run=self._recording.run)
        return update(model, self._recording.scene) if self._recording.scene else model


def step_times(messages: list[Envelope]) -> list[float]:
    """The moments at which a step begins or everything is over."""
    kinds = ("step_started", "run_over")
    times = {m.at_s for m in messages if isinstance(m.body, Event) and m.body.kind in kinds}
    return sorted(times)


def replay(path: str | Path, speed: float = 1.0) -> None:
    """Show a recording until ``q``, Ctrl-C or SIGTERM; it stays at its end.

    Raises FileNotFoundError when there is no recording.
    """
    player = Player(load(path), speed)
    stop = threading.Event()
    with stopping(stop.set):
        show(player.turn, stop, keys=KEYS)
