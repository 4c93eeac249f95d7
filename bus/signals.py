"""A process ends soon after SIGTERM or SIGINT, whatever it is doing.

Polite first: the main loop is told to stop. If that takes longer than `GRACE_S`, perhaps because the main thread is
deep in a solver where Python handles no signals, the process ends at once. Nothing is lost: what must not be is in
the journal.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

GRACE_S = 0.5


@contextmanager
def stopping(stop: Callable[[], None]) -> Iterator[None]:
    """Call `stop` on SIGTERM or SIGINT, from another thread: a handler would run in the middle of whatever the main
    thread does, and could lock up with it. Does nothing in a thread other than the main one."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    over = threading.Event()
    guard = threading.Thread(target=_guard, args=(reader, over, stop), name="signals", daemon=True)
    before = {number: signal.signal(number, lambda *_: None) for number in (signal.SIGTERM, signal.SIGINT)}
    wakeup = signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    guard.start()
    try:
        yield
    finally:
        over.set()
        signal.set_wakeup_fd(wakeup)
        for number, handler in before.items():
            signal.signal(number, handler)
        os.close(writer)  # ends the guard, unless a signal did
        guard.join()
        os.close(reader)


def _guard(reader: int, over: threading.Event, stop: Callable[[], None]) -> None:
    """Wait for a signal; from then on the process has `GRACE_S` wall seconds."""
    stop_signals = {signal.SIGTERM, signal.SIGINT}
    while numbers := os.read(reader, 64):
        if stop_signals.intersection(numbers):
            stop()
            if not over.wait(GRACE_S):
                os._exit(0)
            return
