"""The members of a clash in words: a domain's own from the tables ``why.*`` of its ``domain.toml``, those of the
coordinator's question from here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from reasoning.domain import Domain
from reasoning.solver import Model, Term, parse
from reasoning.why import Clash
from reasoning.words import count

FACTS = {"start": "fact", "seen": "observation"}
"""Members that are fluents with values."""
ORDER = ("hypothesis", "goal", "resource", "team", "fact", "action", "observation", "rule")
SHARING = {
    "alone": ("team", "{0} cannot finish in time without borrowing"),
    "early": ("team", "{0} cannot lend before step {1} and finish in time"),
    "late": ("team", "{0} cannot finish in time if it borrows after step {1}"),
    "delay": ("resource", "transport takes {0}"),
    "must": ("hypothesis", "{0} is to {1}"),
    "may_not": ("hypothesis", "{0} is not to {1}"),
    "refuted": ("team", "{0} cannot finish in time {1}"),
    "stock": ("resource", "{0} has {1} of its own"),
    "most": ("resource", "no team takes more than {0}"),
    "travel": ("resource", "transport from {0} to {1} takes {2}"),
}
"""Members of the coordinator's question (``core/why_share.lp``, ``core/why_lend.lp``)."""


class Told(NamedTuple):
    """`member` as the program writes it. `otherwise` says how a way that does without this rule breaks it
    first; empty for all other members. `needed` is false if it is open whether it is."""

    kind: str
    member: str
    text: str
    otherwise: str
    needed: bool


def told(clash: Clash, domain: Domain | None, first: int = 0) -> list[Told]:
    """The members, the most telling kinds first; `domain` is None for the coordinator's question, `first` the step that
    the program calls 0."""
    found = []
    for member in clash.members:
        kind, text = _worded(member, domain, first) if domain is not None else _shared(member)
        model = clash.without.get(member)
        otherwise = _breach(member, model, domain, first) if model is not None and domain is not None else ""
        found.append(Told(kind, member, text, otherwise, model is not None))
    return sorted(found, key=lambda t: ORDER.index(t.kind))


def _worded(member: str, domain: Domain, first: int) -> tuple[str, str]:
    name, args = parse(member)
    if name == "commanded":
        args = (args[0], int(args[1]) + first)
    why = domain.data.why
    if name in FACTS:
        return FACTS[name], _fluent(str(args[0]), args[1], domain)
    if name == "rule":
        rule = str(args[0])
        return "rule", f"{why.get('rule', {}).get(rule, rule)} [{rule}]"
    for kind, words in why.items():
        if name in words and kind in ORDER:
            return kind, words[name].format(*args)
    return "resource", member


def _shared(member: str) -> tuple[str, str]:
    name, args = parse(member)
    match name, args:
        case "stock" | "most", (*who, robot, int(number)):
            args = (*who, count(number, str(robot)))
        case "delay", (*pair, int(number)):
            name, args = "travel" if pair else "delay", (*pair, count(number, "step"))
    kind, text = SHARING[name]
    if (name, args[-1]) == ("late", -1):
        text = "{0} cannot finish in time even with a borrowed robot"
    return kind, text.format(*args)


def _fluent(fluent: str, value: Term, domain: Domain) -> str:
    name, args = parse(fluent)
    words: Mapping[str, str] = domain.data.why.get("fluent", {})
    values: Mapping[str, object] = domain.data.display.get("values", {}).get(name, {})
    text = words.get(f"{name} {value}", words.get(name, f"{fluent} is {{1}}"))
    inner = parse(value)[1] if isinstance(value, str) else ()
    return text.format(args[0] if args else "", values.get(str(value), value), *inner)


def _breach(member: str, model: Model, domain: Domain, first: int) -> str:
    """Where a way breaks this rule for the first time, if it is left out."""
    name, args = parse(member)
    broken = [
        (int(atom.args[4]), str(atom.args[3]))
        for atom in model.atoms
        if name == "rule" and atom.name == "breach" and atom.args[0] == args[0]
    ]
    if not broken:
        return ""
    step, bodies = min(broken)
    return f"{domain.data.rules[str(args[0])].format(*parse(bodies)[1])} (step {step + first})"
