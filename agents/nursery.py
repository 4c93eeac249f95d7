"""The nursery: ``python -m agents.nursery MODULE ...`` imports modules once, and forks a ready process on request.

Starting an agent plainly costs a quarter of a second of processor time, most of it for importing; a fork costs a few
thousandths. What is forked runs the module's `main`, as ``python -m MODULE ...`` would, with arguments, environment,
log and session of its own, and `ps` shows it under that command.

Orders, on standard input::

    {"argv": ["python", "-m", "agents.team", ...], "log": "/path/T1.log", "env": {...}}

Answers, on standard output: ``{}`` when all is imported; then for each order ``{"pid": 4711}``, said by the new process
itself before it begins, or ``{"pid": 0}`` if there is none.

The new process is a child of the nursery's parent, which must be a subreaper (prctl(2)): the process between the two
ends at once. So it outlives the nursery, dies with that parent, and is reaped by it. The nursery itself opens no
session and starts no thread: neither survives a fork. End of input ends it. Linux only.
"""

from __future__ import annotations

import ctypes
import gc
import importlib
import json
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bus import zenoh_transport  # noqa: F401  a process that opens its node imports it then

Order = dict[str, Any]

_PR_SET_PDEATHSIG = 1


def main(modules: list[str]) -> int:
    """Serve until the input ends; in a forked process: be what was ordered."""
    gc.disable()  # nothing is garbage yet, and a collection would leave holes in pages that are to be shared
    mains = {name: importlib.import_module(name) for name in modules}
    gc.freeze()
    parent = os.getppid()
    answers = os.dup(1)
    os.dup2(2, 1)
    _say(answers, {})
    for order in _orders():
        if not _forked(order, parent, answers):
            continue
        os.close(answers)
        gc.enable()
        module = mains[order["argv"][2]]
        sys.argv = [str(module.__file__), *order["argv"][3:]]
        code: int = module.main()
        return code
    return 0


def _orders() -> Iterator[Order]:
    buffer = b""
    while data := os.read(0, 65536):
        *lines, buffer = (buffer + data).split(b"\n")
        for line in lines:
            yield json.loads(line)


def _say(answers: int, answer: dict[str, int]) -> None:
    os.write(answers, json.dumps(answer).encode() + b"\n")


def _forked(order: Order, parent: int, answers: int) -> bool:
    """Fork twice; true in the new process, when everything is as it wants it. In between only `os._exit` is safe."""
    try:
        between = os.fork()
    except OSError:
        _say(answers, {"pid": 0})
        return False
    if between:
        _, status = os.waitpid(between, 0)
        if status:
            _say(answers, {"pid": 0})
        return False
    try:
        log = os.open(order["log"], os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
        between = os.getpid()
        if os.fork():
            os._exit(0)
    except OSError:
        os._exit(1)
    while os.getppid() == between:
        os.sched_yield()
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it died in between
        os._exit(1)
    os.setsid()
    null = os.open(os.devnull, os.O_RDONLY)
    for number, file in enumerate((null, log, log)):
        os.dup2(file, number)
    os.close(null)
    os.close(log)
    os.environ.clear()
    os.environ.update(order["env"])
    _rename(" ".join(order["argv"]))
    _say(answers, {"pid": os.getpid()})
    return True


def _rename(command: str) -> None:
    """Have `ps` show this command, as far as there is room: it is written over the arguments and the environment that
    this process was started with (proc(5), cmdline). The environment in use lies elsewhere since it was set anew."""
    fields = Path("/proc/self/stat").read_text().rpartition(")")[2].split()
    first, room = int(fields[45]), int(fields[48]) - int(fields[45])
    if first:
        ctypes.memmove(first, os.fsencode(command)[: room - 1].ljust(room, b"\0"), room)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
