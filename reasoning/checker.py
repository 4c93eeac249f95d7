"""The independent checker: is this joint plan right?

Every violation of every rule is told, by a program that shares no law with the planner (``check.lp``). An illegal
action has no effect, and what follows is judged in the state that results. What a rule means in plain words is in
``domain.toml``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from reasoning.domain import Domain, load
from reasoning.solver import Atom, models, parse, quoted
from reasoning.values import State, Step, Value, Violation

Details = Mapping[tuple[int, str], Mapping[str, Value]]


class Exchange(NamedTuple):
    """`worker` leaves `giver` in step `give_step` and joins `taker` as `known_as` in step `take_step`. A giver that is
    not among the teams of the plan is taken at its word; a negative `give_step` is before the plan's start."""

    worker: str
    giver: str
    give_step: int
    taker: str
    take_step: int
    known_as: str


class Break(NamedTuple):
    """`robot` breaks, unseen, and is broken from step `step` on until it is repaired."""

    team: str
    robot: str
    step: int


@dataclass(frozen=True)
class Verdict:
    """`discrepancies` are actions that were right but had no effect, since a robot had broken unseen."""

    violations: tuple[Violation, ...]
    discrepancies: tuple[Violation, ...] = ()


def check(
    domain: str | Domain,
    static: Mapping[str, Value],
    states: Mapping[str, State],
    plan: Mapping[str, Sequence[Step]],
    *,
    exchanges: Iterable[Exchange] | None = None,
    details: Mapping[str, Details] | None = None,
    breaks: Iterable[Break] = (),
    kinds: Mapping[str, Mapping[str, str]] | None = None,
) -> list[Violation]:
    """The violations of `examine`: none means that the plan is right and reaches the goal of every team."""
    verdict = examine(domain, static, states, plan, exchanges=exchanges, details=details, breaks=breaks, kinds=kinds)
    return list(verdict.violations)


def examine(
    domain: str | Domain,
    static: Mapping[str, Value],
    states: Mapping[str, State],
    plan: Mapping[str, Sequence[Step]],
    *,
    exchanges: Iterable[Exchange] | None = None,
    details: Mapping[str, Details] | None = None,
    breaks: Iterable[Break] = (),
    kinds: Mapping[str, Mapping[str, str]] | None = None,
) -> Verdict:
    """Judge the plan of all teams together.

    `states[team]` is the sensed state at the start, with ``broken(R)`` for robots known to be broken; `plan[team][t]`
    the actions of step t; a team without a plan stays idle. `exchanges`: None means that any that fit will do.
    `details[team]` is what the written actions leave out; where it is missing, what leaves fewest violations is
    assumed. `breaks` are failures that are known to have happened. `kinds[team]` are the kinds of robots that come from
    teams of which nothing else is told. An action that is no term is a violation, no error.
    """
    domain = load(domain)
    facts, violations = _plan(plan)
    facts += [f"static({key},{value})." for key, value in static.items()]
    facts += [f"team({quoted(team)})." for team in states]
    facts += [
        f"init({quoted(team)},{fluent},{value})." for team, state in states.items() for fluent, value in state.items()
    ]
    facts += [
        f"detail({quoted(team)},{action},{step},{key},{value})."
        for team, by_action in (details or {}).items()
        for (step, action), detail in by_action.items()
        for key, value in detail.items()
        if is_term(action) and (isinstance(value, int) or is_term(value))
    ]
    facts += [] if exchanges is None else ["told."]
    for e in exchanges or ():
        if is_term(e.worker) and is_term(e.known_as):
            ends = f"{quoted(e.giver)},{e.give_step},{quoted(e.taker)},{e.take_step}"
            facts.append(f"exchange({e.worker},{ends},{e.known_as}).")
        else:
            text = "is an exchange of what is not written as a name"
            violations.append(Violation(e.taker, e.take_step, f"{e.worker} as {e.known_as}", "unknown", text))
    facts += [f"kind({quoted(t)},{robot},{kind})." for t, some in (kinds or {}).items() for robot, kind in some.items()]
    facts += [f"breaks({quoted(b.team)},{b.robot},{b.step})." for b in breaks if is_term(b.robot)]
    return _verdict(domain, judged(domain, static, states, facts), violations)


def judged(
    domain: Domain,
    static: Mapping[str, Value],
    states: Mapping[str, State],
    facts: Sequence[str],
    entries: Sequence[str] = ("check",),
) -> tuple[Atom, ...]:
    """What the program says, once it has been told of all ways that it asks for. Where a step leads depends on the ways
    in the steps before it, so this ends after as many rounds as there are steps, if not sooner."""
    programs = [domain.program(entry) for entry in entries]
    if not domain.data.geometry:
        return models(programs, facts, optimum=True)[-1].atoms
    from reasoning import replay  # only now: slow to import, and most domains do without

    ways: list[str] = []
    while True:
        (*_, model) = models(programs, [*facts, *ways], optimum=True)
        told = replay.facts(domain, static, states, model.atoms)
        if told == ways:
            return model.atoms
        ways = told


def _plan(plan: Mapping[str, Sequence[Step]]) -> tuple[list[str], list[Violation]]:
    """The plan as facts; what facts cannot say is a violation at once."""
    facts = [f"horizon({max(map(len, plan.values()), default=0)})."]
    violations = []
    for team, steps in plan.items():
        for step, actions in enumerate(steps):
            for action, times in Counter(actions).items():
                if not is_term(action):
                    violations.append(Violation(team, step, action, "unknown", "is not written as an action"))
                    continue
                facts.append(f"occurs({quoted(team)},{action},{step}).")
                if times > 1:
                    violations.append(Violation(team, step, action, "repeated", f"is commanded {times} times at once"))
    return facts, violations


def is_term(text: str) -> bool:
    """Is this a constant, or a compound term with a name? Nothing else may become part of a program."""
    try:
        name, _ = parse(text)
    except ValueError:
        return False
    return bool(name)


def _verdict(domain: Domain, atoms: Iterable[Atom], violations: Iterable[Violation]) -> Verdict:
    words = domain.data.rules
    found, discrepancies = list(violations), []
    for name, args in atoms:
        match name, args:
            case "err", (team, int(step), rule, action, values):
                text = words.get(str(rule), str(rule)).format(*parse(str(values))[1])
                found.append(Violation(str(team), step, str(action), str(rule), text))
            case "discrepancy", (team, int(step), action, robot):
                text = f"had no effect: {robot} was broken"
                discrepancies.append(Violation(str(team), step, str(action), "failed", text))
    return Verdict(_sorted(found), _sorted(discrepancies))


def _sorted(found: Iterable[Violation]) -> tuple[Violation, ...]:
    return tuple(sorted(found, key=lambda v: (v.step, v.team, v.action, v.rule, v.text)))
