"""Where the knowledge is: finds the ``encodings`` folder and reads a domain's ``domain.toml`` as a typed value.

A domain is one folder of it: answer set programs with an entry file a purpose (``plan.lp``, ``check.lp`` ...),
``domain.toml``, ``scenarios/*.toml``, ``cases/*.toml``, ``plans/*.json``. Domain-independent programs are in ``core``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

import msgspec

CORE = "core"


class DomainError(Exception):
    """A domain, or a part of one, is missing or malformed. The text names the file and what was expected."""


class Key(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a scenario may say under one key. `min` and `max` limit an int's value or a list's length; a key
    without `default` must be given; `item` describes the keys of a table, or of each table in a list."""

    type: Literal["int", "list", "table", "name", "team", "cell", "area", "polygon"]
    help: str = ""
    min: int | None = None
    max: int | None = None
    default: int | str | list[Any] | dict[str, Any] | None = None
    item: dict[str, Key] = {}


class Description(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``domain.toml``. `setup` maps a section of the scenario to its keys; the section ``team`` stands once for every
    team, under ``teams.NAME``. `kinds` and `actions` are what the world must know of bodies and skills; `exchanged` is
    the kind of robot that teams lend one another under the published limits, `shared` says for each kind that they lend
    without them what kind of body it is; `rules` gives the checker's rules in plain words, `why` the members of a clash
    (`reasoning.why`). `geometry` names the constants that describe rooms (see `reasoning.geometry`), `costs` those by
    which plans of the shortest length are compared (`reasoning.costs`), and `solver` holds the planner's options for
    clingo. Unless the domain is `conducted`, its teams act for themselves, and nobody conducts their steps: `autonomy`
    names what they must know for that. A domain without actions can be planned and checked, but not run."""

    name: str
    story: str
    time: dict[str, float]
    setup: dict[str, dict[str, Key]]
    kinds: dict[str, dict[str, Any]]
    actions: dict[str, dict[str, Any]]
    conducted: bool = True
    exchanged: str = ""
    shared: dict[str, str] = {}
    geometry: dict[str, str] = {}
    costs: dict[str, str] = {}
    autonomy: dict[str, str] = {}
    display: dict[str, Any] = {}
    rules: dict[str, str] = {}
    why: dict[str, dict[str, str]] = {}
    solver: tuple[str, ...] = ("--config=handy",)


@dataclass(frozen=True)
class Domain:
    folder: Path
    data: Description

    @property
    def name(self) -> str:
        return self.folder.name

    def program(self, entry: str) -> Path:
        """The entry file of one purpose, as ``plan``. Raises `DomainError` when the domain has none."""
        path = self.folder / f"{entry}.lp"
        if not path.is_file():
            raise DomainError(f"{path}: no such program; the domain {self.name!r} has {_names(self.folder, '*.lp')}")
        return path

    @property
    def can_run(self) -> bool:
        """Does the world know the domain's skills? Without actions its scenarios can be planned and checked only."""
        return bool(self.data.actions)

    @property
    def scenarios(self) -> Mapping[str, Path]:
        return _files(self.folder / "scenarios", "*.toml")

    @property
    def cases(self) -> Mapping[str, Path]:
        """Diagnosis cases with their expected results."""
        return _files(self.folder / "cases", "*.toml")

    @property
    def plans(self) -> Mapping[str, Path]:
        return _files(self.folder / "plans", "*.json")


@cache
def root() -> Path:
    """The ``encodings`` folder: beside the package in a checkout, inside it in an installed wheel.

    Not by `importlib.resources`: ``encodings`` is also a package of the standard library.
    """
    here = Path(__file__).resolve().parent
    for folder in (here / "encodings", here.parent / "encodings"):
        if (folder / CORE).is_dir() or any(folder.glob("*/domain.toml")):
            return folder
    raise DomainError(f"no folder 'encodings' with domains in {here} or beside it: muster is not installed completely")


def domains() -> tuple[str, ...]:
    return tuple(sorted(file.parent.name for file in root().glob("*/domain.toml")))


def core_program(name: str) -> Path:
    """A domain-independent program, as ``match``."""
    path = root() / CORE / f"{name}.lp"
    if not path.is_file():
        raise DomainError(f"{path}: no such program; there are {_names(root() / CORE, '*.lp')}")
    return path


def load(name: str | Domain) -> Domain:
    """The domain of that name (a `Domain` is returned as it is). Raises `DomainError`."""
    return name if isinstance(name, Domain) else read(root() / name)


@cache
def read(folder: Path) -> Domain:
    """The domain in that folder. Raises `DomainError`."""
    file = folder / "domain.toml"
    if not file.is_file():
        raise DomainError(f"no domain {folder.name!r}; there are: {', '.join(domains())}")
    try:
        data = msgspec.toml.decode(file.read_bytes(), type=Description)
    except msgspec.MsgspecError as error:
        raise DomainError(f"{file}: {error}") from error
    if data.name != folder.name:
        raise DomainError(f"{file}: name is {data.name!r}, expected the folder's name {folder.name!r}")
    return Domain(folder, data)


def _files(folder: Path, pattern: str) -> dict[str, Path]:
    return {file.stem: file for file in sorted(folder.glob(pattern))}


def _names(folder: Path, pattern: str) -> str:
    return ", ".join(_files(folder, pattern)) or "none"
