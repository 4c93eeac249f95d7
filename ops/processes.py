"""Which processes a run consists of and how each is started: one place, for the supervisor and for docker-compose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from bus.access import OPERATOR

ROUTER, RECORDER, WORLD, COORDINATOR, SUPERVISOR = "router", "recorder", "world", "coordinator", "supervisor"
PLACES = ("bench", "gone")
"""Where a robot can be besides in a team."""
NURSERY, NURSED = "nursery", ("agents.coordinator", "agents.team")
"""What the nursery's log is called, and the modules that it makes ready."""
RESERVED = frozenset({NURSERY, ROUTER, RECORDER, WORLD, COORDINATOR, SUPERVISOR, "dashboard", OPERATOR, *PLACES})
"""What no team may be called, in whatever case: files and identities have these names, too."""


@dataclass(frozen=True)
class Layout:
    """What the commands of a run depend on. `home` holds journals and logs, `setups` the NAME.json files, `listen` is
    where the router listens if that differs from where the others connect to; `identities` has a folder for each
    process when the run is secure (see `bus.access`)."""

    run: str
    teams: Sequence[str]
    connect: str
    home: PurePath
    setups: PurePath
    record: PurePath
    clock: str = "fast"
    seed: int = 0
    python: str = "python"
    listen: str = ""
    identities: PurePath | None = None


def commands(layout: Layout) -> dict[str, list[str]]:
    """The command of each process, in the order in which they are started."""
    router = [layout.python, "-m", "bus.router", "--connect", layout.listen or layout.connect]
    result = {ROUTER: [*router, *_identity(layout, ROUTER)]}
    result[RECORDER] = [*_start(layout, "ops.recorder", RECORDER), "--record", str(layout.record)]
    result[WORLD] = [*_start(layout, "world", WORLD), *_setup(layout, WORLD)]
    result[COORDINATOR] = [*_start(layout, "agents.coordinator", COORDINATOR), *_setup(layout, COORDINATOR)]
    for team in layout.teams:
        result[team] = [*_start(layout, "agents.team", team), *_setup(layout, team)]
    return result


def nursery(python: str) -> list[str]:
    """The command of the nursery: it saves time, and nothing depends on it."""
    return [python, "-m", "agents.nursery", *NURSED]


def _start(layout: Layout, module: str, name: str) -> list[str]:
    command = [layout.python, "-m", module, "--run", layout.run, "--name", name, "--connect", layout.connect]
    command += ["--home", str(layout.home), "--clock", layout.clock, "--seed", str(layout.seed)]
    return [*command, *_identity(layout, name)]


def _identity(layout: Layout, name: str) -> list[str]:
    return ["--identity", str(layout.identities / name)] if layout.identities else []


def _setup(layout: Layout, name: str) -> list[str]:
    return ["--setup", str(layout.setups / f"{name}.json")]
