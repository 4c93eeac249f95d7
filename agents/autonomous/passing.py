"""Where a robot that faces a person lets that one by: neither of the two would go on before the other one has gone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import floor, hypot

from reasoning.geometry import Cell, Room, middle
from reasoning.motion.convex import Point
from reasoning.motion.oracle import Oracle

ASIDE_M = 0.45
"""So far beside the line on which the person comes: people go straight, and the line is known roughly."""


def lets_by(room: Room, oracle: Oracle, robot: Point, person: Point, others: Sequence[Point]) -> Callable[[Cell], bool]:
    """Whether a person who comes straight towards a robot gets past it if the robot stands in a cell: that is off the
    line, and cuts the person off from no other cell. `others` are where other robots stand; a person is taken to be as
    large as a robot. All in metres from the room's south-west corner."""
    # From cell to cell, if they stand in two: robots cut corners, and where they have stopped is a little off the line.
    near, far = (middle((floor(x), floor(y))) for x, y in (person, robot))
    (here_x, here_y), (x, y) = (near, far) if near != far else (person, robot)
    ahead_x, ahead_y = x - here_x, y - here_y
    middles = {c: middle(c) for c in room.cells}

    def reached(robots: Sequence[Point]) -> set[Cell]:
        layout = room.layout.with_discs([(*at, room.robot_m) for at in robots])
        return {c for c, at in middles.items() if oracle.path_exists(layout, room.robot_m, person, at)}

    before = reached(others)

    def suits(c: Cell) -> bool:
        there_x, there_y = middles[c]
        across = abs((there_x - here_x) * ahead_y - (there_y - here_y) * ahead_x)
        off = across >= ASIDE_M * hypot(ahead_x, ahead_y)
        return off and before - {c} <= reached([*others, middles[c]])

    return suits
