"""``muster watch``: the dashboard of a running system."""

from __future__ import annotations

import argparse

from bus.transport import TransportError
from ops.commands.common import has_screen, running_options
from ops.registry import find
from ops.tables import InputError

EPILOG = "Any number may watch, from any machine that reaches the router: --connect tcp/HOST:PORT --run NAME."


def configure(parser: argparse.ArgumentParser) -> None:
    running_options(parser)


def execute(args: argparse.Namespace) -> int:
    running = find(args.run, args.connect, args.identity)
    if not has_screen():
        raise InputError("the dashboard needs a terminal; muster run --headless prints lines")
    from ops.dashboard import watch

    try:
        watch(running.connect, running.run, running.proof())
    except TransportError as error:
        raise InputError(str(error)) from error
    return 0
