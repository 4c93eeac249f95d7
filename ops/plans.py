"""Plan files: what ``muster plan --json`` writes, and the form in which a plan was once published.

Steps count from 0 and actions are written as terms. The published form has ``steps`` and ``setup`` by a team's number;
its set-up is put into the words of a scenario by the domain's own declaration of a team's keys.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from bus.messages import Exchange, Steps
from ops.tables import InputError, Table
from reasoning.domain import Domain, domains, load
from reasoning.setup import Refused, compile_setup


class GivenPlan(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A plan to execute, as the coordinator is told it."""

    teams: dict[str, Steps]
    exchanges: tuple[Exchange, ...] = ()


class Loan(msgspec.Struct, frozen=True):
    """An exchange as plan files write it; `as_` is what the taker calls the worker."""

    worker: str
    from_: str = msgspec.field(name="from")
    give_step: int
    to: str
    take_step: int
    as_: str = msgspec.field(name="as")


class _TeamPlan(msgspec.Struct, frozen=True):
    steps: Steps


class _Scenario(msgspec.Struct, frozen=True):
    domain: str
    setup: Table


class _PlanFile(msgspec.Struct, frozen=True):
    teams: dict[str, _TeamPlan]
    exchanges: tuple[Loan, ...] = ()
    scenario: _Scenario | None = None


class _Published(msgspec.Struct, frozen=True):
    setup: dict[str, Table]
    steps: dict[str, Steps]


@dataclass(frozen=True)
class PlanFile:
    """A plan that was read. `domain` and `setup` (a scenario's tables) are empty when the file does not say them.
    `tells_exchanges`: the loans are the file's own words, not a guess from its actions."""

    path: Path
    teams: Mapping[str, Steps]
    loans: tuple[Loan, ...] = ()
    domain: str = ""
    setup: Table | None = None
    tells_exchanges: bool = True

    def given(self) -> GivenPlan:
        """As the coordinator is told it. A robot has the name it was built with: the giver's, unless it came there."""
        built: dict[tuple[str, str], str] = {}
        exchanges = []
        for loan in sorted(self.loans, key=lambda loan: loan.take_step):
            robot = built.get((loan.from_, loan.worker), f"{loan.from_}.{loan.worker}")
            built[loan.to, loan.as_] = robot
            exchanges.append(
                Exchange(loan.worker, robot, loan.from_, loan.give_step, loan.to, loan.take_step, loan.as_)
            )
        return GivenPlan(dict(self.teams), tuple(exchanges))


def read_plan(path: Path) -> PlanFile:
    """A plan file in either form. Raises `InputError`."""
    try:
        data = msgspec.json.decode(path.read_bytes())
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except msgspec.DecodeError as error:
        raise InputError(f"{path}: expected a plan in JSON, as muster plan --json writes it: {error}") from error
    published = isinstance(data, dict) and "steps" in data
    try:
        if published:
            return _from_published(path, msgspec.convert(data, _Published))
        file = msgspec.convert(data, _PlanFile)
    except msgspec.ValidationError as error:
        raise InputError(f"{path}: expected a plan, as muster plan --json writes it: {error}") from error
    steps = {team: plan.steps for team, plan in file.teams.items()}
    if file.scenario is None:
        return PlanFile(path, steps, file.exchanges)
    return PlanFile(path, steps, file.exchanges, file.scenario.domain, file.scenario.setup)


def _from_published(path: Path, file: _Published) -> PlanFile:
    """Teams are numbers there; the domain is the one whose set-up takes the tables."""
    steps = {f"T{number}": plan for number, plan in file.steps.items()}
    for domain in domains():
        keys = load(domain).data.setup.get("team", {})
        tables = {"teams": {f"T{number}": _tables(keys, team) for number, team in file.setup.items()}}
        if not isinstance(compile_setup(domain, tables), Refused):
            return PlanFile(path, steps, _loans(load(domain), steps), domain, tables, tells_exchanges=False)
    raise InputError(f"{path}: no domain takes the set-up in this plan; there are {', '.join(domains())}")


def _loans(domain: Domain, plan: Mapping[str, Steps]) -> tuple[Loan, ...]:
    """Who lends to whom, of a plan that does not say it: the first robot given is the first taken, and so on.

    Which of the domain's actions give and take is known by the skills that carry them out.
    """
    found: dict[str, list[tuple[int, str, str]]] = {"depart": [], "arrive": []}
    for team, steps in plan.items():
        for step, actions in enumerate(steps):
            for action in actions:
                name, _, arguments = action.partition("(")
                skill = domain.data.actions.get(name, {}).get("skill")
                if skill in found:
                    found[skill].append((step, team, arguments.rstrip(")").split(",")[0]))
    return tuple(
        Loan(worker, giver, give_step, taker, take_step, known_as)
        for (give_step, giver, worker), (take_step, taker, known_as) in zip(
            sorted(found["depart"]), sorted(found["arrive"]), strict=False
        )
    )


def _tables(keys: Mapping[str, Any], team: Table) -> Table:
    """A team's set-up with things keyed by name turned into tables that have one."""
    tables: Table = {}
    for key, known in keys.items():
        value = team.get(key)
        if isinstance(value, dict):
            items = [{"name": name, **_place(item)} for name, item in value.items()]
            value = items if known.type == "list" else items[0]
        if value is not None:
            tables[key] = value
    return tables


def _place(item: Any) -> Table:
    """A bare cell, or a table that calls its cell ``pos``."""
    if isinstance(item, dict):
        return {"at" if key == "pos" else key: value for key, value in item.items()}
    return {"at": item}
