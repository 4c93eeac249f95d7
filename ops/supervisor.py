"""Starts the processes of a run in order, restarts those that die, stops them in reverse. Nobody is left behind.

One thread, the caller's, owns the state. Other threads (the keeper's reports, the bus, timers of faults) only `post`
functions, which run when the caller pumps: in `until`, `launch` and `stop`. So a run is a sequence of conditions that
are waited for with a limit, never a sleep. Ends of processes are seen by the keeper's waitpid (`ops.keeper`).
"""

from __future__ import annotations

import contextlib
import heapq
import itertools
import queue
import signal
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Literal

from ops.children import Children, Report
from ops.restarts import Restarts
from reasoning.words import count

Post = Callable[[], None]
Say = Callable[[str, str, str], None]

Disturbance = Literal["kill", "pause", "resume", "restart", "stop"]

TERMINATE_S = 5.0
START_S = 30.0
READY_S = 10.0

_SIGNALS: dict[Disturbance, int] = {
    "kill": signal.SIGKILL,
    "pause": signal.SIGSTOP,
    "resume": signal.SIGCONT,
    "restart": signal.SIGTERM,
    "stop": signal.SIGKILL,
}
_ENDED = {"kill": "killed on purpose", "restart": "restarted on purpose", "stop": "stopped on purpose"}


def _nothing() -> None:
    pass


class GaveUpError(Exception):
    """A process died too often, or could not be started: the run cannot go on. The message says why."""


class TooLongError(Exception):
    """A condition did not come true within its limit."""


@dataclass
class Child:
    """One process to be kept alive. `expected` holds why it is about to end, when that is known."""

    name: str
    argv: Sequence[str]
    log: Path
    restarts: Restarts
    state: Literal["new", "starting", "running", "waiting", "ended"] = "new"
    pid: int = 0
    starts: int = 0
    expected: str = ""
    pids: list[int] = field(default_factory=list)
    on_end: list[Post] = field(default_factory=list)


