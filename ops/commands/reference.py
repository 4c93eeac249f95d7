"""``muster reference``: write the reference pages of the documentation."""

from __future__ import annotations

import argparse
from pathlib import Path

from ops.commands.common import json_option, print_json
from ops.places import made

DOCS = Path("docs/reference")


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, default=DOCS, help="directory for the pages (default %(default)s)"
    )
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    from ops.reference import pages  # not before: it asks every command for its options, this one too

    made(args.output)
    files = []
    for name, text in pages().items():
        (args.output / name).write_text(text, encoding="utf-8")
        files.append(str(args.output / name))
    if args.json:
        print_json({"files": files})
    else:
        print("\n".join(files))
    return 0
