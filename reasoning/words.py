"""Numbers in sentences that people read."""

from __future__ import annotations


def count(number: int, noun: str) -> str:
    """``1 step``, ``2 steps``, ``0 bodies``: a number with its noun, whose plural must be a regular one."""
    if number == 1:
        return f"1 {noun}"
    regular = f"{noun[:-1]}ies" if noun.endswith("y") and noun[-2:-1] not in "aeiou" else f"{noun}s"
    return f"{number} {regular}"
