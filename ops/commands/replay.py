"""``muster replay``: the dashboard from a recording."""

from __future__ import annotations

import argparse
from math import inf
from pathlib import Path

from ops.commands.common import has_screen
from ops.tables import InputError


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("recording", metavar="DIR", type=Path, help="a recording, of muster run --record DIR")
    parser.add_argument("--speed", metavar="X", type=float, default=1.0, help="simulated per wall seconds (default 1)")


def execute(args: argparse.Namespace) -> int:
    if not 0 < args.speed < inf:
        raise InputError(f"--speed {args.speed:g}: expected a number, more than 0")
    if not has_screen():
        raise InputError("the dashboard needs a terminal")
    from ops.replay import replay

    try:
        replay(args.recording, args.speed)
    except FileNotFoundError as error:
        raise InputError(str(error)) from error
    return 0
