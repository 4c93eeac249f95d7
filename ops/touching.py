"""What must have been true in every room all through a run, checked on its frames. Shares nothing with the world.

1. No robot and no person is inside furniture, a wall, or another of them; and no thing in another thing.
2. Nobody pushes people: each is on the straight lines of its walk, and never faster than people walk.

A disturbance that puts a person elsewhere ends what can be said of its walk.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise
from math import cos, dist, hypot, inf, sin

from bus.messages import BodyFrame, Event, Frame
from bus.scene import Entity, Scene, Workspace
from ops.recording import Recording

Point = tuple[float, float]
Disc = tuple[str, Point, float]
SLACK_M = 0.01
"""Rounding, and what a bounded force allows: so much is no contact."""
WALK_MPS = 1.05


def touching(recording: Recording, scene: Scene) -> Iterator[str]:
    """A sentence for each violation; only the first of each pair of bodies."""
    rooms = {space.team: space for space in scene.workspaces if space.room}
    heavy = {entity.id for entity in scene.entities if entity.end}
    told: set[tuple[str, str]] = set()
    for _, frame in _frames(recording) if rooms else ():
        for team, space in rooms.items():
            here = [body for body in frame.bodies if body.place == team]
            things = [body for body in here if scene.kinds[body.kind].role == "object"]
            others = [_disc(body, scene) for body in here if scene.kinds[body.kind].role != "object"]
            ends = [end for body in things for end in _ends(body, scene, body.id in heavy)]
            for one, other, how in (*_inside_solids(others, space), *_overlaps(others), *_overlaps(ends)):
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
            # People take the last bit to a stop, less than a tick's, at once: a frame may show it a tick early.
            if before is not None and dist(at, before[2]) > WALK_MPS * (passed_s + scene.dt_s) + SLACK_M:
                yield f"{frame.at_s:.2f} s: {person.id} was carried along, faster than people walk"
                break
            before = life, frame.at_s, at


def _disc(body: BodyFrame, scene: Scene) -> Disc:
    return body.id, (body.x_m, body.y_m), scene.kinds[body.kind].radius_m - SLACK_M / 2


def _ends(body: BodyFrame, scene: Scene, heavy: bool) -> list[Disc]:
    """The ends of a thing: of a heavy one two, a metre apart."""
    name, (x, y), radius_m = _disc(body, scene)
    other = (name, (x + cos(body.heading_rad), y + sin(body.heading_rad)), radius_m)
    return [(name, (x, y), radius_m), *([other] if heavy else [])]


def _inside_solids(discs: Sequence[Disc], space: Workspace) -> Iterator[tuple[str, str, str]]:
    for name, at, radius_m in discs:
        near_m = radius_m - SLACK_M / 2
        if not (near_m <= at[0] <= space.width - near_m and near_m <= at[1] <= space.height - near_m):
            yield name, "a wall", "inside"
        for solid in space.solids:
            if _inside(at, solid.corners) or min(_away(at, a, b) for a, b in _edges(solid.corners)) < near_m:
                yield name, solid.name, "inside"


def _overlaps(discs: Sequence[Disc]) -> Iterator[tuple[str, str, str]]:
    for (one, a, radius_m), (other, b, other_m) in combinations(discs, 2):
        if one != other and dist(a, b) < radius_m + other_m:
            yield one, other, "in the place of"


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
