"""Where everything lies on the world's floor, in metres.

Workspaces are stacked from south to north, cell (1,1) of each one metre east and north of its origin. West of them all
runs the transport lane, and west of that lies the bench with a place for every robot. The origin of a room is its
south-west corner, and cell (x,y) has its middle half a metre east and north of (x, y).
"""

from __future__ import annotations

from collections.abc import Iterator
from math import floor

from bus.scene import Scene, Workspace
from world.physics import Point

LANE_M = -1.5
BENCH_M = -4.0
BENCH_WIDTH = 10
GAP_M = 3.0
"""From the top row of a workspace to the origin of the next: the line, and room to pass."""


class Layout:
    """Places by name; all of it follows from the scene."""

    def __init__(self, scene: Scene) -> None:
        self.spaces: dict[str, Workspace] = {w.team: w for w in scene.workspaces}
        self.origins: dict[str, Point] = {}
        y_m = 0.0
        for space in scene.workspaces:
            self.origins[space.team] = (0.0, y_m)
            y_m += space.height + GAP_M
        self.bench: Point = (BENCH_M, y_m / 2)
        robots = [e.id for e in scene.entities if scene.kinds[e.kind].role == "robot"]
        self._slots = {robot: i for i, robot in enumerate(robots)}

    def origin(self, place: str) -> Point:
        """Where the coordinates of a team's workspace, or else of the bench, begin."""
        return self.origins.get(place, self.bench)

    def cell(self, team: str, x: int, y: int) -> Point:
        ox, oy = self.origins[team]
        return (ox + x + 0.5, oy + y + 0.5) if self.spaces[team].room else (ox + x, oy + y)

    def nearest(self, place: str, at: Point) -> tuple[int, int]:
        """The cell whose middle is nearest to a point of a place."""
        ox, oy = self.origin(place)
        if place in self.spaces and self.spaces[place].room:
            return floor(at[0] - ox), floor(at[1] - oy)
        return round(at[0] - ox), round(at[1] - oy)

    def line(self, team: str, position: int) -> Point:
        ox, oy = self.origins[team]
        return ox + position, oy + self.spaces[team].height + 1

    def slot(self, robot: str) -> Point:
        """The robot's own place on the bench."""
        row, column = divmod(self._slots[robot], BENCH_WIDTH)
        return self.bench[0] - column, self.bench[1] - row

    def to_bench(self, robot: str, start: Point) -> list[Point]:
        """The corners of the way from a dock to the robot's slot."""
        x_m, y_m = self.slot(robot)
        return [(LANE_M, start[1]), (LANE_M, y_m), (x_m, y_m)]

    def from_bench(self, robot: str, end: Point) -> list[Point]:
        """The corners of the way back."""
        return [(LANE_M, self.slot(robot)[1]), (LANE_M, end[1]), end]

    def walls(self, space: Workspace) -> Iterator[tuple[Point, Point]]:
        """The sides of a room and of its furniture."""
        ox, oy = self.origins[space.team]
        w, h = space.width, space.height
        for corners in (((0, 0), (w, 0), (w, h), (0, h)), *(solid.corners for solid in space.solids)):
            points = [(ox + x, oy + y) for x, y in corners]
            yield from zip(points, points[1:] + points[:1], strict=True)

    def in_grid(self, team: str, x: int, y: int) -> bool:
        space = self.spaces[team]
        if space.room:
            return 0 <= x < space.width and 0 <= y < space.height
        return 1 <= x <= space.width and 1 <= y <= space.height
