"""Numbers in sentences that people read."""

from __future__ import annotations

from collections.abc import Iterable


def count(number: int, noun: str) -> str:
    """``1 step``, ``2 steps``, ``0 bodies``: a number with its noun, whose plural must be a regular one."""
    if number == 1:
        return f"1 {noun}"
    regular = f"{noun[:-1]}ies" if noun.endswith("y") and noun[-2:-1] not in "aeiou" else f"{noun}s"
    return f"{number} {regular}"


def handing(gives: Iterable[tuple[str, int]], takes: Iterable[tuple[str, int]]) -> str:
    """What a question asks of a team, by kinds of robots and steps; ``alone`` if it exchanges nothing."""
    parts = [f"giving a {kind} by step {step}" for kind, step in gives]
    parts += [f"taking a {kind} from step {step} on" for kind, step in takes]
    return ", ".join(parts) or "alone"
