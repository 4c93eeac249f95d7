"""What all tests need."""

from __future__ import annotations

import signal
import threading

if threading.current_thread() is threading.main_thread():
    # A runner that was started in the background ignores interrupts, and its children would too: tests send them.
    signal.signal(signal.SIGINT, signal.default_int_handler)
