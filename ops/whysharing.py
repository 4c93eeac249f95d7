"""Why there is no shared plan: the coordinator's question, put to the solver, from what the teams answer, under the
published limits or without them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bus.clock import wall_s
from ops import shares
from ops.whyasker import Asker, EndedError, Part
from ops.whysubjects import Subject
from reasoning.guests import guests
from reasoning.ledger import Ledger, learned
from reasoning.planner import Planner
from reasoning.prospects import prospects
from reasoning.reasons import Role, no_sharing
from reasoning.refusals import Terms, program, unrefuted
from reasoning.setup import Setup
from reasoning.solver import parse
from reasoning.values import Problem, State

REFUTED = "what a team cannot do was refuted by its own planner"
PUBLISHED = "nobody lends or borrows more than one robot, and nobody does both"


def sharing(
    asker: Asker,
    claim: str,
    within: int,
    must: Mapping[str, Role] | None = None,
    may_not: Mapping[str, Role] | None = None,
) -> Part:
    """The coordinator's question, from what the teams answer; `must` and `may_not` are roles that are asked about.
    Raises `EndedError`."""
    must, may_not = must or {}, may_not or {}
    if shares.general(as_set_up(asker.subject)):
        return _general(asker, claim, within, must, may_not)
    teams = sorted(asker.subject.states)
    alone = [team for team in teams if not asker.can(team, "alone", within)]
    borrowers = {*alone, *(team for team, role in must.items() if role == "borrow")}
    delay = int(asker.subject.static.get(shares.DELAY, 0))
    late = {team: _latest(asker, team, within) for team in sorted(borrowers)}
    useful = sorted({step - delay for step in late.values() if step >= delay})
    early = {team: _earliest(asker, team, within, useful) for team in teams if team not in alone}
    make = no_sharing(within, delay, teams, alone=alone, early=early, late=late, must=must, may_not=may_not)
    return asker.part(claim, make, f"{within} steps are possible so", PUBLISHED, REFUTED, shared=True)


def as_set_up(subject: Subject) -> Setup:
    """The teams' start, as far as planning needs it."""
    return Setup(subject.static, subject.states, (), {}, {})


def _general(asker: Asker, claim: str, within: int, must: Mapping[str, Role], may_not: Mapping[str, Role]) -> Part:
    """Without the published limits. Exchanges that nothing known speaks against are looked for, and the teams are asked
    about their parts in them, until there are none, or all teams say yes."""
    subject = asker.subject
    setup = as_set_up(subject)
    most = shares.most(subject.domain, setup)
    problems = {
        team: Problem(subject.domain.name, subject.static, state, guests=guests(subject.domain, _names(state), most))
        for team, state in subject.states.items()
    }
    planners = {team: Planner(problem, clock=wall_s) for team, problem in problems.items()}
    teams: dict[str, Ledger] = {}
    for team, problem in problems.items():
        alone = prospects(replace(problem, guests=()))
        bound, helped = planners[team].lower_bound(), bool(problem.guests) and not planners[team].hopeless()
        teams[team] = Ledger(bound, (), not alone.hopeless, helped, alone.stock)
    terms = Terms(within, shares.delays(setup), most, must, may_not)
    possible = False
    while not possible and (parts := unrefuted(teams, terms)) is not None:
        possible = True
        for team, part in sorted(parts.items()):
            if teams[team].verdict(part) == "yes":
                continue
            asker.progress(f"{team}: {shares.words(part)}, within {within} steps")
            answer = planners[team].answer(part, seconds=asker.left_s())
            if answer.verdict == "unknown":
                raise EndedError(
                    f"{team} had not answered whether it can finish in {within} steps {shares.words(part)}"
                )
            teams[team] = teams[team].learn(learned(answer))
            if answer.verdict == "no":
                possible = False
                break
    return asker.part(claim, lambda: program(teams, terms), f"{within} steps are possible so", REFUTED, shared=True)


def _names(state: State) -> set[str]:
    """Whatever the state speaks of: names that no guest may have."""
    return {str(argument) for fluent in state for argument in parse(fluent)[1]}


def _earliest(asker: Asker, team: str, within: int, useful: Sequence[int]) -> int:
    """A step before which the team cannot lend, as far as it matters: some borrower has use for a robot that is given
    by one of the useful steps, and none for later ones."""
    low, high = 0, len(useful)
    while low < high:
        middle = (low + high) // 2
        if asker.can(team, "lend", within, useful[middle]):
            high = middle
        else:
            low = middle + 1
    return useful[low - 1] + 1 if low else 0


def _latest(asker: Asker, team: str, within: int) -> int:
    """The latest step from which the team can borrow; -1 if that does not help at all."""
    low, high = -1, within - 1
    while low < high:
        middle = (low + high + 1) // 2
        if asker.can(team, "borrow", within, middle):
            low = middle
        else:
            high = middle - 1
    return low
