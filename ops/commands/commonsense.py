"""``muster commonsense build``: a commonsense base from a ConceptNet assertions file."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

from ops.commands.common import json_option, print_json
from ops.commonsense import Built, Seen, build, relations
from ops.tables import InputError
from reasoning.domain import domains, load
from reasoning.words import count

EPILOG = """\
ASSERTIONS is a file of ConceptNet 5.7, as conceptnet-assertions-5.7.0.csv.gz: five fields between tabs a line. Lines
that are malformed are counted and skipped. Exit code 0: the base was written; 2: a file cannot be read or written.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action", choices=["build"], help="what to do: build a base")
    parser.add_argument("assertions", metavar="ASSERTIONS", type=Path, help="the assertions, as .csv or .csv.gz")
    parser.add_argument(
        "--threshold", metavar="W", type=_weight, default=1.0, help="least weight of an assertion (default: 1)"
    )
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, required=True, help="where to write the facts")
    parser.add_argument("--domain", metavar="D", help="whose facts; not needed when only one domain has such a base")
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    having = [name for name in domains() if (load(name).folder / "commonsense").is_dir()]
    if args.domain is None and len(having) != 1:
        raise InputError(f"--domain: say for which domain; there are: {', '.join(having) or 'none with such a base'}")
    domain = load(args.domain or having[0])
    if not args.assertions.is_file():
        raise InputError(f"{args.assertions}: there is no such file")
    with _progress(args.assertions) as seen:
        built = build(args.assertions, args.output, relations(domain), args.threshold, seen)
    if args.json:
        print_json({"output": str(args.output), "domain": domain.name, **asdict(built)})
    else:
        print(as_text(built, args.output))
    return 0


def as_text(built: Built, output: Path) -> str:
    """The result for people."""
    facts = ", ".join(f"{number} {name}" for name, number in sorted(built.facts.items())) or "no facts"
    lines = [f"{output}: {facts}, of {count(built.lines, 'line')}; {built.light} weighed too little"]
    if built.skipped:
        shown = "" if built.skipped == len(built.malformed) else f", the first {len(built.malformed)}"
        lines.append(f"{count(built.skipped, 'malformed line')} skipped{shown}:")
        lines += [f"  line {number}: {why}: {text!r}" for number, why, text in built.malformed]
    return "\n".join(lines)


def _weight(text: str) -> float:
    weight = float(text)
    if not math.isfinite(weight):
        raise argparse.ArgumentTypeError(f"expected a finite number, not {text}")
    return weight


@contextmanager
def _progress(source: Path) -> Iterator[Seen]:
    """A bar on a terminal, nothing elsewhere; it counts the bytes of the file as it lies on the disk."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, DownloadColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}"), BarColumn(), DownloadColumn(), TimeRemainingColumn()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=source.stat().st_size)
        last = 0

        def seen(position: int) -> None:
            nonlocal last
            if position - last > 1 << 20:  # not for every line
                last = position
                bar.update(task, completed=position)

        yield seen
