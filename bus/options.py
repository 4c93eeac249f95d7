"""The options that every process takes; see *Processes* in docs/architecture.md."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from pathlib import Path
from typing import Literal, NamedTuple

from bus.keys import NAME

Mode = Literal["fast", "realtime"]


class NodeConfig(NamedTuple):
    """Who a node is and how it reaches the others.

    `home` is the run's directory, None to keep the journal in memory. `factor` is simulated per wall seconds in
    ``realtime``. An `outsider` (supervisor, command line, recorder) watches the clock but takes no part in it: its
    mail is handled as it arrives and its timers run on the wall. `identity` is the folder of its certificate, for a
    secure router (see `bus.access`).
    """

    run: str
    name: str
    connect: str = "tcp/127.0.0.1:7447"
    home: Path | None = None
    setup: Path | None = None
    mode: Mode = "fast"
    factor: float = 1.0
    seed: int = 0
    outsider: bool = False
    identity: Path | None = None


def arguments(argv: list[str] | None = None, *, name: str = "") -> NodeConfig:
    """Read the options of a process from `argv`, and from MUSTER_RUN, MUSTER_NAME, ... for what is not given there.

    `name` is the process's name unless another is given. Wrong options end the process with exit code 2 and a
    message.
    """
    parser = argparse.ArgumentParser(
        description="A process of muster. Every option may be given as MUSTER_RUN, MUSTER_NAME, ..."
    )

    def add(option: str, convert: Callable[[str], object], text: str) -> None:
        # argparse converts a default that is a string as if it had been given.
        default = os.environ.get(f"MUSTER_{option.upper()}") or None
        parser.add_argument(f"--{option}", type=convert, default=default, help=text)

    add("run", _name, "name of the run")
    add("name", _name, "name of this process")
    add("connect", str, "the router's endpoint, tcp/HOST:PORT or tls/HOST:PORT")
    add("home", Path, "directory of the run, for journals; none: nothing is kept")
    add("setup", _file, "file that tells the process what it must know")
    add("identity", Path, "folder of this process's certificate, for a secure router")
    add("clock", _clock, "fast, realtime, or realtime:FACTOR (simulated per wall seconds)")
    add("seed", int, "seed of everything random")
    given = vars(parser.parse_args(argv))
    given["name"] = given["name"] or name or None
    for option in ("run", "name"):
        if given[option] is None:
            parser.error(f"--{option} is missing (or MUSTER_{option.upper()})")
    clock: tuple[Mode, float] = given.pop("clock") or ("fast", 1.0)
    said = {key: value for key, value in given.items() if value is not None}
    return NodeConfig(mode=clock[0], factor=clock[1], **said)


def _name(text: str) -> str:
    if not NAME.fullmatch(text):
        raise argparse.ArgumentTypeError(f"{text!r} is not a name: letters, digits, '_', '-' and '.' only")
    return text


def _file(text: str) -> Path:
    if not Path(text).is_file():
        raise argparse.ArgumentTypeError(f"there is no file {text!r}")
    return Path(text)


def _clock(text: str) -> tuple[Mode, float]:
    mode, _, factor = text.partition(":")
    try:
        value = float(factor or 1.0)
    except ValueError:
        value = 0.0
    if mode == "fast" and not factor:
        return "fast", 1.0
    if mode == "realtime" and 0.0 < value < 1e6:
        return "realtime", value
    raise argparse.ArgumentTypeError(f"{text!r} is none of: fast, realtime, realtime:FACTOR with FACTOR > 0")
