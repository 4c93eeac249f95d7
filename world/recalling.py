"""The skill by which a robot comes home by itself from another room, when its own team calls it.

Its team cannot see where it is, so it finds the way itself, and does what comes next in each step: it lets go of what
it holds, where nothing else lies; drives to the door; goes out; comes in at home. Once called it obeys nobody else.
"""

from __future__ import annotations

from math import ceil, dist

from world import following, grasping
from world.homing import way_to
from world.tasks import Cell, Task
from world.things import BENCH, Thing
from world.truth import Truth

PACE_M = 2.0
"""Metres of its way home in a period: with care, since nobody has looked ahead."""


def begin_recall(truth: Truth, task: Task) -> str:
    name = str(task.call.detail.get("robot"))
    robot = truth.things.get(name)
    if robot is None or truth.kind(robot).role != "robot":
        return f"there is no robot {name}"
    if grasping.owner(robot) != task.team:
        return f"{name} is no robot of {task.team}"
    if robot.place == task.team:
        return f"{name} is at home"
    if robot.place == BENCH:
        if robot.given is None:
            return f"{name} has not gone to another room"
        robot.called = True
        return grasping.begin_enter(truth, task)
    robot.called, task.robot = True, robot
    if robot.broken:
        task.again = True
        return f"{robot.id} does not come: it is broken"
    if _lets_go(truth, robot) or (not robot.end and _at_door(truth, robot)):
        return ""
    task.way = way_to(truth, robot, _free_cells(truth, robot) if robot.end else _door(truth, robot))
    if not task.way:
        task.felt, task.again = "blocked", True
        return f"{robot.id} waits in the room of {robot.place}: it has no way to the door"
    length_m = sum(dist(a, b) for a, b in zip(task.way, task.way[1:], strict=False))
    task.units = max(1, ceil(length_m / PACE_M))
    return ""


def end_recall(truth: Truth, task: Task) -> str:
    robot = task.robot
    assert robot is not None
    if task.trip is not None:
        reason = following.end_follow(truth, task)
        task.again = task.felt is not None
        return reason and f"{robot.id} waits in the room of {robot.place}: {reason}"
    if robot.place == BENCH:
        return grasping.end_enter(truth, task)
    if robot.broken:
        return f"{robot.name} is broken"
    if robot.end:
        truth.ungrip(robot)
    elif _at_door(truth, robot):
        grasping.go_out(truth, robot, truth.layout.spaces[task.team].room)
    robot.waits = ""
    return ""


def _door(truth: Truth, robot: Thing) -> list[Cell]:
    """The cells by which it goes home."""
    home = truth.layout.spaces[grasping.owner(robot)].room
    area = truth.layout.spaces[robot.place].doors.get(home)
    return grasping.cells(area) if area is not None else []


def _at_door(truth: Truth, robot: Thing) -> bool:
    return truth.cell(robot) in _door(truth, robot)


def _lets_go(truth: Truth, robot: Thing) -> bool:
    """Can it let go of what it holds here? Of what two carry always: it cannot take it elsewhere alone."""
    held = truth.things.get(robot.partner)
    return held is not None and bool(robot.end) and (held.heavy or truth.cell(robot) not in _taken(truth, robot))


def _free_cells(truth: Truth, robot: Thing) -> list[Cell]:
    """The cells of its room in which nothing lies."""
    space, taken = truth.layout.spaces[robot.place], _taken(truth, robot)
    return [(x, y) for y in range(space.height) for x in range(space.width) if (x, y) not in taken]


def _taken(truth: Truth, robot: Thing) -> set[Cell]:
    """The cells in which other things lie than what it holds."""
    return {
        truth.layout.nearest(robot.place, truth.floor.end(thing.id, end))
        for thing in truth.of(robot.place)
        if truth.kind(thing).role == "object" and thing.id != robot.partner
        for end in ((1, 2) if thing.heavy else (1,))
    }
