"""Skills of robots in rooms that take one period each: taking hold of things, and going from room to room."""

from __future__ import annotations

from math import dist

from world import lookout, plane
from world.physics import Point
from world.tasks import Task, able, ill_named
from world.things import BENCH, Given, Thing
from world.truth import Truth


# ---------------------------------------------------------------- grips
def begin_grasp(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    assert task.robot is not None
    return f"{task.robot.name} holds something" if task.robot.end else ""


def end_grasp(truth: Truth, task: Task) -> str:
    """A robot reaches into its own cell. Of what nobody has tried yet it feels whether it moves."""
    robot = task.robot
    assert robot is not None
    if robot.broken:
        return f"{robot.name} is broken"
    found = _within_reach(truth, robot, str(task.call.detail.get(task.action.point, "")))
    if found is None:
        task.felt = "nothing_there"
        return f"nothing is there for {robot.name}"
    thing, end = found
    if any(other.end == end for other in truth.holders(thing)):
        task.felt = "nothing_there"
        return f"that end of {thing.name} is taken"
    for attribute, needed in task.action.needs.items():
        if robot.attributes.get(attribute) and not thing.attributes.get(needed):
            task.felt = "nothing_there"
            return f"{robot.name} has {attribute}, and {thing.name} is not {needed}"
    weak = thing.heavy and bool(robot.attributes.get(task.action.weak))
    if weak or (not thing.known and truth.force_n(thing) > truth.force_n(robot)):
        task.felt, thing.known = "too_heavy", True
        return f"{thing.name} is too heavy for {robot.name}"
    truth.grip(robot, thing, end)
    if task.action.clears in thing.attributes:
        thing.attributes[task.action.clears] = 0
    return ""


def _within_reach(truth: Truth, robot: Thing, wanted: str) -> tuple[Thing, int] | None:
    """The wanted end of a thing, or the nearest, if it is in the robot's cell."""
    cell, at = truth.cell(robot), truth.floor.where(robot.id)
    found: list[tuple[float, Thing, int]] = []
    for thing in truth.of(robot.place):
        kind = truth.kind(thing)
        for end in ((1, 2) if thing.heavy else (1,)) if kind.role == "object" else ():
            there = truth.floor.end(thing.id, end)
            named = wanted == f"{kind.grip}({thing.name},{end})"
            if (named or not wanted) and truth.layout.nearest(robot.place, there) == cell:
                found.append((dist(at, there), thing, end))
    nearest = min(found, key=lambda it: it[0], default=None)
    return nearest[1:] if nearest is not None else None


def begin_release(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    assert task.robot is not None
    return "" if task.robot.end else f"{task.robot.name} holds nothing"


def end_release(truth: Truth, task: Task) -> str:
    assert task.robot is not None
    if task.robot.broken:
        return f"{task.robot.name} is broken"
    if not task.robot.end:
        return f"{task.robot.name} holds nothing"
    truth.ungrip(task.robot)
    return ""


# ---------------------------------------------------------------- doors
def begin_leave(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    robot, room = task.robot, str(task.arg("room"))
    assert robot is not None
    doors = truth.layout.spaces[task.team].doors
    if robot.end:
        return f"{robot.name} holds something"
    if room not in doors or not any(space.room == room for space in truth.layout.spaces.values()):
        return f"no door leads to {room}"
    if truth.cell(robot) not in cells(doors[room]):
        return f"{robot.name} is not at the door to {room}"
    return ""


def end_leave(truth: Truth, task: Task) -> str:
    robot = task.robot
    assert robot is not None
    if robot.broken:
        return f"{robot.name} is broken"
    go_out(truth, robot, str(task.arg("room")))
    return ""


def go_out(truth: Truth, robot: Thing, room: str) -> None:
    """Out by the door to `room`, into the hallway."""
    robot.given = Given(robot.place, truth.tick, room)
    truth.belongs(robot, BENCH, robot.id)
    truth.floor.lift(robot.id)
    truth.floor.put(robot.id, truth.layout.slot(robot.id))


def begin_enter(truth: Truth, task: Task) -> str:
    name, wanted = str(task.arg("robot")), str(task.call.detail.get("robot"))
    robot = truth.things.get(wanted)
    if robot is None or robot.place != BENCH or robot.given is None:
        return f"{wanted} is not on its way"
    if reason := ill_named(truth, task.team, name):
        return reason
    if other := task.board.busy.get(robot.id):
        return f"{wanted} comes already, by {other.text}"
    task.robot = robot
    return ""


def end_enter(truth: Truth, task: Task) -> str:
    robot, name = task.robot, str(task.arg("robot"))
    assert robot is not None
    if robot.place != BENCH or robot.given is None or truth.find(task.team, name) is not None:
        return f"{task.call.detail.get('robot')} cannot come"
    if robot.called and owner(robot) != task.team:
        task.again = True
        return f"{robot.id} is called home by its own team"
    came = robot.given.team
    if truth.tick < robot.given.tick + truth.transport(came, task.team) * truth.period:
        task.again = True
        return f"{task.team} waits for {robot.id}, which is on its way"
    # Who turns round comes in by the door by which it left.
    door = robot.given.room if came == task.team else truth.layout.spaces[came].room
    area = truth.layout.spaces[task.team].doors.get(door)
    places = [truth.layout.cell(task.team, *cell) for cell in cells(area)] if area is not None else []
    at = next((at for at in places if _free(truth, task.team, robot, at)), None)
    if at is None:
        task.felt, task.again = "blocked", True
        return f"{robot.id} waits at the door for {task.team}: somebody stands there"
    robot.given, robot.called, robot.waits = None, False, ""
    truth.belongs(robot, task.team, name)
    truth.floor.put(robot.id, at)
    truth.floor.lower(robot.id)
    return ""


def owner(robot: Thing) -> str:
    """The team that a robot was built for."""
    return robot.id.partition(".")[0]


def cells(area: tuple[int, int, int, int]) -> list[tuple[int, int]]:
    west, east, south, north = area
    return [(x, y) for y in range(south, north + 1) for x in range(west, east + 1)]


def _free(truth: Truth, team: str, robot: Thing, at: Point) -> bool:
    """Neither people nor robots nor furniture there; what lies on the floor is no matter."""
    radius_m = truth.kind(robot).radius_m
    space, (ox, oy) = truth.layout.spaces[team], truth.layout.origin(team)
    for thing in truth.of(team):
        if truth.kind(thing).role != "object":
            for disc in lookout.discs(truth, thing):
                if dist(at, disc.at) < radius_m + disc.radius_m:
                    return False
    return all(plane.off((at[0] - ox, at[1] - oy), solid.corners) >= radius_m for solid in space.solids)
