"""What an agent must know of its domain's actions: which generic skill each of them is."""

from __future__ import annotations

from reasoning.domain import Domain


def skill(domain: Domain, action: str) -> str:
    """The generic skill of an action's name, ``drive``; empty for a name that the domain does not have."""
    return str(domain.data.actions.get(action, {}).get("skill", ""))


def actions_of(domain: Domain, wanted: str) -> tuple[str, ...]:
    """The names of all actions that are carried out by this skill."""
    return tuple(name for name, data in domain.data.actions.items() if data["skill"] == wanted)


def guest_prefix(domain: Domain) -> str:
    """How the names of robots begin that teams lend one another."""
    return str(domain.data.kinds[domain.data.exchanged]["prefix"]) if domain.data.exchanged else ""
