"""Where the rooms of a house go on the screen: next to one another as their doors say, all at one scale."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from math import floor
from typing import Literal, NamedTuple

from ops.dashboard.canvas import ACROSS, DOWN, Point

Side = Literal["west", "east", "south", "north"]
OPPOSITE: Mapping[str, Side] = {"west": "east", "east": "west", "south": "north", "north": "south"}
SCALES = tuple(quarter / 4 for quarter in range(80, 7, -1))
"""Dots for a metre, largest first. With fewer than two nothing can be told apart."""
PREFERENCE = 1.3
"""A floor plan is worth so much smaller a picture than rooms in a row."""


@dataclass(frozen=True)
class Door:
    """An opening of a room's wall towards a neighbour, from here to there along the wall, in metres."""

    to: str
    side: Side
    start_m: float
    end_m: float


@dataclass(frozen=True)
class Room:
    """A room's size in metres and its doors."""

    name: str
    width_m: float
    height_m: float
    doors: tuple[Door, ...] = field(default=())


class View(NamedTuple):
    """Where one room is on the canvas: the cells of its upper left corner, walls included, and dots for a metre."""

    room: Room
    column: int
    row: int
    scale: float

    @property
    def columns(self) -> int:
        return _size(self.room, self.scale)[0]

    @property
    def rows(self) -> int:
        return _size(self.room, self.scale)[1]

    def dots(self, x_m: float, y_m: float) -> Point:
        """A point of the room, in metres from its south-west corner, on the canvas. The first row and column hold
        its northern and western wall."""
        left, top = (self.column + 1) * ACROSS, (self.row + 1) * DOWN
        return left + x_m * self.scale, top + (self.room.height_m - y_m) * self.scale

    def area(self, west: int, east: int, south: int, north: int) -> tuple[Point, Point]:
        """The upper left and the lower right corner of an area, from the first cell to the last both ways."""
        return self.dots(west, north + 1), self.dots(east + 1, south)


class Arrangement(NamedTuple):
    """Where all rooms go, and how much the picture is worth: its scale, and more if it is a floor plan."""

    views: tuple[View, ...]
    worth: float


Way = Callable[[tuple[Room, ...], float, int], tuple[View, ...]]
"""From rooms, scale and columns to their places; none if this is no way to arrange them."""


def _size(room: Room, scale: float) -> tuple[int, int]:
    """Columns and rows of a room with its walls: the first of both, and up to those of the wall's dot beyond it."""
    return 2 + floor(room.width_m * scale) // ACROSS, 2 + floor(room.height_m * scale) // DOWN


def extent(views: tuple[View, ...]) -> tuple[int, int]:
    """Columns and rows of all rooms together."""
    return max((v.column + v.columns for v in views), default=0), max((v.row + v.rows for v in views), default=0)


@lru_cache(maxsize=256)
def arranged(rooms: tuple[Room, ...], columns: int, rows: int) -> Arrangement:
    """All rooms within so many columns and rows, as large as can be; none if there is no place for them.

    Rooms whose doors face each other are drawn as a floor plan if that is not much smaller than rows of rooms are.
    """
    ways: tuple[tuple[Way, float], ...] = ((_glued, PREFERENCE), (_shelves, 1.0))
    found = [Arrangement(views, views[0].scale * liking) for way, liking in ways
             if (views := _largest(way, rooms, columns, rows))]  # fmt: skip
    return max(found, key=lambda a: a.worth, default=Arrangement((), 0.0))


def _largest(way: Way, rooms: tuple[Room, ...], columns: int, rows: int) -> tuple[View, ...]:
    for scale in SCALES:
        views = way(rooms, scale, columns)
        wide, tall = extent(views)
        if views and wide <= columns and tall <= rows:
            return views
    return ()


def _shelves(rooms: tuple[Room, ...], scale: float, columns: int) -> tuple[View, ...]:
    """Rooms in rows from west to east, as many in each as go into the width."""
    out: list[View] = []
    column = row = tall = 0
    for room in _in_line(rooms):
        wide, high = _size(room, scale)
        if column and column + wide > columns:
            column, row, tall = 0, row + tall, 0
        out.append(View(room, column, row, scale))
        column, tall = column + wide, max(tall, high)
    return tuple(out)


def _in_line(rooms: tuple[Room, ...]) -> tuple[Room, ...]:
    """Rooms so that a western neighbour comes right before an eastern one, where doors say so."""
    order: list[Room] = []
    for room in rooms:
        sides = [_beside(other, room) for other in order]
        place = sides.index("east") + 1 if "east" in sides else sides.index("west") if "west" in sides else len(order)
        order.insert(place, room)
    return tuple(order)


def _beside(a: Room, b: Room) -> Side | None:
    """On which side of `a` its neighbour `b` lies, if their doors to each other face."""
    there = next((d.side for d in a.doors if d.to == b.name), None)
    back = next((d.side for d in b.doors if d.to == a.name), None)
    return there if there is not None and back == OPPOSITE[there] else None


def _glued(rooms: tuple[Room, ...], scale: float, columns: int) -> tuple[View, ...]:
    """The floor plan: rooms put together so that doors that face each other meet; none if not all can be."""
    if not rooms:
        return ()
    placed = {rooms[0].name: View(rooms[0], 0, 0, scale)}
    rest = list(rooms[1:])
    while rest:
        found = next(((v, r) for r in rest for v in placed.values() if _beside(v.room, r)), None)
        if found is None:
            return ()
        beside, room = found
        view = _joined(beside, room)
        if any(_overlap(view, other) for other in placed.values()):
            return ()
        placed[room.name] = view
        rest.remove(room)
    west, north = min(v.column for v in placed.values()), min(v.row for v in placed.values())
    return tuple(v._replace(column=v.column - west, row=v.row - north) for v in placed.values())


def _joined(view: View, room: Room) -> View:
    """The room beside one that has its place, door to door."""
    door = next(d for d in view.room.doors if d.to == room.name)
    back = next(d for d in room.doors if d.to == view.room.name)
    wide, tall = _size(room, view.scale)
    here, there = (door.start_m + door.end_m) / 2, (back.start_m + back.end_m) / 2
    if door.side in ("west", "east"):
        lower = (view.room.height_m - here) - (room.height_m - there)
        row = view.row + round(lower * view.scale / DOWN)
        return View(room, view.column + (view.columns if door.side == "east" else -wide), row, view.scale)
    column = view.column + round((here - there) * view.scale / ACROSS)
    return View(room, column, view.row + (view.rows if door.side == "south" else -tall), view.scale)


def _overlap(a: View, b: View) -> bool:
    across = a.column < b.column + b.columns and b.column < a.column + a.columns
    return across and a.row < b.row + b.rows and b.row < a.row + a.rows
