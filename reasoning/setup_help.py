"""What a scenario's set-up may say, key by key, for the generated documentation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from reasoning.domain import Domain, Key, load
from reasoning.setup import TEAM


class KeyHelp(NamedTuple):
    """One line of the reference of scenario keys."""

    key: str
    type: str
    limits: str
    default: str
    help: str


def reference(domain: str | Domain) -> list[KeyHelp]:
    """Every key that a scenario may give, for the generated documentation."""
    return [
        line
        for section, keys in load(domain).data.setup.items()
        for line in _reference("teams.NAME" if section == TEAM else section, keys)
    ]


def _reference(path: str, keys: Mapping[str, Key]) -> Iterator[KeyHelp]:
    for name, key in keys.items():
        here = f"{path}.{name}"
        low, high = ("" if bound is None else str(bound) for bound in (key.min, key.max))
        limits = f"{low}..{high}" if low or high else ""
        yield KeyHelp(here, key.type, limits, "" if key.default is None else str(key.default), key.help)
        yield from _reference(f"{here}[]" if key.type == "list" else here, key.item)
