"""Geometry for the planner: what a domain's programs are told of a room before any search, and where ways lead.

A domain whose ``domain.toml`` has a section ``[geometry]`` names there the constants that describe its rooms, and all
else is done here for all such domains alike. Cells are squares of one metre, cell (x, y) reaches from x to x + 1
metres; constants are integers in centimetres. The facts, for the levels of geometry that want them:

- ``covered(P)``: furniture stands on the middle of cell P, at every level; the others are for ``static`` and ``both``;
- ``path(P,P',MM)``: a robot can go from P to P' past the furniture, the shortest way is so many millimetres long;
- ``part(P,C)``: P is in part C of the floor; parts are not connected;
- ``apart(C,C',Names)``, ``touches(P,Names)``: furniture that is between two parts, or that a robot at P would touch.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import combinations

from reasoning.domain import Domain, load
from reasoning.motion.convex import Point, nearest
from reasoning.motion.layout import Disc, Layout
from reasoning.motion.oracle import Oracle
from reasoning.solver import parse, quoted
from reasoning.values import Problem, State, Value

STATIC_LEVELS = ("static", "both")
WALL = "a wall"
Cell = tuple[int, int]


@dataclass(frozen=True)
class Room:
    """A team's room: its size in cells, its furniture by name, and the radii of robots and things in metres. `level`
    is how much of geometry planning is to know."""

    level: str
    size: Cell
    furniture: tuple[tuple[str, tuple[Point, ...]], ...]
    robot_m: float
    thing_m: float

    @cached_property
    def layout(self) -> Layout:
        """Walls and furniture, without anything that can be moved."""
        return Layout(float(self.size[0]), float(self.size[1]), tuple(corners for _, corners in self.furniture))

    @property
    def cells(self) -> list[Cell]:
        return [(x, y) for y in range(self.size[1]) for x in range(self.size[0])]

    def thing(self, cell: Cell) -> Disc:
        """What lies in a cell, as an obstacle."""
        return (*middle(cell), self.thing_m)


def middle(cell: Cell) -> Point:
    """The point of a cell where robots stand and things lie, in metres."""
    return cell[0] + 0.5, cell[1] + 0.5


def cell(value: Value) -> Cell:
    """A cell that is written as a term. Raises ValueError for anything else."""
    match parse(str(value)):
        case "", (int(x), int(y)):
            return x, y
    raise ValueError(f"not a cell: {value!r}")


def room(domain: str | Domain, static: Mapping[str, Value], state: State) -> Room | None:
    """The room that a team's state speaks of; None where the domain knows no geometry, or the state no room."""
    names = load(domain).data.geometry
    here = state.get(names.get("room", ""))
    size = static.get(f"{names.get('size', '')}({here})")
    if here is None or size is None:
        return None
    furniture = []
    for key, value in static.items():
        match parse(key):
            case name, (where, solid) if name == names["solid"] and where == here:
                corners = [cell(corner) for corner in parse(str(value))[1]]
                furniture.append((str(solid), tuple((x / 100, y / 100) for x, y in corners)))
    return Room(
        str(static.get(names["level"], "none")),
        cell(size),
        tuple(sorted(furniture)),
        int(static[f"{names['radius']}(robot)"]) / 100,
        int(static[f"{names['radius']}(thing)"]) / 100,
    )


def facts(problem: Problem) -> list[str]:
    """What the programs of a domain are told of geometry; nothing where the domain does not want it."""
    known = room(problem.domain, problem.static, problem.state)
    return [] if known is None else list(_facts(known))


@lru_cache(maxsize=64)
def _facts(known: Room) -> tuple[str, ...]:
    oracle = Oracle()
    covered = [c for c in known.cells if not oracle.free(known.layout, 0.0, middle(c))]
    found = [f"covered({_term(c)})." for c in covered]
    if known.level in STATIC_LEVELS:
        found += _ways(known, oracle)
    return tuple(found)


def _ways(known: Room, oracle: Oracle) -> list[str]:
    """All shortest ways past the furniture, and why there are no others."""
    found = []
    parts: list[list[Cell]] = []
    for c in known.cells:
        if not oracle.free(known.layout, known.robot_m, middle(c)):
            found.append(f"touches({_term(c)},{quoted(_touching(known, c))}).")
            continue
        own = next((part for part in parts if _connected(known, oracle, part[0], c)), None)
        if own is None:
            parts.append([c])
        else:
            own.append(c)
    for number, part in enumerate(parts):
        found += [f"part({_term(c)},{number})." for c in part]
        found += [f"path({_term(c)},{_term(c)},0)." for c in part]
        for p, q in combinations(part, 2):
            way = oracle.shortest(known.layout, known.robot_m, middle(p), middle(q))
            if way is not None:
                length_mm = round(1000 * way.length_m)
                found += [f"path({_term(a)},{_term(b)},{length_mm})." for a, b in ((p, q), (q, p))]
    for (a, one), (b, other) in combinations(enumerate(parts), 2):
        names = quoted(between(known, one[0], other[0]))
        found += [f"apart({a},{b},{names}).", f"apart({b},{a},{names})."]
    return found


def between(known: Room, p: Cell, q: Cell) -> str:
    """The names of furniture that leaves no way between two cells where a robot can stand: without any one of these
    pieces there would be one."""
    needed = list(known.furniture)
    for piece in known.furniture:
        without = [other for other in needed if other is not piece]
        layout = Layout(known.layout.width_m, known.layout.height_m, tuple(corners for _, corners in without))
        if not Oracle().path_exists(layout, known.robot_m, middle(p), middle(q)):
            needed = without
    return _listed([name for name, _ in needed])


def _touching(known: Room, c: Cell) -> str:
    """The furniture that a robot in the middle of a cell would touch."""
    oracle = Oracle()
    names = []
    for name, corners in known.furniture:
        alone = Layout(known.layout.width_m, known.layout.height_m, (corners,))
        if any(nearest(middle(c), part)[0] < known.robot_m + oracle.margin_m for part in alone.solids[4:]):
            names.append(name)
    return _listed(names)


def _listed(names: list[str]) -> str:
    if len(names) < 2:
        return f"{names[0]} and {WALL}" if names else WALL
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _connected(known: Room, oracle: Oracle, p: Cell, q: Cell) -> bool:
    return oracle.path_exists(known.layout, known.robot_m, middle(p), middle(q))


def _term(c: Cell) -> str:
    return f"({c[0]},{c[1]})"
