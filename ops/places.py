"""Where things are: shipped scenarios, files named inside scenarios, and the directories of runs."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from ops.tables import InputError
from reasoning.domain import domains, load


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
    known = shipped()
    near = [other for other in known if name.split("/")[-1] in other] or list(known)
    raise InputError(f"{name}: neither a file nor a shipped scenario. There are: {', '.join(near)}")


def runs() -> Path:
    """The user's own directory of runs: a file for each running system, and homes of runs without a --record."""
    base = os.environ.get("XDG_RUNTIME_DIR") or os.path.join(tempfile.gettempdir(), f"muster-{os.getuid()}")
    folder = Path(base) / "muster"
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    return folder
