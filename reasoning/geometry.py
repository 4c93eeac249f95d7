"""Geometry for the planner: what a domain's programs are told of a room before any search, and where ways lead.

A domain whose ``domain.toml`` has a section ``[geometry]`` names there the constants that describe its rooms, and all
else is done here for all such domains alike. Cells are squares of one metre, cell (x, y) reaches from x to x + 1
metres; constants are integers in centimetres. The facts, for the levels of geometry that want them:

- ``covered(P)``: furniture stands on the middle of cell P; at every level;
- ``part(P,C)``: P is in part C of the floor; parts are not connected; at every level but ``none``;
- ``apart(C,C',Names)``, ``touches(P,Names)``: furniture that is between two parts, or that a robot at P would touch;
- ``path(P,P',MM)``: a robot can go from P to P' past the furniture, the shortest way is so many millimetres long; at
  ``static`` and ``both``.

At ``interleaved`` and ``both``, geometry takes part in the search itself (`interleave`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from itertools import combinations

from reasoning.domain import Domain, load
from reasoning.lessons import Lessons
from reasoning.motion.connectivity import MARGIN_M
from reasoning.motion.convex import Point, nearest
from reasoning.motion.judge import RoomJudge
from reasoning.motion.layout import WALLS, Disc, Layout
from reasoning.motion.oracle import Oracle
from reasoning.motion.payload import PayloadPlanner
from reasoning.propagation import MotionPropagator, Names
from reasoning.solver import Program, parse, quoted
from reasoning.values import Problem, State, Value

STATIC_LEVELS = ("static", "both")
INTERLEAVED_LEVELS = ("interleaved", "both")
LIMITS_M = (2, 3, 4, 6, 8, 9, 12)
"""Ways may be told to be longer than so much: multiples of what robots do in a unit of time."""
WALL = "a wall"
NAMES = Names("stands", "go", "lies_still", longer="longer", pair="pair")
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
    return [] if known is None else list(room_facts(known))


def interleave(problem: Problem, program: Program) -> None:
    """Let geometry take part in the program's searches, where the scenario wants that; what it has learned about the
    room in earlier searches is known from the start.

    The program says in each step, in the predicates of `NAMES`, who stands and goes where and what is in the way.
    """
    known = room(problem.domain, problem.static, problem.state)
    if known is not None and known.level in INTERLEAVED_LEVELS:
        program.register(MotionPropagator(NAMES, lessons(known)))


@lru_cache(maxsize=8)
def lessons(known: Room) -> Lessons:
    """What is learned about a room, by all searches of this process."""
    return Lessons(judge(known), LIMITS_M)


def judge(known: Room) -> RoomJudge:
    """Who knows the geometry of a room."""
    return RoomJudge(
        Oracle(),
        known.layout,
        point=lambda place: middle(cell(place)),
        radius_m=lambda _: known.robot_m,
        disc=lambda key: known.thing(cell(key[-1])),
        payload=_payload(),
        carried_m=known.thing_m,
        furniture_known=known.level in STATIC_LEVELS,
    )


@cache
def _payload() -> PayloadPlanner:
    """One for all rooms, since it has a process of its own."""
    return PayloadPlanner(Oracle())


@lru_cache(maxsize=64)
def room_facts(known: Room) -> tuple[str, ...]:
    """The facts about a room, made once."""
    oracle = Oracle()
    covered = [c for c in known.cells if not oracle.free(known.layout, 0.0, middle(c))]
    found = [f"covered({_term(c)})." for c in covered]
    if known.level in (*STATIC_LEVELS, *INTERLEAVED_LEVELS):
        parts = _parts(known, oracle)
        found += _between(known, parts)
        if known.level in STATIC_LEVELS:
            found += _ways(known, oracle, parts)
    return tuple(found)


def _parts(known: Room, oracle: Oracle) -> list[list[Cell]]:
    """The cells where a robot can stand, by the parts of the floor that are not connected."""
    parts: list[list[Cell]] = []
    for c in known.cells:
        if oracle.free(known.layout, known.robot_m, middle(c)):
            own = next((part for part in parts if _connected(known, oracle, part[0], c)), None)
            if own is None:
                parts.append([c])
            else:
                own.append(c)
    return parts


def _between(known: Room, parts: list[list[Cell]]) -> list[str]:
    """Where a robot can stand, and what keeps it from where it cannot."""
    found = [f"part({_term(c)},{number})." for number, part in enumerate(parts) for c in part]
    standing = {c for part in parts for c in part}
    touched = {c: [name for name, _ in _near(known, c)] or [WALL] for c in known.cells if c not in standing}
    found += [f"touches({_term(c)},{quoted(_listed(names))})." for c, names in touched.items()]
    for (a, one), (b, other) in combinations(enumerate(parts), 2):
        names = quoted(between(known, one[0], other[0]))
        found += [f"apart({a},{b},{names}).", f"apart({b},{a},{names})."]
    return found


def _ways(known: Room, oracle: Oracle, parts: list[list[Cell]]) -> list[str]:
    """All shortest ways past the furniture."""
    found = [f"path({_term(c)},{_term(c)},0)." for part in parts for c in part]
    for part in parts:
        for p, q in combinations(part, 2):
            way = oracle.shortest(known.layout, known.robot_m, middle(p), middle(q))
            if way is not None:
                length_mm = round(1000 * way.length_m)
                found += [f"path({_term(a)},{_term(b)},{length_mm})." for a, b in ((p, q), (q, p))]
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
    names = [name for name, _ in needed]
    return _listed(names if len(names) > 1 else [*names, WALL])


def near(domain: Domain, static: Mapping[str, Value], states: Mapping[str, State]) -> list[str]:
    """Where robots are too near to furniture, for programs that check a set-up: ``near(Team,P,Name,MM,MM')``, the
    furniture is MM millimetres from the middle of cell P, of which a robot must be MM' away."""
    rooms = {team: known for team, state in states.items() if (known := room(domain, static, state))}
    return [
        f"near({quoted(team)},{_term(c)},{name},{round(1000 * away_m)},{round(1000 * _needed_m(known))})."
        for team, known in rooms.items()
        for c in known.cells
        for name, away_m in _near(known, c)
    ]


def _near(known: Room, c: Cell) -> list[tuple[str, float]]:
    """The furniture that a robot in the middle of a cell would touch, and how far it is from there, metres."""
    found = []
    for name, corners in known.furniture:
        alone = Layout(known.layout.width_m, known.layout.height_m, (corners,))
        away_m = min(nearest(middle(c), part)[0] for part in alone.solids[WALLS:])
        if away_m < _needed_m(known):
            found.append((name, away_m))
    return found


def _needed_m(known: Room) -> float:
    return known.robot_m + MARGIN_M


def _listed(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]


def _connected(known: Room, oracle: Oracle, p: Cell, q: Cell) -> bool:
    return oracle.path_exists(known.layout, known.robot_m, middle(p), middle(q))


def _term(c: Cell) -> str:
    return f"({c[0]},{c[1]})"
