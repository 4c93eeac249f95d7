"""The keeper: a tiny process that owns all child processes of a run, and ends them whatever happens to its own parent.

The supervisor talks to it in lines of JSON over pipes. Why a process of its own: starting children needs a fork,
which does not go together with an open Zenoh session; and a supervisor that is killed with -9 cannot clean up, but its
pipe closes, and the keeper sees that. The keeper has one thread, imports the standard library alone, and starts every
child in a session (hence process group) of its own. On Linux children also get SIGKILL if the keeper itself is killed,
and those that a nursery can make ready (`ops.nursing`) are asked for there first.

Orders, on standard input::

    {"do": "nurse", "argv": [...], "log": "/path/nursery.log", "env": {...}}
    {"do": "start", "name": "T1", "argv": [...], "log": "/path/T1.log", "env": {...}}
    {"do": "signal", "name": "T1", "signal": 9, "number": 17}

Reports, on standard output::

    {"what": "started", "name": "T1", "pid": 4711}
    {"what": "failed", "name": "T1", "reason": "..."}
    {"what": "signalled", "name": "T1", "number": 17}
    {"what": "ended", "name": "T1", "pid": 4711, "code": -9}

End of input, SIGTERM or SIGHUP: every child that is left is killed, then the keeper ends.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from ops.nursing import Nursery

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36


class Keeper:
    """Children by name and by process id; `main` feeds it."""

    def __init__(self, report: Callable[[dict[str, Any]], None]) -> None:
        self._report = report
        self._names: dict[int, str] = {}
        self._pids: dict[str, int] = {}
        self._before_exec = _die_with_parent()
        self._nursery: Nursery | None = None

    def obey(self, order: dict[str, Any]) -> None:
        """Carry out one order; what cannot be done is reported or, for a child that is gone, ignored."""
        if order["do"] == "start":
            self._start(order)
        elif order["do"] == "nurse":
            self._nurse(order)
        elif order["do"] == "signal":
            if order["name"] in self._pids:
                _signal_group(self._pids[order["name"]], order["signal"])
            self._report({"what": "signalled", "name": order["name"], "number": order["number"]})

    def _nurse(self, order: dict[str, Any]) -> None:
        """Have a nursery, where the system lets its processes become our children."""
        if _adopt_orphans():
            with contextlib.suppress(OSError):  # without it all are started plainly
                self._nursery = Nursery(order["argv"], order["log"], _env(order), self._before_exec)

    def _start(self, order: dict[str, Any]) -> None:
        name, pid = order["name"], 0
        if self._nursery is not None:
            pid = self._nursery.start(order["argv"], order["log"], _env(order))
        try:
            pid = pid or self._exec(order)
        except OSError as error:
            self._report({"what": "failed", "name": name, "reason": str(error)})
            return
        self._names[pid], self._pids[name] = name, pid
        self._report({"what": "started", "name": name, "pid": pid})

    def _exec(self, order: dict[str, Any]) -> int:
        with open(order["log"], "ab") as log:
            child = subprocess.Popen(
                order["argv"],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                env=_env(order),
                start_new_session=True,
                preexec_fn=self._before_exec,  # safe: the keeper has one thread
            )
        child.returncode = 0  # reaped below, by waitpid; keeps Popen from complaining
        return child.pid

    def reap(self, *, block: bool = False) -> None:
        """Collect the children that have ended and report each; orphans that were adopted are only collected."""
        while self._names or not block:
            try:
                ended = os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOWAIT | (0 if block else os.WNOHANG))
            except ChildProcessError:
                return
            if ended is None:
                return
            pid = ended.si_pid
            if pid in self._names:
                _signal_group(pid, signal.SIGKILL)  # helpers that it started must not outlive it
            _, status = os.waitpid(pid, 0)
            name = self._names.pop(pid, None)
            if name is None:
                continue
            if self._pids.get(name) == pid:
                del self._pids[name]
            self._report({"what": "ended", "name": name, "pid": pid, "code": os.waitstatus_to_exitcode(status)})

    def kill_all(self) -> None:
        """The way out: nobody is left behind."""
        for pid in self._names:
            _signal_group(pid, signal.SIGKILL)
        self.reap(block=True)
        if self._nursery is not None:
            self._nursery.close()


def _env(order: dict[str, Any]) -> dict[str, str]:
    return {**os.environ, **order["env"]}


def _signal_group(pid: int, number: int) -> None:
    """Signal the whole group of a child. A stopped process would keep SIGTERM for later, so it is woken."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, number)
        if number == signal.SIGTERM:
            os.killpg(pid, signal.SIGCONT)


def _adopt_orphans() -> bool:
    """Become the parent of processes below us whose own parent ends; whether this system can do that."""
    if not sys.platform.startswith("linux"):
        return False
    refused: int = ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    return not refused


def _die_with_parent() -> Callable[[], None] | None:
    """What a child does before exec so that it dies with the keeper; None where the system has no such thing."""
    if not sys.platform.startswith("linux"):
        return None
    prctl, parent = ctypes.CDLL(None, use_errno=True).prctl, os.getpid()

    def before_exec() -> None:
        prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:  # the keeper died in between
            os._exit(1)

    return before_exec


def main() -> None:
    """Run until the input ends."""

    def report(message: dict[str, Any]) -> None:
        with contextlib.suppress(BrokenPipeError):
            sys.stdout.write(json.dumps(message) + "\n")
            sys.stdout.flush()

    woken, wake = os.pipe()
    os.set_blocking(woken, False)
    os.set_blocking(wake, False)
    signal.set_wakeup_fd(wake)
    ending = False

    def end(_number: int, _frame: object) -> None:
        nonlocal ending
        ending = True

    signal.signal(signal.SIGCHLD, lambda _number, _frame: None)
    signal.signal(signal.SIGTERM, end)
    signal.signal(signal.SIGHUP, end)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    keeper, buffer, orders = Keeper(report), b"", sys.stdin.fileno()
    while not ending:
        readable, _, _ = select.select([orders, woken], [], [])
        if woken in readable:
            os.read(woken, 512)
            keeper.reap()
        if orders in readable:
            data = os.read(orders, 65536)
            if not data:
                break
            *lines, buffer = (buffer + data).split(b"\n")
            for line in lines:
                keeper.obey(json.loads(line))
    keeper.kill_all()


if __name__ == "__main__":
    main()
