"""Set-up: from a scenario's tables to the world's start, or to errors that name the key and what was expected.

First the types, as ``domain.toml`` declares them under ``[setup.*]``; then the domain's own program ``setup.lp``, which
derives the initial states and says what types cannot. Wrong input is a value (`Refused`), not an exception.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from reasoning.domain import Domain, Key, load
from reasoning.motion.convex import canonical
from reasoning.solver import models, parse
from reasoning.values import State, Value

TEAM = "team"
_NAME = re.compile(r"(?!not$)[a-z][A-Za-z0-9_]{0,30}")
_TEAM_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,30}")
_WORDS = {
    "table": "a table",
    "team": "a team's name",
    "name": "a name: a small letter, then letters, digits or _, and not the word not",
    "cell": "a cell [column, row] of two integers",
    "area": "an area [west, east, south, north] of four integers",
    "polygon": "the corners [[x, y], ...] of a polygon that does not touch itself, in order, as integers",
}
_NUMBERS = {"cell": 2, "area": 4}


class Entity(NamedTuple):
    """A body at the start; its fluents are those of the team's state that have its name as argument."""

    team: str
    name: str
    kind: str


class Wrong(NamedTuple):
    """`key` as a user writes it, ``teams.T1.workers[0].at``; `expected` what should stand there, `found` what does."""

    key: str
    expected: str
    found: str = ""

    def __str__(self) -> str:
        return f"{self.key}: expected {self.expected}" + (f", found {self.found}" if self.found else "")


@dataclass(frozen=True)
class Refused:
    errors: tuple[Wrong, ...]


@dataclass(frozen=True)
class Setup:
    """`static` are the domain's constants, `states[team]` the sensed fluents at the start, `workspaces[team]` a team's
    floor, `hidden[team]` what is true besides and no sensor shows: for the world alone. Teams in the scenario's order;
    entities by team, kind in the domain's order, and name."""

    static: Mapping[str, Value]
    states: Mapping[str, State]
    entities: tuple[Entity, ...]
    workspaces: Mapping[str, Mapping[str, Value]]
    hidden: Mapping[str, State]


KeyPath = tuple[str | int, ...]
Leaf = int | str | tuple["int | tuple[int, ...]", ...]


def sections(domain: str | Domain) -> tuple[str, ...]:
    """The top-level tables of a scenario that belong to the set-up."""
    return tuple("teams" if name == TEAM else name for name in load(domain).data.setup)


def compile_setup(domain: str | Domain, tables: Mapping[str, Any]) -> Setup | Refused:
    """The world's start. `tables` holds the scenario's set-up sections only (see `sections`), as TOML gives them."""
    domain = load(domain)
    reader = _Reader()
    reader.scenario(domain.data.setup, tables)
    if reader.errors:
        return Refused(tuple(reader.errors))
    teams = tuple(tables["teams"])
    facts = [f'team("{team}").' for team in teams]
    facts += [f"given({_path(path)},{_term(value)})." for path, value in reader.found]
    found = _result(domain, teams, facts)
    if isinstance(found, Refused) or not domain.data.geometry:
        return found
    from reasoning import geometry  # only now: slow to import, and most domains do without

    return _result(domain, teams, [*facts, *geometry.near(domain, found.static, found.states)])


def _result(domain: Domain, teams: tuple[str, ...], facts: Sequence[str]) -> Setup | Refused:
    static: dict[str, Value] = {}
    states: dict[str, dict[str, Value]] = {team: {} for team in teams}
    floors: dict[str, dict[str, Value]] = {team: {} for team in teams}
    hidden: dict[str, dict[str, Value]] = {team: {} for team in teams}
    entities: list[Entity] = []
    errors: list[Wrong] = []
    (model,) = models([domain.program("setup")], facts)
    for name, args in sorted(model.atoms, key=str):
        match name, args:
            case "static", (key, value):
                static[str(key)] = value
            case "init", (team, fluent, value):
                states[str(team)][str(fluent)] = value
            case "hidden", (team, fluent, value):
                hidden[str(team)][str(fluent)] = value
            case "workspace", (team, key, value):
                floors[str(team)][str(key)] = value
            case "entity", (team, body, kind):
                entities.append(Entity(str(team), str(body), str(kind)))
            case "bad", (path, expected, values):
                errors.append(Wrong(_written(parse(path)[1]), str(expected).format(*parse(str(values))[1])))
    if errors:
        return Refused(tuple(errors))
    kinds = list(domain.data.kinds)
    entities.sort(key=lambda e: (teams.index(e.team), kinds.index(e.kind), len(e.name), e.name))
    return Setup(static, states, tuple(entities), floors, hidden)


