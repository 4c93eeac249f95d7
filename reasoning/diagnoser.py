"""Diagnosis: all minimal explanations of what is seen, what did happen, how probable each is, and what to inspect.

An explanation is a set of causes: broken robots, and what persons may have done where broken robots alone explain
nothing. Which causes there are and what they do is the domain's (``diagnose.lp``). One program is grounded once: it is
solved for the least number of causes, with proof, and then enumerated under that number.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import exp, expm1, log, log1p
from typing import NamedTuple, Protocol

import msgspec

from reasoning.checker import is_term
from reasoning.domain import load
from reasoning.inspection import order
from reasoning.solver import Model, Program, parse
from reasoning.values import Case, Diagnosis, Step

BROKEN = "broken"
OTHERS = "other"
WAYS = 20_000
"""At most so many ways to the explanations are looked at; beyond, every explanation is still found, by one way."""
UNIT = 1000
"""Costs of the optimisation are natural logarithms in thousandths."""
MARGIN = 14 * UNIT
"""With rates, ways about a millionth as probable as the most probable one are left out."""


@dataclass(frozen=True)
class Result:
    """`diagnoses` are of least size; empty when nothing explains what is seen. Before step `executed` every action
    had its effect, in all of them. `inspect` are the robots worth an inspection, best first.

    Without failure rates `diagnoses` are sorted, and of least size only those that are preferred: everything was
    executed up to the latest step, and the first failure of whole robots comes latest. The others are in `set_aside`.
    With rates all of least size are in `diagnoses`, the most probable first; `probabilities` are theirs.
    """

    diagnoses: tuple[Diagnosis, ...]
    executed: int
    inspect: tuple[str, ...]
    set_aside: tuple[Diagnosis, ...] = ()
    probabilities: tuple[float, ...] = ()

    @property
    def least(self) -> tuple[Diagnosis, ...]:
        """All explanations of least size."""
        return tuple(sorted((*self.diagnoses, *self.set_aside), key=lambda d: d.causes))


def diagnose(case: Case, rates: Mapping[str, float] | None = None) -> Result:
    """All explanations with fewest causes by persons, of these with fewest broken robots, at most `case.bound`.
    Robots known to be broken are no suspects.

    `rates[robot]` is the chance that a whole robot breaks in one step, between 0 and 1; a robot that is not named has
    the mean of those that are. Raises ValueError for other rates.
    """
    domain = load(case.domain)
    files = [domain.program("diagnose"), domain.program("diagnose_best")]
    files += [domain.program("diagnose_rates")] if rates else []
    facts = [*facts_of(case), *(_weights(rates, len(case.actions)) if rates else ())]
    for admitted in ([], ["persons."]):
        program = Program(files, [*facts, *admitted], [f"-cbound={case.bound}"])
        program.ground(("base", ()))
        best = program.cheapest()
        if best is not None:
            cost = (*best.cost[:-1], best.cost[-1] + MARGIN) if rates else best.cost
            found = program.within(cost, limit=WAYS)
            if len(found) == WAYS:
                found = [*found, *program.within(cost, project=True)]
            return _result(case, found, bool(rates))
    return Result((), 0, ())


class Explanation(Protocol):
    """Whatever has causes: a `Diagnosis`, or one that came by message."""

    @property
    def causes(self) -> tuple[str, ...]: ...


def broken_in(diagnosis: Explanation) -> tuple[str, ...]:
    """The robots that an explanation holds to be broken."""
    return tuple(str(parse(cause)[1][0]) for cause in diagnosis.causes if parse(cause)[0] == BROKEN)


def inspection_order(suspected: Iterable[Sequence[str]], weights: Sequence[float] = ()) -> tuple[str, ...]:
    """Robots worth an inspection when each of these sets may be the broken ones (alike, or with these weights): those
    in some but not in all; first the one that the fewest expected inspections begin with."""
    return order(list(suspected), weights)


def explain(diagnoses: Iterable[Diagnosis], findings: Mapping[str, str]) -> tuple[Diagnosis, ...]:
    """The diagnoses that agree with inspections: `findings[robot]` is ``broken`` or ``sound``."""
    broken = {robot for robot, finding in findings.items() if finding == BROKEN}
    sound = findings.keys() - broken
    return tuple(d for d in diagnoses if broken <= set(broken_in(d)) and not sound & set(broken_in(d)))


def facts_of(case: Case) -> list[str]:
    """A case as the domain's programs are told it."""
    return [
        f"horizon({len(case.actions)}).",
        *(f"static({key},{value})." for key, value in case.static.items()),
        *(f"init({fluent},{value})." for fluent, value in case.before.items()),
        *(f"observed({fluent},{value})." for fluent, value in case.observed.items()),
        *(f"kind(own,{robot},{kind})." for robot, kind in case.guests),
        *(f"occurs({action},{step})." for step, actions in enumerate(case.actions) for action in actions),
        *(
            f"detail({action},{step},{key},{value})."
            for (step, action), detail in case.details.items()
            for key, value in detail.items()
            if isinstance(value, int) or is_term(value)
        ),
    ]


