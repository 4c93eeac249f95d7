"""The supervisor's side of the keeper: start and signal children, hear of their starts and ends."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

Report = dict[str, Any]


def environment() -> dict[str, str]:
    """Our environment, such that ``python -m world`` finds our packages and nothing of the user's directory."""
    root = str(Path(__file__).resolve().parents[1])
    path = [root, *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(dict.fromkeys(path)), "PYTHONSAFEPATH": "1"}


class Children:
    """A running keeper. `on_report` is called from a thread of its own with each report of `ops.keeper`, and with
    ``{"what": "lost"}`` if the keeper itself ends before `close`."""

    def __init__(self, on_report: Callable[[Report], None]) -> None:
        self._on_report = on_report
        self._closing = False
        self._lock = threading.Lock()
        # A session of its own: Ctrl-C in the terminal must reach the supervisor alone, which then stops in order.
        self._keeper = subprocess.Popen(
            [sys.executable, "-m", "ops.keeper"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment(),
            start_new_session=True,
        )
        self._reader = threading.Thread(target=self._read, name="keeper", daemon=True)
        self._reader.start()

    @property
    def pid(self) -> int:
        """The keeper's process id."""
        return self._keeper.pid

    def nurse(self, argv: Sequence[str], log: Path) -> None:
        """From now on a nursery makes processes ready where it can; see `ops.processes.nursery`."""
        self._order({"do": "nurse", "argv": list(argv), "log": str(log), "env": environment()})

    def start(self, name: str, argv: Sequence[str], log: Path, env: Mapping[str, str] | None = None) -> None:
        """Start a child; its output is appended to `log`. The outcome comes as a report."""
        whole = {**environment(), **(env or {})}
        self._order({"do": "start", "name": name, "argv": list(argv), "log": str(log), "env": whole})

    def signal(self, name: str, signal: int, number: int = 0) -> None:
        """Signal a child and its helpers; nothing happens if it is gone. The report of it repeats `number`."""
        self._order({"do": "signal", "name": name, "signal": int(signal), "number": number})

    def close(self) -> None:
        """Kill whoever is left and end the keeper."""
        self._closing = True
        with self._lock, contextlib.suppress(OSError):
            if self._keeper.stdin:
                self._keeper.stdin.close()
        self._keeper.wait()
        self._reader.join()
        if self._keeper.stdout:
            self._keeper.stdout.close()

    def _order(self, order: dict[str, object]) -> None:
        with self._lock, contextlib.suppress(BrokenPipeError):
            if self._keeper.stdin and not self._keeper.stdin.closed:
                self._keeper.stdin.write(json.dumps(order) + "\n")
                self._keeper.stdin.flush()

    def _read(self) -> None:
        if self._keeper.stdout:
            for line in self._keeper.stdout:
                self._on_report(json.loads(line))
        if not self._closing:
            self._on_report({"what": "lost"})