def _path(path: KeyPath) -> str:
    """As a term; a team's name is a string there."""
    parts = [f'"{part}"' if i == 1 and path[0] == "teams" else str(part) for i, part in enumerate(path)]
    return f"({','.join(parts)})"


def _term(value: Leaf) -> str:
    return f"({','.join(map(_term, value))})" if isinstance(value, tuple) else str(value)


class _Reader:
    """Walks the tables beside their declaration and collects leaves and errors."""

    def __init__(self) -> None:
        self.found: list[tuple[KeyPath, Leaf]] = []
        self.errors: list[Wrong] = []

    def scenario(self, setup: Mapping[str, Mapping[str, Key]], tables: Mapping[str, Any]) -> None:
        self._unknown((), tables, ["teams" if name == TEAM else name for name in setup])
        for section, keys in setup.items():
            if section == TEAM:
                self._teams(keys, tables.get("teams"))
            else:
                self._table((section,), keys, tables.get(section, {}))

    def _teams(self, keys: Mapping[str, Key], teams: Any) -> None:
        if not isinstance(teams, dict) or not teams:
            return self._wrong(("teams",), "at least one table [teams.NAME]", teams)
        for team, table in teams.items():
            if _TEAM_NAME.fullmatch(team):
                self._table(("teams", team), keys, table)
            else:
                self._wrong(("teams", team), "a team's name: a letter, then letters, digits or _", team)
        return None

    def _table(self, path: KeyPath, keys: Mapping[str, Key], table: Any) -> None:
        if not isinstance(table, dict):
            return self._wrong(path, "a table", table)
        self._unknown(path, table, keys)
        for name, key in keys.items():
            value = table.get(name, key.default)
            if value is None:
                self._wrong((*path, name), _expected(key))
            else:
                self._value((*path, name), key, value)
        return None

    def _value(self, path: KeyPath, key: Key, value: Any) -> None:
        if key.type == "table":
            if value != {} or key.default is None:  # an empty default: there is none
                self._table(path, key.item, value)
        elif key.type == "list" and isinstance(value, list) and _within(key, len(value)):
            for index, item in enumerate(value):
                self._table((*path, index), key.item, item)
        elif (leaf := _leaf(key, value)) is not None:
            self.found.append((path, leaf))
        else:
            self._wrong(path, _expected(key), value)

    def _unknown(self, path: KeyPath, table: Mapping[str, Any], allowed: Collection[str]) -> None:
        for name in table:
            if name not in allowed:
                self._wrong((*path, name), f"one of the keys {', '.join(allowed)}", name)

    def _wrong(self, path: KeyPath, expected: str, found: Any = None) -> None:
        self.errors.append(Wrong(_written(path), expected, "" if found is None else _short(found)))


def _leaf(key: Key, value: Any) -> Leaf | None:
    """The value of a key that is no table and no list, if it is one that the key takes."""
    if key.type == "int":
        return int(value) if _is_int(value) and _within(key, value) else None
    if key.type == "name":
        return str(value) if isinstance(value, str) and _NAME.fullmatch(value) else None
    if key.type == "team":
        return f'"{value}"' if isinstance(value, str) and _TEAM_NAME.fullmatch(value) else None
    if key.type == "polygon":
        return tuple(map(tuple, value)) if _is_polygon(value) else None
    return tuple(value) if _is_tuple(value, _NUMBERS.get(key.type, 0)) else None


def _is_tuple(value: Any, length: int) -> bool:
    return isinstance(value, list) and len(value) == length > 0 and all(map(_is_int, value))


def _is_polygon(corners: Any) -> bool:
    if not isinstance(corners, list) or not all(_is_tuple(corner, 2) for corner in corners):
        return False
    points = tuple(map(tuple, corners))
    try:
        return len(set(points)) == len(points) and bool(canonical(points))
    except ValueError:
        return False


def _is_int(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**31


def _within(key: Key, number: int) -> bool:
    return (key.min is None or number >= key.min) and (key.max is None or number <= key.max)


def _expected(key: Key) -> str:
    if key.type not in ("int", "list"):
        return _WORDS[key.type]
    kind = "an integer" if key.type == "int" else "a list of tables"
    if key.min is not None and key.max is not None:
        return f"{kind}, {key.min} to {key.max}"
    if key.min is not None or key.max is not None:
        return f"{kind}, at least {key.min}" if key.max is None else f"{kind}, at most {key.max}"
    return kind


def _written(path: KeyPath) -> str:
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
