"""The published way to a diagnosis, plainly: one call of the solver for each set of robots and each prefix of the plan
(Haspalamutgil 2011). It is the yardstick that `diagnoser` is measured by and must agree with; nobody else uses it.

Sets of robots are tried by size. For each, everything is supposed to have been executed up to the latest step first;
only where that explains nothing, up to the one before. All sets of the least size that explain what is seen are told.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations

from reasoning.diagnoser import Result, broken_in, facts_of
from reasoning.domain import load
from reasoning.solver import models, parse
from reasoning.values import Case, Diagnosis


@dataclass(frozen=True)
class Enumerated:
    """`executed[robots]`: the latest step before which everything can have been executed, for each least set of broken
    robots. `calls` is how often the solver was called. `finished` is False when it was stopped."""

    executed: dict[tuple[str, ...], int]
    calls: int
    finished: bool = True


def enumerated(case: Case, calls: int | None = None, stop: Callable[[], bool] = lambda: False) -> Enumerated:
    """Broken robots alone, at most `case.bound`; stopped after so many calls, or before the one when `stop` is true."""
    domain, facts, used = load(case.domain), facts_of(case), 0
    files = [domain.program("diagnose"), domain.program("diagnose_given")]
    robots = sorted({robot for step in case.actions for action in step for robot in _robots(case, action)})
    found: dict[tuple[str, ...], int] = {}
    for size in range(case.bound + 1):
        for chosen in combinations(robots, size):
            given = [f"given({robot})." for robot in chosen]
            for upto in reversed(range(len(case.actions) + 1)):
                if used == calls or stop():
                    return Enumerated(found, used, finished=False)
                used += 1
                if models(files, [*facts, *given, f"prefix({upto})."], consts={"bound": size}, limit=1):
                    found[chosen] = upto
                    break
        if found:
            break
    return Enumerated(found, used)


def agrees(case: Case, result: Result, reference: Enumerated) -> bool:
    """Are these the same sets, each executed up to the same step? For results without rates and persons."""
    executed = {broken_in(d): executed_until(case, d) for d in result.least}
    return reference.finished and executed == reference.executed


def executed_until(case: Case, diagnosis: Diagnosis) -> int:
    """Before this step every action had its effect."""
    full = [set(step) <= set(diagnosis.happened[time]) for time, step in enumerate(case.actions)]
    return full.index(False) if False in full else len(full)


def _robots(case: Case, action: str) -> Iterator[str]:
    """The bodies of an action that the domain's table calls robots and partners."""
    name, args = parse(action)
    kinds = load(case.domain).data.actions.get(name, {}).get("args", [])
    return (str(arg) for arg, kind in zip(args, kinds, strict=False) if kind in ("robot", "partner"))
