"""What all tests need."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator

import pytest

if threading.current_thread() is threading.main_thread():
    # A runner that was started in the background ignores interrupts, and its children would too: tests send them.
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def _searches_end() -> Iterator[None]:
    """A search that nobody waits for any more (`ops.patience.begun`) takes no time from the next test, and is over
    when the interpreter ends: a thread that is in the solver then aborts it."""
    yield
    for thread in threading.enumerate():
        if thread.name == "search":
            thread.join(60)
            assert not thread.is_alive(), "a search goes on although its time is over"
