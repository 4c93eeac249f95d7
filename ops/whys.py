"""Questions why about a scenario, a plan or a recorded run, put to the solver. A question may have several parts: each
is a claim with the clash that refutes the opposite."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bus.clock import wall_s
from ops import shares
from ops.tables import InputError
from ops.whyasker import Asker, Part
from ops.whysharing import PUBLISHED, as_set_up, sharing
from ops.whysubjects import Subject
from reasoning.diagnoser import broken_in, diagnose
from reasoning.domain import Domain
from reasoning.planner import Planner
from reasoning.prospects import prospects
from reasoning.reasons import (
    Role,
    contradicts,
    never,
    never_in_time,
    no_plan,
    no_sharing,
    not_possible,
    without_time,
)
from reasoning.solver import parse
from reasoning.values import Case, Diagnosis, Problem
from reasoning.why import Clash, Possible, Unknown

BEYOND = 12
"""A length that suffices is looked for up to so many steps beyond the one that is asked about."""
BOUND = 3
"""At most so many robots are suspected at once."""


# ---------------------------------------------------------------- no plan, or none that is shorter
def no_plan_at_all(asker: Asker, team: str = "") -> list[Part]:
    """Why is there no plan, however long? For teams that share their robots, which of them stand in the way, then why
    they do; for others, why each of them, or only `team`, does."""
    subject = asker.subject
    own = {name: replace(subject.problem(name), guest="") for name in subject.states}
    if len(own) == 1 or not subject.domain.data.exchanged:
        asked = {name: problem for name, problem in own.items() if team in ("", name)}
        hopeless = {name: problem for name, problem in asked.items() if Planner(problem).hopeless()}
        return [_never(asker, name, problem, "") for name, problem in (hopeless or asked).items()]
    alone = [team for team, problem in own.items() if Planner(problem).hopeless()]
    if shares.general(as_set_up(subject)):
        if not alone:
            raise InputError(f"{subject.name}: every team might finish by itself, however long; ask --within STEPS")
        return [_never(asker, name, own[name], " alone") for name in alone]
    helpless = {team: -1 for team in alone if Planner(subject.problem(team)).hopeless()}
    make = no_sharing(1, 0, own, alone=alone, late=helpless)
    possible = "nothing speaks against a shared plan as long as time is left out; ask --within STEPS"
    shared = asker.part("there is no shared plan, however long", make, possible, PUBLISHED, shared=True)
    parts = [shared]
    for member in shared.result.members if isinstance(shared.result, Clash) else ():
        name, (who, *_) = parse(member)
        helped = name == "late"
        problem = subject.problem(str(who)) if helped else own[str(who)]
        parts.append(_never(asker, str(who), problem, " even with a borrowed robot" if helped else " alone"))
    return parts


def _never(asker: Asker, team: str, problem: Problem, how: str) -> Part:
    """Without a thought of time, and where that explains nothing and there is a deadline, with it."""
    claim = f"{team} has no plan{how}, however long"
    possible = (
        f"{team}: nothing speaks against a plan{how} as long as time and crowding are left out; ask --within STEPS"
    )
    part = asker.part(claim, never(problem), possible)
    untimed = without_time(problem)
    if not isinstance(part.result, Possible) or untimed == problem:
        return part
    longest = prospects(problem).longest
    found = Planner(untimed, clock=wall_s).shortest(seconds=asker.left_s())
    if found.plan is None:
        return part
    enough = max(longest, found.plan.makespan)
    note = f"without the deadline, {enough} steps were tried"
    return asker.part(claim, never_in_time(problem, enough), f"{team} can finish in {enough} steps", note)


def not_within(asker: Asker, within: int, team: str = "") -> list[Part]:
    """Why is there no plan of at most `within` steps? For teams that share their robots, which of them, and which
    exchanges, stand in the way; then, with `team`, why that one cannot. For others, why each of them, or only `team`,
    cannot."""
    teams = list(asker.subject.states)
    if len(teams) == 1 or not asker.subject.domain.data.exchanged:
        asked = [name for name in teams if team in ("", name)]
        late = [name for name in asked if len(asked) > 1 and not asker.can(name, "alone", within)]
        return [_refused(asker, name, within) for name in late or asked]
    shared = sharing(asker, f"there is no shared plan of {within} steps", within)
    return [shared, *(_members(asker, shared.result, within, team) if team else ())]


def _members(asker: Asker, result: Clash | Possible | Unknown, within: int, team: str) -> list[Part]:
    """Why the team cannot do what the shared clash says of it."""
    wanted: list[tuple[tuple[Role, int] | None, str]] = []
    for member in result.members if isinstance(result, Clash) else ():
        match parse(member):
            case "alone", (who,) if who == team:
                wanted.append((None, "without borrowing"))
            case "early", (who, int(step)) if who == team:
                wanted.append((("lend", step - 1), f"if it lends before step {step}"))
            case "late", (who, int(step)) if who == team:
                words = f"if it borrows after step {step}" if step >= 0 else "even with a borrowed robot"
                wanted.append((("borrow", step + 1), words))
    return [
        _refused(asker, team, within, exchange, f" {how}", asker.left_s() / (len(wanted) - number))
        for number, (exchange, how) in enumerate(wanted)
    ]


def _refused(
    asker: Asker,
    team: str,
    within: int,
    exchange: tuple[Role, int] | None = None,
    words: str = "",
    seconds: float | None = None,
) -> Part:
    kind, step = exchange or ("alone", 0)
    lengths = range(within + 1, within + BEYOND)
    enough = next((k for k in lengths if asker.can(team, kind, k, step)), within + BEYOND)
    return asker.part(
        f"{team} cannot finish in {within} steps{words}",
        no_plan(asker.subject.problem(team), within, enough, exchange),
        f"{team} can finish in {within} steps{words}",
        f"without the limit on steps, {enough} steps were tried",
        seconds=seconds,
    )


# ---------------------------------------------------------------- who lends, who borrows
def other_role(asker: Asker, role: Role, team: str, other: str, deep: str = "") -> list[Part]:
    """Why does `team` lend or borrow, and not `other`, in a plan of this length? Then, with `deep`, why that team
    cannot do what stands in the way. Raises `InputError` if it does not."""
    subject = asker.subject
    plays = {role: {x.giver if role == "lend" else x.taker for x in subject.exchanges} for role in ("lend", "borrow")}
    if team not in plays[role]:
        told = ", ".join(sorted(plays[role])) or "nobody"
        raise InputError(f"{team} does not {role} in this plan; who does: {told}")
    claim = f"{subject.makespan} steps are not possible unless {team} {role}s"
    must: dict[str, Role] = {}
    notes: tuple[str, ...] = ()
    if other in plays[role]:
        notes = (f"{other} {role}s in this plan as well, so it cannot do so instead of {team}",)
    elif other:
        must = {other: role}
        claim = f"{subject.makespan} steps are not possible if {other} {role}s and {team} does not"
    part = sharing(asker, claim, subject.makespan, must, {team: role})
    shared = replace(part, notes=(*notes, *part.notes))
    return [shared, *(_members(asker, shared.result, subject.makespan, deep) if deep else ())]


# ---------------------------------------------------------------- an action, a suspicion
def impossible(asker: Asker, team: str, action: str, step: int) -> list[Part]:
    """Why was this action not possible in this step, beside what was done in it?"""
    subject = asker.subject
    steps = subject.teams.get(team, ())
    if not 0 <= step <= len(steps):
        raise InputError(f"--step {step}: {team} has steps 0 to {len(steps)}")
    guest = parse(action)[1][0] if _skill(subject.domain, action) == "arrive" else ""
    problem = Problem(subject.domain.name, subject.static, subject.before(team, step), str(guest))
    others = steps[step] if step < len(steps) else ()
    claim = f"{team} cannot do {action} in step {step}"
    make = not_possible(problem, action, others)
    return [asker.part(claim, make, f"{team} can do {action} in step {step}", first=step)]


def _skill(domain: Domain, action: str) -> str:
    try:
        return str(domain.data.actions.get(parse(action)[0], {}).get("skill", ""))
    except ValueError as error:
        raise InputError(f"--action {action}: expected an action, as move(w1,right)") from error


def suspicion(asker: Asker, team: str, suspected: str, other: str, step: int | None = None) -> list[Part]:
    """Why is one robot suspected, and another not? Of a case, or of the team's discrepancy in that step. Inspections
    are looked at where the question cannot be answered without."""
    domain = asker.subject.domain
    if not (domain.folder / "why_suspect.lp").is_file():
        raise InputError(f"{asker.subject.name}: the domain {domain.name} cannot be asked about suspicions yet")
    case, findings, at = _case(asker.subject, team, step)
    robots = {argument for fluent in case.before for argument in parse(fluent)[1] if isinstance(argument, str)}
    robots |= {name for name, _ in case.guests}
    for name in (suspected, other):
        if name and name not in robots:
            raise InputError(f"{name}: there is no such robot; there are {', '.join(sorted(robots))}")
    result = diagnose(case)
    most = len(broken_in(result.least[0])) if result.least else case.bound
    told = _listed(result.diagnoses) or "nothing that the team knows of"
    told += (
        f"; set aside, since more would have happened otherwise: {_listed(result.set_aside)}"
        if result.set_aside
        else ""
    )
    when = f" after step {at}" if asker.subject.case is None else ""
    note = f"explanations with fewest causes{', before any inspection' if findings else ''}: {told}"

    def asked(claim: str, opposite: str, broken: str = "", whole: str = "") -> Part:
        for known in [{}, findings] if findings else [{}]:
            make = contradicts(case, broken=broken, whole=whole, most=most, findings=known)
            part = asker.part(
                f"{claim}{when}", make, f"nothing contradicts that {opposite}{when}: {told}", note, first=at
            )
            if not isinstance(part.result, Possible):
                break
        return part

    parts = [asked(f"{suspected} is broken", f"{suspected} is whole", whole=suspected)] if suspected else []
    return parts + ([asked(f"{other} is not suspected", f"{other} is broken", broken=other)] if other else [])


def _listed(diagnoses: Sequence[Diagnosis]) -> str:
    return " or ".join("{" + ", ".join(d.causes) + "}" for d in diagnoses)


def _case(subject: Subject, team: str, step: int | None) -> tuple[Case, Mapping[str, str], int]:
    """What the team knew of the step in which things went otherwise, inspections after it, and the step."""
    if subject.case is not None:
        return subject.case, {}, 0
    odd = [when for who, when in subject.odd if who == team and step in (None, when)]
    if not odd:
        met = ", ".join(f"{who} in step {when}" for who, when in subject.odd) or "nobody met one"
        raise InputError(f"{subject.name}: {team} met no discrepancy there; in this run: {met}")
    at = odd[0]
    known = subject.before(team, at)
    case = Case(subject.domain.name, subject.static, known, (subject.teams[team][at],), subject.seen[at][team], BOUND)
    return case, subject.findings.get((team, at), {}), at
