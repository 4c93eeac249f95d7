"""TOML tables as users write them: reading, overriding by dotted paths, converting to types, and the place of an error.

Everything wrong with what a user gave is an `InputError`: one sentence that names the file, the line where that is
known, the key and what was expected. The command line prints it and ends with exit code 2.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import msgspec

Table = dict[str, Any]
T = TypeVar("T")

_BARE = re.compile(r"[A-Za-z_][\w./:-]*")
_HEADER = re.compile(r"\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(#.*)?$")
_KEY = re.compile(r"""\s*(["']?)([\w.-]+)\1\s*=""")
_UNKNOWN = re.compile(r"Object contains unknown field `(.*?)`")
_MISSING = re.compile(r"Object missing required field `(.*?)`")

_WORDS = {
    "int": "a whole number", "float": "a number", "str": "text", "bool": "true or false", "object": "a table",
    "array": "a list",
}  # fmt: skip


class InputError(Exception):
    """The user's input is wrong; the message says where and what was expected."""


def read(path: Path) -> tuple[Table, str]:
    """The file's table and text. Raises `InputError` if it cannot be read or is not TOML."""
    try:
        text = path.read_text(encoding="utf-8-sig")  # some editors put a mark before the first line
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not valid TOML: not a text in UTF-8") from error
    try:
        return tomllib.loads(text), text
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {error}") from error


def override(table: Table, assignment: str) -> list[str]:
    """Apply one ``--set key=value`` in place and return the key as a path.

    The key is dotted, list items are numbers from 0: ``teams.T1.workers.0.at=[1,2]``. The value is written as in
    TOML; a bare word may go without quotes. Raises `InputError`.
    """
    dotted, equals, written = assignment.partition("=")
    path = [part.strip() for part in dotted.split(".")]
    if not equals or not all(path):
        raise InputError(f"--set {assignment}: expected key=value, for instance seed=3 or teams.T1.boxes=2")
    here: Any = table
    for number, part in enumerate(path[:-1]):
        here = _step(here, part, assignment, ".".join(path[: number + 1]))
    last, value = path[-1], _value(written.strip(), assignment)
    if isinstance(here, list):
        if not last.isdecimal() or int(last) >= len(here):
            raise InputError(f"--set {assignment}: {'.'.join(path[:-1])} is a list of {len(here)}; items count from 0")
        here[int(last)] = value
    elif isinstance(here, dict):
        here[last] = value
    else:
        raise InputError(f"--set {assignment}: {'.'.join(path[:-1])} is {here!r}, which has no keys")
    return path


def convert(table: object, to: type[T], path: Path, text: str, at: Sequence[str] = ()) -> T:
    """`table` as a value of type `to`; `at` is where it stands in the file. Raises `InputError`."""
    try:
        return msgspec.convert(table, to)
    except msgspec.ValidationError as error:
        message, _, pointer = str(error).partition(" - at `$")
        keys = [*at, *re.findall(r"[^.\[\]`]+", pointer)]
        if unknown := _UNKNOWN.search(message):
            keys, message = [*keys, unknown[1]], "unknown key" + _known(to, keys[len(at) :])
        elif missing := _MISSING.search(message):
            keys, message = [*keys, missing[1]], "is missing"
        else:
            message = _in_words(message[:1].lower() + message[1:])
            message += _choices(to, keys[len(at) :]) if message.startswith("invalid enum value") else ""
        raise InputError(place(path, text, keys) + message) from error


def place(path: Path, text: str, keys: Sequence[str]) -> str:
    """How an error about a key begins: file, line if it can be told, key."""
    line = line_of(text, keys)
    return f"{path}{f', line {line}' if line else ''}: {dotted(keys)}: "


def dotted(keys: Sequence[str]) -> str:
    """``fault[0].at_step`` of ``["fault", "0", "at_step"]``."""
    return "".join(f"[{key}]" if key.isdecimal() else f".{key}" for key in keys).lstrip(".")


def line_of(text: str, keys: Sequence[str]) -> int:
    """The line (from 1) where a key stands or, failing that, its nearest table; 0 if it is not in the text.

    Looks at headers and at keys that begin a line, which is how scenario files are written; inside inline tables
    the line of the outer key is given.
    """
    best, length = 0, 0
    table: list[str] = []
    arrays: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if header := _HEADER.match(line):
            table = [part.strip().strip("\"'") for part in header[2].split(".")]
            if header[1] == "[[":
                arrays[header[2]] = arrays.get(header[2], -1) + 1
                table.append(str(arrays[header[2]]))
            found = table
        elif key := _KEY.match(line):
            found = [*table, *key[2].split(".")]
        else:
            continue
        if length < len(found) <= len(keys) and list(keys[: len(found)]) == found:
            best, length = number, len(found)
    return best


def _step(here: Any, part: str, assignment: str, so_far: str) -> Any:
    """The next table on an override's way; a table that is not there yet is made."""
    if isinstance(here, dict):
        return here.setdefault(part, {})
    if isinstance(here, list) and part.isdecimal() and int(part) < len(here):
        return here[int(part)]
    raise InputError(f"--set {assignment}: there is no {so_far}")


def _value(written: str, assignment: str) -> object:
    try:
        return tomllib.loads(f"value = {written}")["value"]
    except tomllib.TOMLDecodeError:
        if _BARE.fullmatch(written):
            return written
        expected = 'expected a TOML value: 3, 2.5, true, "text", [1, 2]'
        raise InputError(f"--set {assignment}: {expected}") from None


def _in_words(message: str) -> str:
    """The message with words for the names of types."""

    def words(found: re.Match[str]) -> str:
        return " or ".join(_WORDS.get(name, name) for name in found[1].split(" | ") if name != "null")

    return re.sub(r"`([^`]*)`", words, message)


def _known(to: object, keys: Sequence[str]) -> str:
    """The keys that were possible at that place, for the message."""
    try:
        return "; known here: " + ", ".join(field.encode_name for field in _type_at(to, keys).fields)
    except (AttributeError, StopIteration):
        return ""


def _choices(to: object, keys: Sequence[str]) -> str:
    """The values that were possible at that place, for the message."""
    try:
        return "; expected " + " or ".join(map(str, _type_at(to, keys).values))
    except (AttributeError, StopIteration):
        return ""


def _type_at(to: object, keys: Sequence[str]) -> Any:
    """What msgspec knows of the type at that place. Raises AttributeError or StopIteration where it knows nothing."""
    info: Any = msgspec.inspect.type_info(to)
    for key in keys:
        if key.isdecimal():
            info = info.item_type
        else:
            info = next(field.type for field in info.fields if field.encode_name == key)
        if isinstance(info, msgspec.inspect.UnionType):
            info = next(option for option in info.types if hasattr(option, "fields"))
    return info
