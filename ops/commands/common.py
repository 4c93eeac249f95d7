"""Options that several commands share."""

from __future__ import annotations

import argparse
import os
import sys
from typing import Any

import msgspec

from ops.scenario import Scenario, load


def scenario_options(parser: argparse.ArgumentParser) -> None:
    """SCENARIO and --set."""
    parser.add_argument("scenario", metavar="SCENARIO", help="a path, or domain/name of a shipped scenario")
    overrides_option(parser)


def overrides_option(parser: argparse.ArgumentParser) -> None:
    """--set."""
    parser.add_argument(
        "--set",
        dest="overrides",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="override any key of the scenario: a dotted path, list items by number from 0, a TOML value; repeatable",
    )


def json_option(parser: argparse.ArgumentParser) -> None:
    """--json."""
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def chosen_scenario(args: argparse.Namespace) -> Scenario:
    """The scenario that the options mean. Raises `InputError`."""
    return load(args.scenario, args.overrides)


def print_json(value: Any) -> None:
    """One JSON object, indented for people."""
    print(msgspec.json.format(msgspec.json.encode(value), indent=1).decode())


def has_screen() -> bool:
    """Whether what is printed goes to a terminal on which the dashboard can be drawn."""
    return sys.stdout.isatty() and os.environ.get("TERM", "") not in ("", "dumb", "unknown")


def running_options(parser: argparse.ArgumentParser) -> None:
    """--run and --connect: which running system is meant."""
    parser.add_argument("--run", metavar="NAME", help="name of the run; not needed when only one is running here")
    parser.add_argument(
        "--connect", metavar="ENDPOINT", help="its router, tcp/HOST:PORT, when it is on another machine (with --run)"
    )
    parser.add_argument(
        "--identity", metavar="DIR", help="with --connect tls/HOST:PORT: a copy of the run's folder identities/operator"
    )
