"""Scenario files: a story, a set-up, what goes wrong, and what must come out.

The set-up tables (``[teams.*]`` and whatever else the domain knows, such as the size of a floor) are the domain's own
and are validated by `reasoning.setup`; everything else is fixed here. See `Scenario` for the keys.
"""

from __future__ import annotations

import copy
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path
from re import findall
from typing import Annotated, Any, Literal

import msgspec

from bus.events import KINDS as EVENTS
from bus.messages import Name, Seconds, Step, Text
from bus.scene import Fault, Positive
from ops.faultwords import Names, problem
from ops.places import scenario_file
from ops.processes import RESERVED
from ops.tables import InputError, Table, convert, override, place, read
from reasoning.domain import domains
from reasoning.domain import load as load_domain
from reasoning.setup import sections

_TRIGGERS = ("at_step", "at_s", "on_action")


FASTEST = 1e6
"""More simulated seconds in one of the wall than any machine can do."""
SEEDS = 10**9
"""A seed is less, and so nothing on its way to the processes has to care how large it is."""


class Clock(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``[clock]``: ``fast`` (time jumps, same seed same run) or ``realtime`` at `factor` times the wall's time."""

    mode: Literal["fast", "realtime"] = "fast"
    factor: Annotated[float, msgspec.Meta(gt=0, le=FASTEST)] = 1.0

    def option(self) -> str:
        """As every process takes it on its command line."""
        return self.mode if self.mode == "fast" else f"realtime:{self.factor:g}"


class Verdict(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``[verdict]``: what must come out.

    `eventually` and `never` are lists of patterns ``{event = KIND, field = value, ...}``: an event matches when it is
    of that kind and has those fields with those values (`source` is the process that said it). `exit` is the exit
    code that the whole run must have, for scenarios that are meant to fail.
    """

    goal: bool = True
    makespan_at_most: Step | None = None
    optimal: bool | None = None
    eventually: tuple[Table, ...] = ()
    never: tuple[Table, ...] = ()
    exit: Annotated[int, msgspec.Meta(ge=0, le=3)] = 0


class Limits(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``[limits]``: when to stop waiting. `simulated_s` and `wall_s` end the run; `conflicts` bounds the search for one
    answer (0: no bound); `restarts` is how often a process is started again within a minute."""

    simulated_s: Positive = 3600.0
    wall_s: Positive = 900.0
    conflicts: Annotated[int, msgspec.Meta(ge=0)] = 0
    search_s: Seconds = 0.0
    restarts: Annotated[int, msgspec.Meta(ge=0)] = 5


class Record(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``[record]``: how often the bodies' states are recorded and shown, per simulated second."""

    frame_hz: Positive = 10.0


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The keys that are the same for every domain; a missing story is a scenario that nobody can understand."""

    story: Text
    domain: Name
    teams: dict[Name, Table]
    seed: Annotated[int, msgspec.Meta(ge=0, lt=SEEDS)] = 0
    plan: str = ""
    clock: Clock = Clock()
    verdict: Verdict = Verdict()
    limits: Limits = Limits()
    record: Record = Record()


@dataclass(frozen=True)
class Scenario:
    """A scenario file, read and validated as far as it can be without its domain's logic.

    `setup` holds the domain's tables (``teams`` among them) untouched, `plan` is the plan file to execute first.
    """

    name: str
    path: Path
    text: str
    story: str
    domain: str
    seed: int
    clock: Clock
    setup: Table
    faults: tuple[Fault, ...]
    verdict: Verdict
    limits: Limits
    record: Record
    plan: Path | None = None

    @property
    def teams(self) -> tuple[str, ...]:
        """The teams, in the file's order."""
        return tuple(self.setup["teams"])

    def complaint(self, keys: Iterable[str], expected: str) -> InputError:
        """An error about one of this file's keys, for checks that come later."""
        return InputError(place(self.path, self.text, list(keys)) + expected)


def load(name: str, overrides: Iterable[str] = ()) -> Scenario:
    """The scenario that a user names by path or ``domain/name``, with ``--set`` applied. Raises `InputError`."""
    path = scenario_file(name)
    table, text = read(path)
    for assignment in overrides:
        override(table, assignment)
    return parse(table, path, text)


def parse(table: Table, path: Path, text: str = "") -> Scenario:
    """The typed value of a scenario's table. Raises `InputError`."""
    whole = copy.deepcopy(table)
    faults = whole.pop("fault", [])
    common = {field: whole.pop(field) for field in _File.__struct_fields__ if field in whole}
    file = convert(common, _File, path, text)
    if not file.teams:
        raise InputError(place(path, text, ["teams"]) + "expected at least one team, as [teams.NAME]")
    for team in file.teams:
        if team.casefold() in RESERVED:
            taken = f"{team} is the name of a process or a place in every run ({', '.join(sorted(RESERVED))})"
            raise InputError(place(path, text, ["teams", team]) + f"expected another name; {taken}")
    if file.domain not in domains():
        raise InputError(place(path, text, ["domain"]) + f"expected one of {', '.join(domains())}, not {file.domain!r}")
    for key in whole:
        if key not in (tables := sections(file.domain)):
            known = ", ".join(sorted({*_File.__struct_fields__, "fault", *tables}))
            raise InputError(place(path, text, [key]) + f"expected one of the keys {known}, found {key!r}")
    if not isinstance(faults, list):
        raise InputError(place(path, text, ["fault"]) + "expected a list of tables: write [[fault]]")
    processes = ("world", "coordinator", *file.teams)
    names = Names(teams=tuple(file.teams), processes=processes)
    actions = tuple(load_domain(file.domain).data.actions)
    scenario = Scenario(
        name=path.stem,
        path=path,
        text=text,
        story=file.story,
        domain=file.domain,
        seed=file.seed,
        clock=file.clock,
        setup={**whole, "teams": common["teams"]},
        faults=tuple(_fault(fault, number, path, text, names, actions) for number, fault in enumerate(faults)),
        verdict=file.verdict,
        limits=file.limits,
        record=file.record,
        plan=_plan(file, path, text),
    )
    _check_patterns(scenario)
    return scenario


def _fault(table: Any, number: int, path: Path, text: str, names: Names, actions: Collection[str]) -> Fault:
    """One ``[[fault]]``: kind, target, one trigger; every other key is an argument of the kind. `actions` are the names
    of those that the domain has."""
    at = ["fault", str(number)]
    if not isinstance(table, dict):
        raise InputError(place(path, text, at) + "expected a table: write [[fault]]")
    own = {key: value for key, value in table.items() if key in ("kind", "target", *_TRIGGERS)}
    args = {key: value for key, value in table.items() if key not in own}
    fault = convert({**own, "args": args}, Fault, path, text, at)
    given = [key for key in _TRIGGERS if key in own]
    if len(given) != 1:
        what = f"has {' and '.join(given)}" if given else "has none"
        raise InputError(place(path, text, at) + f"expected exactly one of {', '.join(_TRIGGERS)}; it {what}")
    if wrong := problem(fault.kind, fault.target, fault.args, names):
        raise InputError(place(path, text, [*at, wrong[0]]) + wrong[1])
    if fault.on_action is not None:
        team, _, action = fault.on_action.partition(".")
        if team not in names.teams:
            expected = "expected TEAM.ACTION, for instance T1.move(w1,right)"
            raise InputError(place(path, text, [*at, "on_action"]) + expected)
        if (name := action.partition("(")[0]) not in actions:
            expected = f"expected TEAM.ACTION with an action of the domain: {', '.join(actions)}; not {name!r}"
            raise InputError(place(path, text, [*at, "on_action"]) + expected)
    return fault


def _check_patterns(scenario: Scenario) -> None:
    for which, patterns in (("eventually", scenario.verdict.eventually), ("never", scenario.verdict.never)):
        for number, pattern in enumerate(patterns):
            if pattern.get("event") not in EVENTS:
                expected = f"expected event = one of {', '.join(EVENTS)}; not {pattern.get('event')!r}"
                raise scenario.complaint(["verdict", which, str(number), "event"], expected)
            said = EVENTS[pattern["event"]]
            for field in sorted(pattern.keys() - {"event", "source", "text", *findall(r"\w+", said)}):
                expected = f"{pattern['event']} has no such field; it has source, text; {said}"
                raise scenario.complaint(["verdict", which, str(number), field], expected)


def _plan(file: _File, path: Path, text: str) -> Path | None:
    """A plan file is named relative to the scenario file or, for a shipped plan, to its domain's folder."""
    if not file.plan:
        return None
    candidates = [path.parent / file.plan, load_domain(file.domain).folder / file.plan]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    tried = " nor ".join(str(candidate) for candidate in candidates)
    raise InputError(place(path, text, ["plan"]) + f"expected a plan file; there is neither {tried}")
