"""``muster bench NAME``: run ``bench/NAME.py`` of the checkout."""

from __future__ import annotations

import argparse
import importlib.util
import sys
from pathlib import Path

from ops.commands.common import json_option, print_json
from ops.tables import InputError

FOLDER = Path(__file__).resolve().parents[2] / "bench"


def configure(parser: argparse.ArgumentParser) -> None:
    names = ", ".join(_names()) or "none here"
    parser.add_argument("name", metavar="NAME", help=f"which benchmark: {names}")
    json_option(parser)
    rest = parser.add_argument(
        "options", nargs=argparse.REMAINDER, help="options of the benchmark; NAME --help tells them"
    )
    rest.required = False  # else a missing NAME is told as if both were missing


def execute(args: argparse.Namespace) -> int:
    if not FOLDER.is_dir():
        raise InputError(
            "the benchmarks are not part of an installed muster: run this from a checkout of its repository"
        )
    if args.name not in _names():
        raise InputError(f"no benchmark {args.name!r}; there are: {', '.join(_names())}")
    # By path: ``bench`` is a folder of scripts, not a package of ours.
    sys.path.insert(0, str(FOLDER.parent))
    spec = importlib.util.spec_from_file_location(f"bench_{args.name}", FOLDER / f"{args.name}.py")
    if spec is None or spec.loader is None:
        raise InputError(f"{FOLDER / args.name}.py cannot be loaded")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    own = [word for word in args.options if word != "--json"]
    if {"-h", "--help"} & set(own) and not hasattr(module, "options"):  # it has none of its own to tell
        print(module.__doc__)
        return 0
    sys.argv = [str(FOLDER / f"{args.name}.py"), *own]
    if not args.json and own == args.options:
        module.main()
        return 0
    try:
        print_json(module.run())
    except KeyboardInterrupt as stopped:
        for figures in stopped.args:  # what was measured till then
            print_json(figures)
        raise
    return 0


def _names() -> list[str]:
    """A benchmark is a script with a function `run`, which gives the figures, and `main`, which prints them."""
    return sorted(file.stem for file in FOLDER.glob("*.py") if "\ndef run(" in file.read_text(encoding="utf-8"))
