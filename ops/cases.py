"""Diagnosis case files: the state before, the actions since, the state observed now.

``[observed]`` says only what is not as before; `absent` lists fluents that are gone. `domain` may be left out where the
file lies in a domain's own folder ``cases``. ``[rates]`` says how probable it is that a robot breaks in one step; one
that is not named has the mean of those that are. ``[expected]`` is what a shipped case must come out as.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import msgspec

from ops.places import missing
from ops.tables import InputError, convert, place, read
from reasoning.checker import is_term
from reasoning.diagnoser import Expected, Result
from reasoning.domain import domains, load
from reasoning.values import Case, Step, Value

CLOSE = 0.01
"""Probabilities of a case file are given to two places."""


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    before: dict[str, Value]
    actions: tuple[Step, ...]
    static: dict[str, Value] = {}
    observed: dict[str, Value] = {}
    absent: tuple[str, ...] = ()
    bound: int = 2
    story: str = ""
    domain: str = ""
    rates: dict[str, float] = {}
    expected: Expected | None = None


@dataclass(frozen=True)
class CaseFile:
    """A case as it was read; `rates` are empty and `expected` is None if the file does not say them."""

    path: Path
    story: str
    case: Case
    rates: Mapping[str, float]
    expected: Expected | None


def shipped_cases() -> dict[str, Path]:
    """The cases that come with muster: ``domain/name`` -> file."""
    return {f"{domain}/{name}": path for domain in domains() for name, path in load(domain).cases.items()}


def read_case(name: str) -> CaseFile:
    """The case that a user names by path or ``domain/name``. Raises `InputError`."""
    known = shipped_cases()
    path = Path(name)
    if not path.is_file():
        if name not in known:
            raise InputError(f"{name}: {missing(name, 'case', known)}")
        path = known[name]
    table, text = read(path)
    file = convert(table, _File, path, text)
    domain = file.domain or path.resolve().parents[1].name
    if domain not in domains():
        raise InputError(place(path, text, ["domain"]) + f"expected one of {', '.join(domains())}")
    for robot, rate in file.rates.items():
        if not (is_term(robot) and 0 < rate < 1):
            raise InputError(
                place(path, text, ["rates", robot]) + "expected a robot's name and a number between 0 and 1"
            )
    observed = {f: v for f, v in {**file.before, **file.observed}.items() if f not in file.absent}
    case = Case(domain, file.static, file.before, file.actions, observed, file.bound)
    return CaseFile(path, file.story, case, file.rates, file.expected)


def differences(expected: Expected, result: Result) -> list[str]:
    """In what the result is not as the case file says."""
    found = tuple(diagnosis.causes for diagnosis in result.diagnoses)
    wrong = []
    if sorted(found) != sorted(tuple(sorted(causes)) for causes in expected.diagnoses):
        wrong.append(f"expected the explanations {[list(causes) for causes in expected.diagnoses]}")
    if result.executed != expected.executed:
        wrong.append(f"expected everything executed up to step {expected.executed}, not {result.executed}")
    far = [abs(p - q) > CLOSE for p, q in zip(expected.probabilities, result.probabilities, strict=False)]
    if any(far) or (expected.probabilities and len(far) != len(found)):
        wrong.append(f"expected the probabilities {list(expected.probabilities)}")
    if expected.inspect and result.inspect != expected.inspect:
        wrong.append(f"expected inspections of {', '.join(expected.inspect)}")
    return wrong