class Supervisor:
    """Use as a context manager; leaving it, by whatever way, ends every process.

    `say(name, state, cause)` hears what becomes of processes (states of the event ``process``); `now` is monotonic
    seconds.
    """

    def __init__(self, now: Callable[[], float], say: Say, budget: int = 5) -> None:
        self._now, self._say, self._budget = now, say, budget
        self._posts: queue.SimpleQueue[Post] = queue.SimpleQueue()
        self._timers: list[tuple[float, int, Post]] = []
        self._numbers = itertools.count()
        self._signalled: dict[int, Post] = {}
        self._ending = self._stopping = False
        self._children: Children | None = None
        self.table: dict[str, Child] = {}

    def __enter__(self) -> Supervisor:
        self._children = Children(lambda report: self.post(partial(self._on_report, report)))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stopping = True
        if self._children:
            self._children.close()

    def post(self, function: Post) -> None:
        """Have `function` run by the thread that pumps. Callable from any thread."""
        self._posts.put(function)

    def nurse(self, argv: Sequence[str], log: Path) -> None:
        """Have a nursery (`ops.processes.nursery`) make processes ready that it can; all others are started plainly,
        and so are these where there can be no nursery, or when it has died."""
        if self._children is not None:
            self._children.nurse(argv, log)

    def launch(self, name: str, argv: Sequence[str], log: Path) -> None:
        """Start a process and keep it alive from now on. Raises `GaveUpError` if it cannot be started at all."""
        child = self.table[name] = Child(name, argv, log, Restarts(self._budget))
        self._start(child)
        self.until(lambda: child.state != "starting", START_S, f"{name} started")

    def disturb(self, kind: Disturbance, name: str, done: Post = _nothing) -> str:
        """A fault on purpose; `done` is called when it has taken effect. Returns why it is impossible, or nothing."""
        child = self.table.get(name)
        if child is None or child.state != "running":
            done()
            if child is None:
                return f"no process {name!r}; there are {', '.join(self.table)}"
            return f"{name} is not running just now"
        if kind in _ENDED:
            child.expected = _ENDED[kind]
            child.on_end.append(done)
            self._signal(child, _SIGNALS[kind])
        else:
            self._signal(child, _SIGNALS[kind], done)
        return ""

    def until(self, condition: Callable[[], bool], limit_s: float, what: str) -> None:
        """Pump until `condition` holds. Raises `TooLongError` naming `what`, or `GaveUpError`."""
        deadline = self._now() + limit_s
        while not condition():
            if self._now() >= deadline:
                raise TooLongError(f"waited {limit_s:g} s for: {what}")
            self._pump(deadline)

    def stop(self) -> None:
        """End every process that is left, one after the other, the last started first."""
        for name in list(reversed(self.table)):
            self.stop_together([name])

    def stop_together(
        self, names: Sequence[str], limit_s: float | None = None, ready: Callable[[], bool] = lambda: True
    ) -> None:
        """End these processes at once: SIGTERM, and SIGKILL after `limit_s`. From now on nobody is started again.

        First they have `READY_S` to become `ready`: who is told to end while it still starts does none of its work.
        """
        self._ending = True
        leaving = [self.table[name] for name in names if name in self.table]
        gone = partial(self._ended, leaving)
        with contextlib.suppress(TooLongError):
            self.until(lambda: gone() or ready(), READY_S, f"{', '.join(names)} ready")
        for child in leaving:
            if child.state in ("running", "starting"):
                child.expected = "stopped"
                self._signal(child, signal.SIGTERM)
            else:
                child.state = "ended"
        try:
            self.until(gone, limit_s or TERMINATE_S, f"{', '.join(names)} stopped")
        except TooLongError:
            for child in leaving:
                self._signal(child, signal.SIGKILL)
            self.until(gone, TERMINATE_S, f"{', '.join(names)} killed")

    def _ended(self, children: Sequence[Child]) -> bool:
        return all(child.state == "ended" for child in children)

    def _pump(self, deadline: float) -> None:
        """Run what is due: one posted function, or the timers, or wait for either until the deadline."""
        while self._timers and self._timers[0][0] <= self._now():
            heapq.heappop(self._timers)[2]()
        until = min([deadline, *(at for at, _, _ in self._timers[:1])])
        try:
            post = self._posts.get(timeout=max(0.0, until - self._now()))
        except queue.Empty:
            return
        post()

    def _start(self, child: Child) -> None:
        if self._ending or self._stopping or self._children is None:
            child.state = "ended"
            return
        child.state, child.starts = "starting", child.starts + 1
        self._children.start(child.name, child.argv, child.log)

    def _signal(self, child: Child, number: int, done: Post = _nothing) -> None:
        order = next(self._numbers)
        self._signalled[order] = done
        if self._children is not None and child.state in ("starting", "running"):
            self._children.signal(child.name, number, order)

    def _on_report(self, report: Report) -> None:
        if self._stopping:
            return
        if report["what"] == "lost":
            raise GaveUpError("the keeper of the processes was killed, and they with it")
        if report["what"] == "signalled":
            self._signalled.pop(report["number"])()
            return
        child = self.table[report["name"]]
        if report["what"] == "started":
            child.state, child.pid = "running", report["pid"]
            child.pids.append(child.pid)
            self._say(child.name, "started" if child.starts == 1 else "restarted", f"pid {child.pid}")
        elif report["what"] == "failed":
            raise GaveUpError(f"{child.name} cannot be started: {report['reason']}")
        else:
            self._on_end(child, report["code"])

    def _on_end(self, child: Child, code: int) -> None:
        cause, child.expected = child.expected or _cause(code, child.log), ""
        waiting, child.on_end = child.on_end, []
        for done in waiting:
            done()
        if cause == "stopped" or self._ending:
            child.state = "ended"
            self._say(child.name, "stopped", "")
            return
        self._say(child.name, "died", cause)
        if cause == _ENDED["stop"]:
            child.state = "ended"
            return
        wait_s = child.restarts.died(self._now())
        if wait_s is None:
            child.state = "ended"
            reason = f"{child.name} died {count(child.starts, 'time')}, last: {cause}; see {child.log}"
            self._say(child.name, "gave_up", reason)
            raise GaveUpError(reason)
        child.state = "waiting"
        restart: Post = partial(self._start, child)
        heapq.heappush(self._timers, (self._now() + wait_s, next(self._numbers), restart))


def _cause(code: int, log: Path) -> str:
    """The name of an end that nobody asked for, with the last words in the process's log."""
    if code < 0:
        return f"killed by {signal.Signals(-code).name}"
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - 2000))
            words = file.read().decode(errors="replace").strip().splitlines()[-1:]
    except OSError:
        words = []
    return f"ended by itself with exit code {code}{''.join(f' ({line[:200]})' for line in words if code)}"