def _weights(rates: Mapping[str, float], horizon: int) -> Iterator[str]:
    """A break in steps a to b of H has the odds q^a (1 - q^(b-a+1)) / q^H against none, q being 1 minus the rate."""
    wrong = [robot for robot, rate in rates.items() if not (is_term(robot) and 0 < rate < 1)]
    if wrong:
        raise ValueError(f"rates: of {', '.join(wrong)}: expected a number between 0 and 1")
    for name, rate in {OTHERS: sum(rates.values()) / len(rates), **rates}.items():
        whole = log1p(-rate)
        for step in range(horizon):
            yield f"late({name},{step},{round(UNIT * (horizon - step) * whole)})."
            yield f"short({name},{step + 1},{round(-UNIT * log(-expm1(whole * (step + 1))))})."


class _Way(NamedTuple):
    """One model: how the causes came about."""

    causes: tuple[str, ...]
    since: tuple[frozenset[int], ...]
    idle: frozenset[tuple[str, int]]
    executed: int
    wondered: int
    cost: int

    @property
    def latest(self) -> list[int]:
        return sorted(max(steps, default=0) for steps in self.since)


def _way(model: Model) -> _Way:
    since: dict[str, set[int]] = {str(args[0]): set() for name, args in model.atoms if name == "cause"}
    idle, upto = set(), {"executed": 0, "wondered": 0}
    for name, args in model.atoms:
        match name, args:
            case "since", (cause, int(step)):
                since[str(cause)].add(step)
            case "idle", (action, int(step)):
                idle.add((str(action), step))
            case (("executed" | "wondered"), (int(step),)):
                upto[name] = step
    causes = tuple(sorted(since))
    begun = tuple(frozenset(since[cause]) for cause in causes)
    return _Way(causes, begun, frozenset(idle), upto["executed"], upto["wondered"], [0, *model.cost][-1])


def _result(case: Case, models: Sequence[Model], rated: bool) -> Result:
    ways: dict[tuple[str, ...], list[_Way]] = {}
    for way in dict.fromkeys(map(_way, models)):
        ways.setdefault(way.causes, []).append(way)
    if rated:
        return _ranked(case, ways)
    grade = {causes: max((way.executed, way.wondered) for way in some) for causes, some in ways.items()}
    best = max(grade.values())
    told = {
        causes: _diagnosis(case, [way for way in some if (way.executed, way.wondered) == grade[causes]])
        for causes, some in sorted(ways.items())
    }
    preferred = tuple(d for causes, d in told.items() if grade[causes] == best)
    aside = tuple(d for causes, d in told.items() if grade[causes] != best)
    return Result(preferred, best[0], inspection_order(map(broken_in, preferred)), aside)


def _ranked(case: Case, ways: Mapping[tuple[str, ...], Sequence[_Way]]) -> Result:
    """Ways exclude one another, so the odds of an explanation are the sum of theirs."""
    least = min(way.cost for some in ways.values() for way in some)
    odds = {causes: sum(exp((least - way.cost) / UNIT) for way in some) for causes, some in ways.items()}
    ranking = sorted(odds, key=lambda causes: (-odds[causes], causes))
    diagnoses = tuple(_diagnosis(case, ways[causes], rated=True) for causes in ranking)
    chances = tuple(odds[causes] / sum(odds.values()) for causes in ranking)
    executed = min(way.executed for some in ways.values() for way in some)
    return Result(diagnoses, executed, inspection_order(map(broken_in, diagnoses), chances), (), chances)


def _diagnosis(case: Case, ways: Sequence[_Way], rated: bool = False) -> Diagnosis:
    """All steps at which it may have begun. What happened is told by the most probable way, or the one that began
    latest."""
    causes = ways[0].causes
    since = {c: tuple(sorted(set().union(*(way.since[n] for way in ways)))) for n, c in enumerate(causes)}
    done = {way: _happened(case.actions, way.idle) for way in ways}
    told = max(ways, key=lambda way: (-way.cost if rated else 0, way.latest, done[way]))
    return Diagnosis(causes, since, done[told])


def _happened(actions: Sequence[Step], idle: frozenset[tuple[str, int]]) -> tuple[Step, ...]:
    return tuple(tuple(a for a in step if (a, t) not in idle) for t, step in enumerate(actions))


class Expected(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a shipped case must come out as; `probabilities`, where it has rates, go with `diagnoses`."""

    diagnoses: tuple[tuple[str, ...], ...]
    executed: int
    inspect: tuple[str, ...] = ()
    since: dict[str, tuple[int, ...]] = {}
    did_not_happen: tuple[str, ...] = ()
    probabilities: tuple[float, ...] = ()
