"""Why robots cannot be shared without the published limits: what teams have refuted, the delays and the limits, as a
program whose clashes are explanations (``core/why_lend.lp``), and the exchanges that nothing of it speaks against."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from reasoning.domain import core_program
from reasoning.ledger import Ledger, harder
from reasoning.reasons import Role
from reasoning.solver import Model, Program, quoted
from reasoning.values import Question, steps
from reasoning.words import handing


@dataclass(frozen=True)
class Terms:
    """What the coordinator knows besides the teams' answers: all are to be done `within` so many steps, `delays` are
    the steps of transport of each pair (giver, taker), and a team takes at most `most[kind]` robots of a kind. `must`
    and `may_not` are roles that are asked about."""

    within: int
    delays: Mapping[tuple[str, str], int]
    most: Mapping[str, int]
    must: Mapping[str, Role] = field(default_factory=dict)
    may_not: Mapping[str, Role] = field(default_factory=dict)


def refuted(ledger: Ledger, terms: Terms) -> list[Question]:
    """What a team cannot do within these steps, by its answers and by what is certain before any: the easiest of it."""
    k = terms.within
    most = tuple((kind, 0) for kind, number in sorted(terms.most.items()) for _ in range(number))
    nos = [a.question._replace(within=k) for a in ledger.answers if a.verdict == "no" and a.question.within >= k]
    nos += [] if ledger.can_alone else [Question("share", k)]
    nos += [Question("share", k, 0, (), most)] if k < ledger.lower_bound or not ledger.can_borrow else []
    return [q for q in set(nos) if not any(harder(q, other) for other in nos if other != q)]


def program(teams: Mapping[str, Ledger], terms: Terms) -> Program:
    """The question, loaded and grounded."""
    there = {kind: sum(ledger.stock.get(kind, 0) for ledger in teams.values()) for kind in terms.most}
    facts = [f"steps({terms.within}).", *(f"team({quoted(team)})." for team in teams)]
    facts += [f"there({kind},{number}). most({kind},{terms.most[kind]})." for kind, number in there.items()]
    facts += [f"delay({quoted(giver)},{quoted(taker)},{by})." for (giver, taker), by in terms.delays.items()]
    for name, roles in (("must", terms.must), ("may_not", terms.may_not)):
        facts += [f"{name}({quoted(team)},{role})." for team, role in roles.items()]
    number = 0
    for team, ledger in sorted(teams.items()):
        facts += [f"stock({quoted(team)},{kind},{ledger.stock.get(kind, 0)})." for kind in there]
        for question in sorted(refuted(ledger, terms)):
            number += 1
            told = handing(question.gives, question.takes)
            facts.append(f"no({number},{quoted(team)}). said({number},{quoted(told)}).")
            for way, promises in (("gives", question.gives), ("takes", question.takes)):
                facts += [
                    f"{way}({number},{kind},{nth},{min(step, terms.within)})."
                    for kind in there
                    for nth, step in enumerate(steps(promises, kind), 1)
                ]
    loaded = Program([core_program("why_lend")], facts)
    loaded.ground(("base", ()))
    return loaded


def _profiles(model: Model, teams: Mapping[str, Ledger], terms: Terms) -> dict[str, Question]:
    """Each team's part in the exchanges of a model."""
    when = {tuple(a.args[:3]): int(a.args[3]) for a in model.atoms if a.name == "take"}
    gives: dict[str, list[tuple[str, int]]] = {team: [] for team in teams}
    takes: dict[str, list[tuple[str, int]]] = {team: [] for team in teams}
    for atom in model.atoms:
        if atom.name == "from":
            (taker, kind, giver), step = map(str, (*atom.args[:2], atom.args[3])), when[tuple(atom.args[:3])]
            takes[taker].append((kind, step))
            gives[giver].append((kind, step - terms.delays[giver, taker]))
    return {
        team: Question("share", terms.within, 0, tuple(sorted(gives[team])), tuple(sorted(takes[team])))
        for team in teams
    }


def unrefuted(teams: Mapping[str, Ledger], terms: Terms) -> dict[str, Question] | None:
    """Each team's part in some exchanges that nothing known speaks against; None: there are none."""
    loaded = program(teams, terms)
    free = loaded.solve([]).model
    assert free is not None, "nothing speaks against everybody's staying alone if no answer counts"
    solved = loaded.solve([("use", atom.args[:1], True) for atom in free.atoms if atom.name == "group"])
    return None if solved.model is None else _profiles(solved.model, teams, terms)
