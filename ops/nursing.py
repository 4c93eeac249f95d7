"""The keeper's side of the nursery (`agents.nursery`): ask for a ready process, and do without it when it is gone."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
from collections.abc import Callable, Mapping, Sequence
from typing import Any

PATIENCE_S = 10.0
"""A nursery that says nothing for so long is given up. To import everything takes a fraction of a second."""


class Nursery:
    """A running nursery; `argv` ends with the modules that it is to import. It is asked for one process at a time.

    Once it has failed to answer, for whatever reason, it is killed and starts nobody any more. Then nobody is on the
    way either: who is being forked holds the pipe of the answers until it has said its process id.
    """

    def __init__(
        self, argv: Sequence[str], log: str, env: Mapping[str, str], before_exec: Callable[[], None] | None
    ) -> None:
        """Start it, without waiting for it. Raises OSError."""
        with open(log, "ab") as file:
            process = subprocess.Popen(
                argv,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=file,
                env=env,
                start_new_session=True,
                preexec_fn=before_exec,  # safe: the keeper has one thread
            )
        process.returncode = 0  # reaped by the keeper; keeps Popen from complaining
        assert process.stdin is not None
        assert process.stdout is not None
        self.pid = process.pid
        self._orders, self._answers = process.stdin, process.stdout
        self._python, self._modules = argv[0], argv[3:]
        self._ready = self._gone = False
        self._buffer = b""

    def start(self, argv: list[str], log: str, env: Mapping[str, str]) -> int:
        """The id of a new process that does what `argv` says, a child of this one; 0 if the nursery cannot."""
        if self._gone or argv[:2] != [self._python, "-m"] or argv[2] not in self._modules:
            return 0
        self._ready = self._ready or self._answer() is not None
        if self._gone:
            return 0
        try:
            os.write(self._orders.fileno(), json.dumps({"argv": argv, "log": log, "env": env}).encode() + b"\n")
        except OSError:
            self.close()
            return 0
        answer = self._answer() or {}
        return int(answer.get("pid", 0))

    def close(self) -> None:
        """End it and wait for its end; nothing happens if it has ended."""
        self._gone = True
        with contextlib.suppress(ProcessLookupError, ChildProcessError):
            os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG)  # still ours
            os.killpg(self.pid, signal.SIGKILL)
            os.waitpid(self.pid, 0)

    def _answer(self) -> dict[str, Any] | None:
        """The next answer. None: there is none, and the nursery is closed."""
        while b"\n" not in self._buffer:
            readable = self._gone or select.select([self._answers], [], [], PATIENCE_S)[0]
            data = os.read(self._answers.fileno(), 65536) if readable else b""
            if data:
                self._buffer += data
            elif self._gone:
                return None
            else:
                self.close()
        line, _, self._buffer = self._buffer.partition(b"\n")
        answer: dict[str, Any] = json.loads(line)
        return answer
