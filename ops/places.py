"""Where things are: shipped scenarios, files named inside scenarios, and the directories of runs."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

from ops.tables import InputError
from reasoning.domain import domains, load

TELLING = 3
"""A name of fewer letters is part of too many others to say which was meant."""


def shipped() -> dict[str, Path]:
    """The scenarios that come with muster: ``domain/name`` -> file."""
    return {f"{domain}/{name}": file for domain in domains() for name, file in load(domain).scenarios.items()}


def runnable() -> dict[str, Path]:
    """Those of them that can be run, and not only planned."""
    return {name: file for name, file in shipped().items() if load(name.split("/")[0]).can_run}


def scenario_file(name: str) -> Path:
    """The file that a user means by a path or by ``domain/name``. Raises `InputError`."""
    if Path(name).is_file():
        return Path(name)
    domain, _, short = name.partition("/")
    if domain in domains() and short in load(domain).scenarios:  # whatever is wrong with another domain
        return load(domain).scenarios[short]
    raise InputError(f"{name}: {missing(name, 'scenario', shipped())}")


def missing(name: str, what: str, known: Iterable[str]) -> str:
    """What to say of a name that is no file and not among the `known` ones, which are `domain/name`."""
    if Path(name).is_dir():
        return f"a directory; expected a file, or a shipped {what} (muster list tells them all)"
    whole = {other: other.split("/")[-1] for other in known}
    stem = Path(name).stem
    close = [short for short in whole.values() if len(stem) >= TELLING and stem in short]
    close = close or get_close_matches(stem, whole.values())
    like = [other for other, short in whole.items() if short in close]
    there = [other for other in like if other.split("/")[0] == name.split("/")[0]]
    meant = f"Did you mean {' or '.join(there or like)}? " if like else ""
    return f"neither a file nor a shipped {what}. {meant}muster list tells them all"


def runs() -> Path:
    """The user's own directory of runs: a file for each running system, and homes of runs without a --record.

    Raises `InputError` if there can be none.
    """
    base = os.environ.get("XDG_RUNTIME_DIR") or os.path.join(tempfile.gettempdir(), f"muster-{os.getuid()}")
    try:
        return made(Path(base) / "muster", mode=0o700)
    except InputError as error:
        raise InputError(f"{error}; set XDG_RUNTIME_DIR to a directory of your own, or unset it") from error


def made(folder: Path, mode: int = 0o777) -> Path:
    """The directory, made if it was not there. Raises `InputError` if that is impossible, or nothing can be written
    into it."""
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=mode)
    except OSError as error:
        raise InputError(f"{folder}: this directory cannot be made: {error.strerror}") from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(f"{folder}: nothing can be written into this directory")
    return folder
