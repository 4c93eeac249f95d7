"""Small rooms for the tests of the domain's programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from reasoning.setup import Refused, Setup, compile_setup
from reasoning.values import Problem

DOMAIN = "housekeeping"
NIGHTSTAND = {"name": "nightstand", "corners": [[100, 0], [190, 0], [190, 100], [100, 100]]}
SHELF = {"name": "shelf", "corners": [[100, 110], [190, 110], [190, 300], [100, 300]]}


def robot(name: str, x: int, y: int, **more: int) -> dict[str, Any]:
    return {"name": name, "at": [x, y], **more}


def thing(name: str, x: int, y: int, kind: str = "cushion", **more: Any) -> dict[str, Any]:
    return {"name": name, "kind": kind, "at": [x, y], **more}


def tables(
    robots: Sequence[dict[str, Any]],
    things: Sequence[dict[str, Any]] = (),
    *,
    level: str = "none",
    size: tuple[int, int] = (4, 3),
    deposit: Sequence[int] = (3, 3, 0, 1),
    **more: Any,
) -> dict[str, Any]:
    team = {
        "room": "living_room", "width": size[0], "height": size[1], "deposit": list(deposit),
        "robots": list(robots), "things": list(things), **more,
    }  # fmt: skip
    return {"house": {"geometry": level}, "teams": {"T1": team}}


def setup(*args: Any, **more: Any) -> Setup:
    found = compile_setup(DOMAIN, tables(*args, **more))
    assert not isinstance(found, Refused), found
    return found


def problem(*args: Any, held: dict[str, str] | None = None, **more: Any) -> Problem:
    """`held[robot]` is the end of a thing that it is attached to, as ``grip(book,1)``."""
    found = setup(*args, **more)
    state = {**found.states["T1"], **{f"connected({r})": end for r, end in (held or {}).items()}}
    return Problem(DOMAIN, found.static, state)
