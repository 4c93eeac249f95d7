"""A real terminal for tests, as far as a program can tell: a pseudo terminal with the program in its foreground."""

from __future__ import annotations

import fcntl
import os
import pty
import select
import signal
import struct
import subprocess
import sys
import termios
from collections.abc import Callable

from bus.clock import wall_s

ENTER, LEAVE, HIDE, SHOW = b"\x1b[?1049h", b"\x1b[?1049l", b"\x1b[?25l", b"\x1b[?25h"


class Terminal:
    """A pseudo terminal with a Python program in it; `seen` is all that was written to it."""

    def __init__(self, code: str, columns: int, rows: int) -> None:
        self.master, self.slave = pty.openpty()
        fcntl.ioctl(self.slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        self.before = termios.tcgetattr(self.slave)
        environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "33", "PYTHONIOENCODING": "utf-8"}
        self.process = subprocess.Popen(
            [sys.executable, "-c", code], stdin=self.slave, stdout=self.slave, stderr=self.slave, env=environment,
            start_new_session=True, preexec_fn=self._own,
        )  # fmt: skip
        self.seen = b""

    def _own(self) -> None:
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    def resize(self, columns: int, rows: int) -> None:
        fcntl.ioctl(self.slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        self.process.send_signal(signal.SIGWINCH)

    def until(self, condition: Callable[[], object], limit_s: float = 15.0) -> bool:
        """Read on until the condition holds; false when it does not within the limit."""
        end_s = wall_s() + limit_s
        while not condition():
            left_s = end_s - wall_s()
            if left_s <= 0:
                return False
            if select.select([self.master], [], [], min(left_s, 0.05))[0]:
                self.seen += os.read(self.master, 65536)
        return True

    def widest(self, since: int) -> int:
        """The longest run of line-drawing in what came since then: grows with the terminal."""
        return max((len(run) for run in self.seen[since:].decode(errors="replace").split("┐")), default=0)

    def must_end_clean(self) -> None:
        """The program ends soon, with 0, and the terminal is as it was before."""
        assert self.until(lambda: self.process.poll() is not None), self.seen[-3000:]
        assert self.until(lambda: LEAVE in self.seen), self.seen[-3000:]
        assert self.process.returncode == 0, self.seen[-3000:]
        assert self.seen.rindex(LEAVE) > self.seen.rindex(ENTER)
        assert self.seen.rindex(SHOW) > self.seen.rindex(HIDE)
        assert b"Traceback" not in self.seen
        assert termios.tcgetattr(self.slave) == self.before

    def close(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait(10)
        os.close(self.master)
        os.close(self.slave)
