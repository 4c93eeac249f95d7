"""The command line: ``muster COMMAND ...``.

Exit codes: 0 goal reached and invariants held; 1 not reached; 2 wrong input; 3 an invariant broken; 130 interrupted.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import sys
import threading
from collections.abc import Sequence
from typing import NoReturn

from bus.clock import wall_s
from ops.commands import COMMANDS
from ops.tables import InputError, dotted
from reasoning.domain import DomainError

INTERRUPTED = 130

_EPILOG = """\
A SCENARIO is a path, or domain/name of one that comes with muster (muster list).
Exit codes: 0 goal reached, verdict and invariants hold; 1 not so; 2 wrong input; 3 an invariant of the recording is
broken; 130 interrupted. Every command that prints for people prints JSON with --json.
"""


def parser(wanted: str | None = None) -> argparse.ArgumentParser:
    """The parser; options are declared for the command `wanted` alone."""
    top = argparse.ArgumentParser(
        prog="muster",
        description="Teams of robots that plan together, act in a world that misbehaves, find out why, and recover.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="store_true", help="print the version and exit")
    subparsers = top.add_subparsers(dest="command", metavar="COMMAND", title="commands")
    for name, text in COMMANDS.items():
        sub = subparsers.add_parser(name, help=text, description=text[0].upper() + text[1:] + "." * (text[-1] != "?"))
        if name == wanted:
            module = importlib.import_module(f"ops.commands.{name}")
            sub.formatter_class = argparse.RawDescriptionHelpFormatter
            sub.epilog = getattr(module, "EPILOG", None)
            module.configure(sub)
            sub.set_defaults(complain=sub.error)
    return top


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    began = wall_s()
    words = list(sys.argv[1:] if argv is None else argv)
    top = parser(next((word for word in words if not word.startswith("-")), None))
    args, unknown = top.parse_known_args(words, argparse.Namespace(began=began, complain=top.error))
    if unknown:  # said by the command itself, with its usage
        args.complain(f"unrecognized arguments: {' '.join(unknown)}")
    if args.version:
        from importlib.metadata import PackageNotFoundError, version

        try:
            print(f"muster {version('muster')}")
        except PackageNotFoundError:
            print("muster (not installed: run from a checkout)")
        return 0
    if args.command is None:
        top.print_help()
        return 2
    try:
        return int(importlib.import_module(f"ops.commands.{args.command}").execute(args))
    except (InputError, DomainError) as error:
        said = str(error) + _set_by_hand(str(error), getattr(args, "overrides", []))
        if getattr(args, "json", False):
            print(json.dumps({"error": said}))
        print(f"muster {args.command}: {said}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # somebody piped us into head: not an error, but Python must not try to flush
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _set_by_hand(error: str, overrides: Sequence[str]) -> str:
    """The --set that an error is about, if any: then it is not the file that is wrong."""
    about = [one for one in overrides if f" {dotted(one.partition('=')[0].strip().split('.'))}: " in error]
    return f" (--set {about[-1]})" if about else ""


def script() -> NoReturn:
    """`main` as a process of its own."""
    code = main()
    sys.stdout.flush()
    if any(thread.daemon for thread in threading.enumerate()):
        os._exit(code)  # a search is in a call that cannot be interrupted, and must not meet the solver's own end
    sys.exit(code)


if __name__ == "__main__":
    script()
