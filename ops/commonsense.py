"""A commonsense base from a ConceptNet 5.7 assertions file: one pass over its lines, in constant memory.

A line has five fields between tabs: the assertion's address, relation, start, end (``/r/AtLocation``, ``/c/en/book``)
and information as a JSON object with a ``weight``. Which relations become which facts is the domain's, in
``commonsense/relations.toml`` of its folder. Facts go to the file as they are found, each once as long as no more than
`REMEMBERED` different ones were; a fact that comes again after that is written again, which changes nothing.
"""

from __future__ import annotations

import gzip
import io
import re
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import msgspec

from ops.tables import InputError, convert, read
from reasoning.domain import Domain

LANGUAGE = "en"
LONGEST_LINE = 1 << 20
"""Bytes; a line that is longer is malformed, and is never held as a whole."""
SHOWN = 5
"""So many malformed lines are shown."""
EXCERPT = 80
REMEMBERED = 200_000
_CONCEPT = re.compile(rf"/c/{LANGUAGE}/([^/]+)(?:/.*)?")
_WORD = re.compile(r"[a-z][a-z0-9_]*")
Seen = Callable[[int], None]


class Relation(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What becomes of a relation: the fact `fact` about `arguments`, if the end is one of `ends` (none given: any)."""

    fact: str
    arguments: tuple[str, ...]
    ends: tuple[str, ...] = ()


class _Weight(msgspec.Struct):
    weight: float


@dataclass
class Built:
    """What came of a file. `malformed` are the first few lines that are no assertions: their number, what is wrong and
    how they begin; `skipped` counts all of them."""

    lines: int = 0
    facts: dict[str, int] = field(default_factory=dict)
    light: int = 0
    skipped: int = 0
    malformed: list[tuple[int, str, str]] = field(default_factory=list)


class _MalformedError(Exception):
    """What is wrong with a line."""


def relations(domain: Domain) -> dict[str, Relation]:
    """What the domain wants to know, by the relation's name. Raises `InputError` if it wants nothing."""
    path = domain.folder / "commonsense" / "relations.toml"
    if not path.is_file():
        raise InputError(f"the domain {domain.name} has no commonsense base: there is no {path}")
    table, text = read(path)
    wanted = convert(table, dict[str, Relation], path, text)
    for name, relation in wanted.items():
        if not _WORD.fullmatch(relation.fact) or not set(relation.arguments) <= {"start", "end"}:
            raise InputError(f"{path}: {name}: expected a predicate, and arguments that are start or end")
    return wanted


def build(
    source: Path, target: Path, wanted: dict[str, Relation], threshold: float, seen: Seen = lambda _: None
) -> Built:
    """Write the facts that an assertions file, plain or gzip, holds about English words with at least this weight.

    `seen` hears how many bytes of the file have been read. The target is complete, or it is not touched at all. Raises
    `InputError` when a file cannot be read or written.
    """
    built = Built()
    draft = target.with_name(target.name + ".part")
    try:
        with source.open("rb") as file, draft.open("w", encoding="utf-8") as out:
            out.write(_header(wanted, threshold))
            for fact in _facts(file, source, wanted, threshold, built, seen):
                out.write(fact + "\n")
        draft.replace(target)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f"{source}: cannot be made a commonsense base: {error}") from error
    finally:
        draft.unlink(missing_ok=True)
    return built


def _facts(
    file: BinaryIO, source: Path, wanted: dict[str, Relation], threshold: float, built: Built, seen: Seen
) -> Iterator[str]:
    remembered: set[str] = set()
    for line in _lines(file, source.suffix == ".gz", seen):
        built.lines += 1
        try:
            fact = _fact(line, wanted, threshold, built)
        except _MalformedError as error:
            built.skipped += 1
            if len(built.malformed) < SHOWN:
                built.malformed.append((built.lines, str(error), line[:EXCERPT].decode("utf-8", "replace").rstrip()))
            continue
        if fact and fact not in remembered:
            if len(remembered) < REMEMBERED:
                remembered.add(fact)
            name = fact.partition("(")[0]
            built.facts[name] = built.facts.get(name, 0) + 1
            yield fact


def _lines(file: BinaryIO, packed: bool, seen: Seen) -> Iterator[bytes]:
    """The lines; of one that is too long only the beginning, which is longer than `LONGEST_LINE`."""
    text: BinaryIO = io.BufferedReader(gzip.GzipFile(fileobj=file)) if packed else file
    while line := text.readline(LONGEST_LINE + 1):
        rest = line
        while len(rest) > LONGEST_LINE and not rest.endswith(b"\n"):
            rest = text.readline(LONGEST_LINE + 1)
        seen(file.tell())
        yield line


def _fact(line: bytes, wanted: dict[str, Relation], threshold: float, built: Built) -> str:
    """The fact in a line; "" if it is about something else. Raises `_MalformedError`."""
    if len(line) > LONGEST_LINE:
        raise _MalformedError(f"more than {LONGEST_LINE} bytes")
    try:
        fields = line.decode("utf-8").rstrip("\r\n").split("\t")
    except UnicodeDecodeError:
        raise _MalformedError("not UTF-8") from None
    if len(fields) != 5:
        raise _MalformedError(f"expected 5 fields between tabs, found {len(fields)}")
    _, relation, start, end, information = fields
    if not (relation.startswith("/r/") and start.startswith("/") and end.startswith("/")):
        raise _MalformedError("no relation between two addresses, as /r/AtLocation, /c/en/book, /c/en/shelf")
    told = wanted.get(relation.removeprefix("/r/"))
    one, other = _CONCEPT.fullmatch(start), _CONCEPT.fullmatch(end)
    if told is None or one is None or other is None:
        return ""
    try:
        weight = msgspec.json.decode(information, type=_Weight).weight
    except msgspec.MsgspecError:
        raise _MalformedError("no JSON object with a weight at its end") from None
    words = {"start": one[1], "end": other[1]}
    if (told.ends and words["end"] not in told.ends) or not all(_WORD.fullmatch(words[a]) for a in told.arguments):
        return ""
    if weight < threshold:
        built.light += 1
        return ""
    return f"{told.fact}({','.join(words[argument] for argument in told.arguments)})."


def _header(wanted: dict[str, Relation], threshold: float) -> str:
    told = "  ".join(sorted({f"{r.fact}/{len(r.arguments)}" for r in wanted.values()}))
    return (
        f"% Commonsense, from ConceptNet assertions in English with a weight of at least {threshold:g}.\n%\n"
        f"% out: {told}\n\n#program base.\n"
    )
