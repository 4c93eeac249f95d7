"""Why there is no shared plan: the coordinator's question, put to the solver, from what the teams answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ops.shares import DELAY
from ops.tables import InputError
from ops.whyasker import Asker, Part
from ops.whysubjects import Subject
from reasoning.reasons import Role, no_sharing

PUBLISHED = "nobody lends or borrows more than one robot, and nobody does both"


def sharing(
    asker: Asker,
    claim: str,
    within: int,
    must: Mapping[str, Role] | None = None,
    may_not: Mapping[str, Role] | None = None,
) -> Part:
    """The coordinator's question, from what the teams answer. Raises `EndedError`, and `InputError` where teams share
    their robots without the published limits: that is not explained yet."""
    published(asker.subject)
    must, may_not = must or {}, may_not or {}
    teams = sorted(asker.subject.states)
    alone = [team for team in teams if not asker.can(team, "alone", within)]
    borrowers = {*alone, *(team for team, role in must.items() if role == "borrow")}
    delay = int(asker.subject.static.get(DELAY, 0))
    late = {team: _latest(asker, team, within) for team in sorted(borrowers)}
    useful = sorted({step - delay for step in late.values() if step >= delay})
    early = {team: _earliest(asker, team, within, useful) for team in teams if team not in alone}
    make = no_sharing(within, delay, teams, alone=alone, early=early, late=late, must=must, may_not=may_not)
    refuted = "what a team cannot do was refuted by its own planner"
    return asker.part(claim, make, f"{within} steps are possible so", PUBLISHED, refuted, shared=True)


def published(subject: Subject) -> None:
    """Raises `InputError` where teams share their robots without the published limits."""
    if subject.static.get("sharing", "published") != "published":
        raise InputError(f"{subject.name}: only sharing under the published limits can be explained; this is general")


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
