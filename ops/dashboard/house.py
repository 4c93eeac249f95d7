"""A house drawn to scale: walls with doors, furniture, the ways that robots are on, and everybody with their name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import ceil, cos, dist, floor, sin

from rich.text import Text

from bus.messages import BodyFrame
from bus.scene import Scene, Workspace
from ops.dashboard.canvas import ACROSS, DOWN, Canvas, Point
from ops.dashboard.floor import bodies, robot
from ops.dashboard.model import Model
from ops.dashboard.rooms import Door, Room, View, extent
from ops.dashboard.text import Block, clean, joined

WALL, TALL, LOW, DOOR = "white", "bright_black", "bright_black", "bold green"
STORE, NEXT = ("·", "dim"), (":", "dim")
"""Where things lie that belong here, and those for the room next door."""
THING, HEAVY, PERSON, HELD, GUEST = "yellow", "bold yellow", "bold magenta", "=", "»"
ROBOTS = ("bright_cyan", "bright_green", "bright_blue")
"""By turns, so that ways that cross can be told apart."""
ARROWS = {"west": "←", "east": "→", "north": "↑", "south": "↓"}
LEAST = {"robot": 1.5, "person": 1.5, "object": 1.0}
"""Dots of the radius at least: so small, a body is drawn larger than it is."""
RHYTHM = 3
"""Every third dot of a way is drawn."""


def is_house(scene: Scene | None) -> bool:
    """Whether the scene holds rooms, with walls, rather than floors of cells."""
    return scene is not None and any(space.room for space in scene.workspaces)


def signs(scene: Scene) -> list[Text]:
    """What stands for whom and what, for the legend."""
    marks = {"robot": ("⣶", ROBOTS[0]), "object": ("⡄", THING), "person": ("⣶", PERSON)}
    there = {entity.kind for entity in scene.entities}
    return [
        *(joined(marks[kind.role], f" {name}") for name, kind in scene.kinds.items() if name in there),
        joined((f"r1{HELD}x", ROBOTS[0]), " holds x"),
        joined((f"{GUEST}r1", ROBOTS[0]), " helper"),
        joined(("⠂⠐⠠", ROBOTS[0]), " way"),
        joined(("⣿", TALL), ("⢕", LOW), " furniture"),
        joined(("↑", DOOR), " door"),
        *([joined(STORE, " own")] if any(space.store for space in scene.workspaces) else []),
        *([joined(NEXT, " next door")] if any(space.doors for space in scene.workspaces) else []),
    ]


def room(space: Workspace) -> Room:
    """What the arrangement of rooms must know. Doors are where the way to a neighbour leads through a wall."""
    doors = []
    for to, (west, east, south, north) in sorted(space.doors.items()):
        lying = [("north", north == space.height - 1), ("south", south == 0)]
        upright = [("west", west == 0), ("east", east == space.width - 1)]
        for side, there in lying + upright if south == north else upright + lying:
            if there:
                start, end = (west, east + 1) if side in ("north", "south") else (south, north + 1)
                doors.append(Door(to, side, start, end))  # type: ignore[arg-type]
                break
    return Room(space.room, space.width, space.height, tuple(doors))


def draw(model: Model, views: Sequence[View]) -> Block:
    """The rooms and what is in them, `extent(views)` large."""
    canvas = Canvas(*extent(tuple(views)))
    teams = {space.room: space for space in (model.scene.workspaces if model.scene else ())}
    for view in views:
        space = teams[view.room.name]
        for area in space.doors.values():
            canvas.ground(*view.area(*area), *NEXT)
        if space.store is not None:
            canvas.ground(*view.area(*space.store), *STORE)
        for solid in space.solids:
            canvas.polygon([view.dots(*c) for c in solid.corners], TALL if solid.tall else LOW, sparse=not solid.tall)
        _walls(canvas, view)
        _Inside(model, canvas, view, space).draw()
        name = view.room.name if space.team == view.room.name else f"{space.team} {view.room.name}"
        _title(canvas, view, name, "bold red" if space.team in model.trouble else "bold")
    return canvas.block()


def _walls(canvas: Canvas, view: View) -> None:
    wide, high = view.room.width_m, view.room.height_m
    west, south = view.dots(0, 0)
    east, north = view.dots(wide, high)
    corners = [(west - 1, north - 1), (east, north - 1), (east, south), (west - 1, south)]
    for a, b in zip(corners, (*corners[1:], corners[0]), strict=True):
        canvas.line(a, b, WALL)
    for door in view.room.doors:
        first, last = ceil(door.start_m * view.scale), ceil(door.end_m * view.scale) - 1
        lying = door.side in ("north", "south")
        line = floor({"north": north - 1, "south": south, "west": west - 1, "east": east}[door.side])
        for i in range(first, last + 1):
            if lying:
                canvas.clear(floor(west) + i, line)
            else:
                canvas.clear(line, floor(south) - 1 - i)
        x, y = view.dots((door.start_m + door.end_m) / 2, (door.start_m + door.end_m) / 2)
        column, row = (floor(x / ACROSS), line // DOWN) if lying else (line // ACROSS, floor(y / DOWN))
        name = clean(door.to)[: max((last - first + 1) // ACROSS - 2, 0)] if lying else ""
        canvas.text(column - len(name) // 2, row, ARROWS[door.side] + name, DOOR)


def _title(canvas: Canvas, view: View, name: str, style: str) -> None:
    """Whose room it is, in one of its walls, where no door is in the way."""
    name = f" {clean(name)} "[: max(view.columns - 2, 0)]
    ends = [(column, row) for row in (view.row, view.row + view.rows - 1)
            for column in (view.column + 1, view.column + view.columns - 1 - len(name))]  # fmt: skip
    taken = [(c, r) for c, r in ends if not any(canvas.written(c + i, r) for i in range(len(name)))]
    canvas.text(*(taken or ends)[0], name, style)


def remaining(way: Sequence[Point], at: Point) -> list[Point]:
    """What is left of a way for who is somewhere on it: from here on, by the next corner."""
    legs = [(dist(at, _nearest(a, b, at)), i) for i, (a, b) in enumerate(pairwise(way))]
    return [at, *way[min(legs)[1] + 1 :]] if legs else []


def _nearest(a: Point, b: Point, p: Point) -> Point:
    """The point of the segment from `a` to `b` that is nearest to `p`."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length2 = dx * dx + dy * dy
    share = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length2 if length2 else 0.0
    share = min(max(share, 0.0), 1.0)
    return a[0] + share * dx, a[1] + share * dy


