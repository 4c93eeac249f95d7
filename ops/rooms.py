"""From what a domain's set-up says of rooms to what the world is told of them: walls, furniture, areas, and walks.

Which constants say so is named in ``domain.toml`` under ``[geometry]`` (see `reasoning.geometry`); cells are squares of
one metre, constants are integers in centimetres.
"""

from __future__ import annotations

from typing import Any

from bus.scene import Stop
from reasoning.domain import Domain
from reasoning.setup import Setup
from reasoning.solver import parse
from reasoning.values import State, Value

AGAIN, STOP = "again", "stop"
"""Hidden fluents of a person: ``again(N)`` and ``stop(N,I)`` = (units of time, cell)."""


def size(domain: Domain, setup: Setup, kind: str) -> dict[str, Any]:
    """What the constants say of a kind of bodies: its radius; nothing where they do not."""
    radius_cm = setup.static.get(f"{domain.data.geometry.get('radius', '')}({kind})")
    return {} if radius_cm is None else {"radius_m": int(radius_cm) / 100}


def walls(domain: Domain, setup: Setup, team: str) -> dict[str, Any]:
    """Fields of a `bus.scene.Workspace` that is a room; none where the domain knows no rooms."""
    names, state = domain.data.geometry, setup.states[team]
    here = state.get(names.get("room", ""))
    if here is None:
        return {}
    solids, areas = [], {}
    for key, value in setup.static.items():
        match parse(key):
            case name, (where, other) if name == names["solid"] and where == here:
                corners = [tuple(cm / 100 for cm in _numbers(corner)) for corner in parse(str(value))[1]]
                solids.append(
                    {"name": other, "corners": corners, "tall": f"{names['tall']}({here},{other})" in setup.static}
                )
            case name, (where, other) if name == names["area"] and where == here:
                areas[str(other)] = _numbers(value)
    store = areas.pop(str(here), None)
    return {
        "room": str(here),
        "solids": solids,
        "doors": areas,
        "store": store,
        "fluents": {fluent: value for fluent, value in state.items() if "(" not in fluent},
        "clock": domain.data.costs.get("clock", ""),
    }


def stops(state: State, name: str, unit_s: float) -> tuple[Stop, ...]:
    """A person's walk; nobody else has one."""
    found: list[tuple[int, Stop]] = []
    for key, value in state.items():
        match parse(key):
            case functor, (who, int(number)) if functor == STOP and who == name:
                units, to = parse(str(value))[1]
                x, y = _numbers(to)
                found.append((number, Stop(int(units) * unit_s, x + 0.5, y + 0.5)))
    return tuple(stop for _, stop in sorted(found, key=lambda numbered: numbered[0]))


def _numbers(term: Value) -> tuple[int, ...]:
    """A tuple of integers that is written as a term."""
    return tuple(map(int, parse(str(term))[1]))
