"""Child processes on loopback ports, for the benchmarks."""

from __future__ import annotations

import socket
import subprocess
import sys


def free_endpoint() -> str:
    """A loopback endpoint that nobody listened on a moment ago."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def child(module: str, *args: str) -> subprocess.Popen[str]:
    """Start ``python -m module args`` with pipes. As a context manager it is killed at the end."""
    return _Child(
        [sys.executable, "-m", module, *args], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
    )


def ready(process: subprocess.Popen[str]) -> None:
    """Wait until it has printed its first line.

    Raises RuntimeError when it ends before that.
    """
    if process.stdout is None or not process.stdout.readline():
        raise RuntimeError(f"{process.args!r} ended with {process.wait()}")


class _Child(subprocess.Popen[str]):
    def __exit__(self, *args: object) -> None:
        self.kill()
        super().__exit__(*args)  # type: ignore[arg-type]
