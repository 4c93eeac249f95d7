"""The checker's own geometry: the ways of a plan, looked for with everything where it is at that step, and replayed.

Programs that check (``check.lp``) say ``travels(Team,A,T,R,P,P')``: action A of step T takes robot R from cell P to P';
and ``in_the_way(Team,B,P,T)``: B lies in cell P and does not move in that step. They are told in turn ``travelled(
Team,A,T,P,P',MM)``, the length of the way; ``stuck(Team,A,T,P,P',Names)``, there is none, and what is in the way; or
``collides(Team,A,T,P,P',Name)``, what the robot would touch on the way that was found. Ways come from the motion
planner, as they do when a plan is executed; the replay shares nothing with it but the polygons.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from reasoning import geometry
from reasoning.domain import Domain
from reasoning.geometry import Cell, Room, middle
from reasoning.motion.convex import Point
from reasoning.motion.layout import Disc
from reasoning.motion.oracle import Oracle
from reasoning.motion.trajectory import Trajectory
from reasoning.solver import Atom, Term, parse, quoted
from reasoning.values import State, Value

STEP_M = 0.01
"""A way is replayed in steps of this length at most."""
TOUCH_M = 1e-6
"""Rounding: so much nearer than its radius a robot may come."""


def facts(domain: Domain, static: Mapping[str, Value], states: Mapping[str, State], atoms: Iterable[Atom]) -> list[str]:
    """What the checking program is told of the ways that its answer asks for; nothing for a domain without geometry."""
    rooms = {team: known for team, state in states.items() if (known := geometry.room(domain, static, state))}
    lying: dict[tuple[str, Term], dict[Cell, str]] = {}
    travels: list[tuple[str, str, Term, Cell, Cell]] = []
    for atom in atoms:
        match atom:
            case Atom("in_the_way", (team, body, place, step)) if team in rooms:
                lying.setdefault((str(team), step), {})[geometry.cell(place)] = str(body)
            case Atom("travels", (team, action, step, _, start, end)) if team in rooms:
                travels.append((str(team), str(action), step, geometry.cell(start), geometry.cell(end)))
    oracle = Oracle()
    found = []
    for owner, command, number, p, q in travels:
        things = {c: body for c, body in lying.get((owner, number), {}).items() if c not in (p, q)}
        name, value = _judged(rooms[owner], oracle, things, p, q)
        found.append(f"{name}({quoted(owner)},{command},{number},{_term(p)},{_term(q)},{value}).")
    return found


def _judged(room: Room, oracle: Oracle, things: Mapping[Cell, str], start: Cell, end: Cell) -> tuple[str, str]:
    """The name of the predicate that tells of a way, and its last argument."""
    cells = sorted(things)
    discs = [room.thing(c) for c in cells]
    layout = room.layout.with_discs(discs)
    way = oracle.shortest(layout, room.robot_m, middle(start), middle(end))
    if way is None:
        blockers = oracle.blockers(layout, room.robot_m, middle(start), middle(end)) or ()
        names = ", ".join(_bare(things[cells[number]]) for number in sorted(blockers))
        return "stuck", quoted(names or geometry.between(room, start, end))
    if touched := collision(room, {body: room.thing(c) for c, body in things.items()}, way):
        return "collides", quoted(_bare(touched) if touched in things.values() else touched)
    return "travelled", str(round(1000 * _length(way)))


def collision(room: Room, things: Mapping[str, Disc], way: Trajectory) -> str:
    """What a robot touches on a way, replayed in steps of at most `STEP_M`; "" if nothing."""
    near = room.robot_m - TOUCH_M
    width, height = room.size
    for x, y in _replayed(way):
        if not (near <= x <= width - near and near <= y <= height - near):
            return geometry.WALL
        for name, corners in room.furniture:
            if _inside((x, y), corners) or _distance((x, y), corners) < near:
                return name
        for name, (u, v, radius) in things.items():
            if math.hypot(x - u, y - v) < near + radius:
                return name
    return ""


def _replayed(way: Trajectory) -> Iterable[Point]:
    yield way.points[0]
    for (x, y), (u, v) in zip(way.points, way.points[1:], strict=False):
        count = max(1, math.ceil(math.hypot(u - x, v - y) / STEP_M))
        for k in range(1, count + 1):
            yield x + (u - x) * k / count, y + (v - y) * k / count


def _length(way: Trajectory) -> float:
    return sum(math.hypot(u - x, v - y) for (x, y), (u, v) in zip(way.points, way.points[1:], strict=False))


def _inside(p: Point, corners: tuple[Point, ...]) -> bool:
    """Is p inside a polygon, convex or not? By counting how often a line to the right crosses its edges."""
    x, y = p
    odd = False
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            odd = not odd
    return odd


def _distance(p: Point, corners: tuple[Point, ...]) -> float:
    """How far p is from the nearest edge of a polygon, metres."""
    x, y = p
    best = math.inf
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        dx, dy = bx - ax, by - ay
        along = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)))
        best = min(best, math.hypot(x - ax - along * dx, y - ay - along * dy))
    return best


def _bare(fluent: str) -> str:
    """The thing that a fluent, as ``at(plate)``, is about."""
    return str(parse(fluent)[1][0])


def _term(c: Cell) -> str:
    return f"({c[0]},{c[1]})"
