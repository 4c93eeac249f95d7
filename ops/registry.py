"""Which systems run on this machine: a small file each, so that ``muster watch`` and ``inject`` find them."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterator
from pathlib import Path

import msgspec

from ops.places import runs
from ops.tables import InputError

LONGEST = 32
"""Signs that the name of a run may have (`bus.keys.NAME`)."""


class Running(msgspec.Struct, frozen=True):
    """One running system: its name, the router's endpoint, its directory, the supervisor's process, and the folder of
    an operator's identity when it is secure."""

    run: str
    connect: str
    home: str
    pid: int
    scenario: str
    identity: str = ""

    def proof(self) -> Path | None:
        """The identity as the bus takes it."""
        return Path(self.identity) if self.identity else None


@contextlib.contextmanager
def registered(running: Running) -> Iterator[None]:
    """Listed for as long as the block runs."""
    file = runs() / f"{running.run}.run"
    temporary = file.with_suffix(".new")
    temporary.write_bytes(msgspec.json.encode(running))
    temporary.rename(file)
    try:
        yield
    finally:
        file.unlink(missing_ok=True)


def listing() -> list[Running]:
    """The systems that run, the latest last; files of those that were killed are removed."""
    found: list[tuple[float, Running]] = []
    for file in runs().glob("*.run"):
        with contextlib.suppress(OSError, msgspec.DecodeError):
            running = msgspec.json.decode(file.read_bytes(), type=Running)
            if _alive(running.pid):
                found.append((file.stat().st_mtime, running))
            else:
                file.unlink(missing_ok=True)
    return [running for _, running in sorted(found, key=lambda pair: pair[0])]


def find(run: str | None = None, connect: str | None = None, identity: str | None = None) -> Running:
    """The system that a user means. Raises `InputError` when there is none or several.

    With `connect` it may be on another machine, and then its name must be given, and an `identity` if it is secure.
    """
    if connect is not None:
        known = [running for running in listing() if running.connect == connect]
        if run is None and not known:
            raise InputError(
                f"--connect {connect}: say which run with --run NAME; muster run prints its name at the start"
            )
        return Running(run or known[-1].run, connect, "", 0, "", identity or "")
    running = listing()
    chosen = [one for one in running if run in (None, one.run)]
    names = ", ".join(one.run for one in running)
    if not chosen:
        here = f"no run {run!r} is running here; there are: {names}" if names else "nothing is running here"
        raise InputError(f"{here}. To reach a run on another machine: --connect tcp/HOST:PORT --run NAME")
    if len(chosen) > 1:
        raise InputError(f"several systems are running: {names}; say which with --run NAME")
    return chosen[0]


def new_name(scenario: str) -> str:
    """A name for a run that no other run on this machine has; a file's name may be longer than what the bus takes as
    a name, and have other signs in it."""
    end = f"-{os.getpid()}"
    plain = re.sub(r"[^A-Za-z0-9_.-]+", "_", scenario).lstrip("_.-") or "run"
    return plain[: LONGEST - len(end)] + end


def own_pid() -> int:
    """Who answers for the run."""
    return os.getpid()


def home_of(run: str) -> Path:
    """The directory of a run that nobody named a place for."""
    home = runs() / run
    home.mkdir(parents=True, exist_ok=True)
    return home


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
