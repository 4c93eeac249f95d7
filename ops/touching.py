"""What must have been true in every room all through a run, checked on its frames. Shares nothing with the world.

1. No robot and no person is inside furniture, a wall, or another of them.
2. Nobody pushes people: each is on the straight lines of its walk, and never faster than people walk.

A disturbance that puts a person elsewhere ends what can be said of its walk.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, pairwise
from math import dist, hypot, inf

from bus.messages import BodyFrame, Event, Frame
from bus.scene import Entity, Kind, Scene, Workspace
from ops.recording import Recording

Point = tuple[float, float]
SLACK_M = 0.01
"""Rounding, and what a bounded force allows: so much is no contact."""
WALK_MPS = 1.05


def touching(recording: Recording, scene: Scene) -> Iterator[str]:
    """A sentence for each violation; only the first of each pair of bodies."""
    rooms = {space.team: space for space in scene.workspaces if space.room}
    told: set[tuple[str, str]] = set()
    for _, frame in _frames(recording) if rooms else ():
        for team, space in rooms.items():
            here = [b for b in frame.bodies if b.place == team and scene.kinds[b.kind].role != "object"]
            for one, other, how in _contacts(here, space, scene.kinds):
                if (one, other) not in told:
                    told.add((one, other))
                    yield f"{frame.at_s:.2f} s: {one} is {how} {other}"


def pushed(recording: Recording, scene: Scene) -> Iterator[str]:
    """A sentence for each person that was moved otherwise than by its own feet."""
    moved = {
        str(event.data.get("target"))
        for event in (envelope.body for envelope in recording.events)
        if isinstance(event, Event) and event.kind == "fault_injected" and event.data.get("kind") == "move"
    }
    for person in scene.entities:
        if scene.kinds[person.kind].role != "person" or person.id in moved:
            continue
        lines = _walk(person)
        before: tuple[int, float, Point] | None = None
        for life, frame in _frames(recording):
            body = next(b for b in frame.bodies if b.id == person.id)
            at = body.x_m, body.y_m
            if min(_away(at, a, b) for a, b in lines) > SLACK_M:
                yield f"{frame.at_s:.2f} s: {person.id} is off its walk: somebody has pushed it"
                break
            # A world that died begins again with an earlier moment.
            passed_s = frame.at_s - before[1] if before is not None and before[0] == life else inf
            if before is not None and dist(at, before[2]) > WALK_MPS * passed_s + SLACK_M:
                yield f"{frame.at_s:.2f} s: {person.id} was carried along, faster than people walk"
                break
            before = life, frame.at_s, at


def _contacts(
    bodies: Sequence[BodyFrame], space: Workspace, kinds: Mapping[str, Kind]
) -> Iterator[tuple[str, str, str]]:
    for body in bodies:
        at, near_m = (body.x_m, body.y_m), kinds[body.kind].radius_m - SLACK_M
        if not (near_m <= at[0] <= space.width - near_m and near_m <= at[1] <= space.height - near_m):
            yield body.id, "a wall", "inside"
        for solid in space.solids:
            if _inside(at, solid.corners) or min(_away(at, a, b) for a, b in _edges(solid.corners)) < near_m:
                yield body.id, solid.name, "inside"
    for one, other in combinations(bodies, 2):
        apart_m = hypot(one.x_m - other.x_m, one.y_m - other.y_m)
        if apart_m < kinds[one.kind].radius_m + kinds[other.kind].radius_m - SLACK_M:
            yield one.id, other.id, "in the place of"


def _walk(person: Entity) -> list[tuple[Point, Point]]:
    """The lines between the stops of a walk, that from the last to the first included if it begins again."""
    x, y = map(int, str(person.place).strip("()").split(","))
    points = [(x + 0.5, y + 0.5), *((stop.x_m, stop.y_m) for stop in person.stops)]
    again = [(points[-1], points[1])] if person.again_s else []
    return [(points[0], points[0]), *pairwise(points), *again]


def _frames(recording: Recording) -> Iterator[tuple[int, Frame]]:
    """The frames, each with the life of the world that showed it."""
    return ((envelope.inc, envelope.body) for envelope in recording.frames if isinstance(envelope.body, Frame))


def _edges(corners: Sequence[Point]) -> Iterator[tuple[Point, Point]]:
    return pairwise((*corners, corners[0]))


def _inside(p: Point, corners: Sequence[Point]) -> bool:
    """By how often a line to the north crosses the edges."""
    odd = False
    for (ax, ay), (bx, by) in _edges(corners):
        if (ax > p[0]) != (bx > p[0]) and p[1] < ay + (p[0] - ax) * (by - ay) / (bx - ax):
            odd = not odd
    return odd


def _away(p: Point, a: Point, b: Point) -> float:
    """How far p is from the segment ab."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    along = min(max(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, 0.0), 1.0) if square else 0.0
    return hypot(p[0] - a[0] - along * dx, p[1] - a[1] - along * dy)