class _Inside:
    """Who and what is in one room, and where their names go: beside them, over nobody if possible."""

    def __init__(self, model: Model, canvas: Canvas, view: View, space: Workspace) -> None:
        self._model, self._canvas, self._view, self._space = model, canvas, view, space
        scene = model.scene
        assert scene is not None
        self._here = [b for b in bodies(model) if b.place == space.team]
        self._role = {b.id: scene.kinds[b.kind].role if b.kind in scene.kinds else "object" for b in self._here}
        self._radius = {b.id: scene.kinds[b.kind].radius_m if b.kind in scene.kinds else 0.1 for b in self._here}
        self._heavy = {e.id for e in scene.entities if e.end}
        robots = sorted(e.id for e in scene.entities if scene.kinds[e.kind].role == "robot")
        self._tone = {name: ROBOTS[i % len(ROBOTS)] for i, name in enumerate(robots)}
        self._taken: set[tuple[int, int]] = set()

    def draw(self) -> None:
        order = sorted(self._here, key=lambda b: (("object", "person", "robot").index(self._role[b.id]), b.name))
        status = self._model.statuses.get(self._space.team)
        ways = status.ways if status else {}
        for body in order:
            if self._role[body.id] == "robot" and body.name in ways:
                points = [self._inside(x, y) for x, y in remaining(ways[body.name], (body.x_m, body.y_m))]
                self._canvas.path(points, self._tone.get(body.id, ROBOTS[0]), every=RHYTHM)
        for body in order:
            self._body(body)
        held = {self._holds(b) for b in order}
        for body in reversed(order):
            self._name(body, held)
        for solid in self._space.solids:
            self._furniture(solid.name, [self._view.dots(*c) for c in solid.corners])

    def _inside(self, x_m: float, y_m: float) -> Point:
        """A point of the room on the canvas; one outside is drawn in the wall."""
        room = self._view.room
        return self._view.dots(min(max(x_m, 0.0), room.width_m), min(max(y_m, 0.0), room.height_m))

    def _holds(self, body: BodyFrame) -> str:
        """Name of the thing that a robot holds, whatever term it is shown by."""
        if self._role[body.id] != "robot" or not body.coupled_to:
            return ""
        things = {n for b in self._here if self._role[b.id] == "object" for n in (b.name, b.id)}
        found = next((w for w in re.findall(r"[\w.]+", body.coupled_to) if w in things), "")
        return found.rpartition(".")[2]

    def _style(self, body: BodyFrame) -> str:
        role = self._role[body.id]
        if role == "robot":
            return "bold red" if body.broken else f"bold {self._tone.get(body.id, ROBOTS[0])}"
        return PERSON if role == "person" else HEAVY if body.id in self._heavy else THING

    def _body(self, body: BodyFrame) -> None:
        scale, style = self._view.scale, self._style(body)
        radius = max(self._radius[body.id] * scale, LEAST[self._role[body.id]])
        ends = [(body.x_m, body.y_m)]
        if body.id in self._heavy:
            ends.append((body.x_m + cos(body.heading_rad), body.y_m + sin(body.heading_rad)))
            self._canvas.path([self._inside(*end) for end in ends], style)
        for end in ends:
            x, y = self._inside(*end)
            self._canvas.disc((x, y), radius, style)
            self._taken |= {(floor(i / ACROSS), floor(j / DOWN)) for i in (x - radius + 0.5, x, x + radius - 0.5)
                            for j in (y - radius + 0.5, y, y + radius - 0.5)}  # fmt: skip

    def _name(self, body: BodyFrame, held: Iterable[str]) -> None:
        """Beside the body, shorter if there is no room; with what it holds, which has no name of its own then."""
        if body.name in held and self._role[body.id] == "object":
            return
        name = clean(body.name)
        short = [name, name.rstrip("0123456789").rstrip("_") or name, name[:4], name[:2], name[:1]]
        if self._role[body.id] == "robot":
            label = (GUEST if body.id.partition(".")[0] != body.place else "") + robot(self._model, body).plain
            thing = self._holds(body)
            short = [f"{label}{HELD}{thing[:n]}" for n in (64, 4, 2)] if thing else []
            short.append(label)
        x, y = self._inside(body.x_m, body.y_m)
        radius = max(self._radius[body.id] * self._view.scale, LEAST[self._role[body.id]])
        for text in short:
            east, west = floor((x + radius) / ACROSS) + 1, ceil((x - radius) / ACROSS) - 1 - len(text)
            middle, row = floor(x / ACROSS) - len(text) // 2, floor(y / DOWN)
            above, below = floor((y - radius) / DOWN) - 1, floor((y + radius) / DOWN) + 1
            end = floor(x / ACROSS) + 1 - len(text)
            beside = [(east, row), (west, row), *((c, r) for c in (middle, end, east) for r in (above, below))]
            for column, line in beside:
                if self._free(column, line, len(text)):
                    self._canvas.text(column, line, text, self._style(body))
                    return
        if self._role[body.id] != "object":
            self._canvas.text(floor(x / ACROSS), floor(y / DOWN), short[-1], self._style(body))

    def _free(self, column: int, row: int, length: int) -> bool:
        """Whether letters may go there: inside the walls, over no body and no other name."""
        view = self._view
        if row <= view.row or row >= view.row + view.rows - 1 or column <= view.column:
            return False
        cells = [(column + i, row) for i in range(length)]
        free = not any(cell in self._taken or self._canvas.written(*cell) for cell in cells)
        return free and column + length < view.column + view.columns

    def _furniture(self, name: str, corners: Sequence[Point]) -> None:
        """The name in the middle of the furniture, if it is broad enough there."""
        x, y = (sum(c[i] for c in corners) / len(corners) for i in (0, 1))
        text, row = clean(name), floor(y / DOWN)
        column = floor(x / ACROSS) - len(text) // 2
        middle = row * DOWN + DOWN / 2
        edges = zip(corners, (*corners[1:], *corners[:1]), strict=True)
        cut = sorted(a[0] + (middle - a[1]) * (b[0] - a[0]) / (b[1] - a[1]) for a, b in edges
                     if (a[1] > middle) != (b[1] > middle))  # fmt: skip
        within = len(cut) == 2 and cut[0] <= column * ACROSS and (column + len(text)) * ACROSS <= cut[1]
        if within and self._free(column, row, len(text)):
            self._canvas.text(column, row, text, "dim")
