"""Plans and recorded runs, held against the independent checker."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from bus.messages import Steps
from ops.plans import PlanFile
from ops.tables import InputError, Table
from reasoning.checker import Break, Exchange, Verdict, examine
from reasoning.domain import Domain, load
from reasoning.setup import Refused, Setup, compile_setup

_NAME = re.compile(r"\w+")


def check_plan(file: PlanFile, domain: str = "", setup: Table | None = None) -> tuple[Verdict, tuple[Break, ...]]:
    """The verdict on a plan, and the failures that it speaks of (`implied_breaks`).

    `domain` and `setup` say where it starts if the file does not. Raises `InputError`.
    """
    start = _setup(file, domain or file.domain, setup if setup is not None else file.setup)
    known = load(domain or file.domain)
    for team in file.teams:
        if team not in start.states:
            raise InputError(f"{file.path}: teams.{team}: there is no such team; there are {', '.join(start.states)}")
    breaks = implied_breaks(known, file.teams)
    loans = [Exchange(x.worker, x.from_, x.give_step, x.to, x.take_step, x.as_) for x in file.loans]
    verdict = examine(
        known,
        start.static,
        start.states,
        file.teams,
        exchanges=loans if file.tells_exchanges else None,
        breaks=breaks,
    )
    return verdict, breaks


def implied_breaks(domain: Domain, plan: Mapping[str, Steps]) -> tuple[Break, ...]:
    """A repair says that its robot broke: at the last step before it in which the robot was to do something."""
    breaks = []
    for team, steps in plan.items():
        for step, actions in enumerate(steps):
            for name, robot in repairs(domain, actions):
                used = [t for t in range(step) if any(robot in _NAME.findall(action)[1:] for action in steps[t])]
                since = [t for t in used if (robot, name) not in [(r, n) for n, r in repairs(domain, steps[t])]]
                if since:
                    breaks.append(Break(team, robot, since[-1]))
    return tuple(breaks)


def repairs(domain: Domain, actions: Sequence[str]) -> list[tuple[str, str]]:
    """The actions that repair, by the skill that carries them out: their names and robots."""
    found = []
    for action in actions:
        words = _NAME.findall(action)
        if len(words) > 1 and domain.data.actions.get(words[0], {}).get("skill") == "repair":
            found.append((words[0], words[1]))
    return found


def _setup(file: PlanFile, domain: str, setup: Table | None) -> Setup:
    if not domain or setup is None:
        way_out = "say which with --scenario NAME"
        raise InputError(f"{file.path}: the plan does not say from which set-up it starts (key scenario): {way_out}")
    start = compile_setup(domain, setup)
    if isinstance(start, Refused):
        raise InputError(f"{file.path}: scenario.setup: {start.errors[0]}")
    return start
