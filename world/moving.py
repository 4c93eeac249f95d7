"""Skills that move bodies: between cells, alone or coupled, along the lane to the bench and back, and on the line.

A robot looks before it drives: the cell ahead must be free, or be left in the same period. Who cannot leave keeps its
cell, and who wanted to go there stays as well. All drives begin at the same time, so following into a cell that is
being left works. What a robot cannot see it runs into: that is up to physics.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import dist

from world.handling import fits, holds
from world.motion import Motion, route
from world.tasks import Cell, Task, able, ill_named
from world.things import BENCH, MOVING, Given, Thing
from world.truth import Truth

STEPS: dict[str, Cell] = {"up": (0, 1), "down": (0, -1), "left": (-1, 0), "right": (1, 0)}
SETTLED_M = 0.005
"""Who is that near to where it was to go has got there: a mechanical stop does the rest."""
TRANSPORT_MARGIN = 0.15
"""The lane is so fast that a robot reaches the bench this share of a period before it may be taken."""
SKILLS = frozenset({"drive", "drive_coupled", "depart", "arrive", "convey"})
Spot = tuple[str, int, Cell]


# ---------------------------------------------------------------- cell to cell
def begin_drive(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    assert task.robot is not None
    if task.robot.partner:
        return f"{task.robot.name} is coupled"
    return _aim(truth, task, (task.robot,))


def begin_drive_coupled(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    assert task.robot is not None
    if reason := holds(truth, task.robot):
        return reason
    return _aim(truth, task, (task.robot, truth.things[task.robot.partner]))


def _aim(truth: Truth, task: Task, bodies: tuple[Thing, ...]) -> str:
    direction = str(task.action.direction or task.arg("direction"))
    if direction not in STEPS:
        return f"{direction} is no direction"
    x, y = truth.cell(bodies[0])
    goal = x + STEPS[direction][0], y + STEPS[direction][1]
    if not truth.layout.in_grid(task.team, *goal):
        return "there is a wall"
    task.goal, task.bodies = goal, bodies
    return ""


def end_drive(truth: Truth, task: Task) -> str:
    assert task.goal is not None
    there = truth.layout.cell(task.team, *task.goal)
    arrived = all(dist(truth.floor.where(thing.id), there) < SETTLED_M for thing in task.bodies)
    for thing in task.bodies:
        if arrived and truth.floor.where(thing.id) != there:
            truth.floor.put(thing.id, there)
        truth.floor.brake(thing.id)
    return "" if arrived else f"{task.bodies[0].name} was held up"


def look(truth: Truth, tasks: Iterable[Task]) -> None:
    """Fail all drives into cells that are not free."""
    drives = [task for task in tasks if task.goal is not None and not task.failed]
    standing: dict[Spot, Thing] = {}
    for team in {task.team for task in drives}:
        for thing in truth.of(team):
            kind = truth.kind(thing)
            if kind.track == "grid":
                standing[team, kind.layer, truth.cell(thing)] = thing
    leaving = {thing.id: task for task in tasks if task.leaves and not task.failed for thing in task.bodies}
    leaving |= {task.bodies[0].id: task for task in drives}
    leaving |= {thing.id: task for task in drives for thing in task.bodies}
    wanted: dict[Spot, list[Task]] = {}
    for task in drives:
        for spot in _spots(truth, task):
            wanted.setdefault(spot, []).append(task)
    for spot, rivals in wanted.items():
        occupant = standing.get(spot)
        theirs = leaving.get(occupant.id) if occupant is not None else None
        for task in rivals:
            if len(rivals) > 1:
                task.failed = f"more than one wants to go to {_at(spot)}"
            elif (
                occupant is not None
                and theirs is not None
                and theirs is not task
                and _swap(truth, task, theirs, spot[1])
            ):
                task.failed = f"{occupant.name} comes the other way"
    stuck = True
    while stuck:
        stuck = False
        for task in drives:
            for spot in _spots(truth, task) if not task.failed else ():
                occupant = standing.get(spot)
                if occupant is not None and (occupant.id not in leaving or leaving[occupant.id].failed):
                    task.failed = f"{occupant.name} is in {_at(spot)}"
                    stuck = True


def _spots(truth: Truth, task: Task) -> list[Spot]:
    return [(task.team, truth.kind(thing).layer, task.goal or (0, 0)) for thing in task.bodies]


def _swap(truth: Truth, task: Task, theirs: Task, layer: int) -> bool:
    """Whether a body of `theirs` in that layer is to go where one of `task` in the same layer stands."""
    if theirs.goal is None:
        return False
    mine = [thing for thing in task.bodies if truth.kind(thing).layer == layer and thing.place == task.team]
    return any(truth.cell(thing) == theirs.goal for thing in mine)


def _at(spot: Spot) -> str:
    return f"({spot[2][0]},{spot[2][1]})"


# ---------------------------------------------------------------- the lane
def begin_depart(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    robot = task.robot
    assert robot is not None
    if robot.partner:
        return f"{robot.name} is coupled"
    if truth.cell(robot)[0] != truth.layout.spaces[task.team].dock_column:
        return f"{robot.name} is not in the dock"
    task.leaves, task.bodies = True, (robot,)
    return ""


def end_depart(truth: Truth, task: Task) -> str:
    assert task.robot is not None
    task.robot.given = Given(task.team, truth.tick)
    truth.belongs(task.robot, BENCH, task.robot.id)
    return ""


def begin_arrive(truth: Truth, task: Task) -> str:
    name, wanted = str(task.arg("robot")), str(task.call.detail.get("robot"))
    robot = truth.things.get(wanted)
    x, y = task.whole("x"), task.whole("y")
    if robot is None or robot.place != BENCH or truth.travels(robot):
        return f"{wanted} is not on the bench"
    if (
        robot.given
        and truth.tick < robot.given.tick + (truth.transport(robot.given.team, task.team) - 1) * truth.period
    ):
        return f"{wanted} is still on its way to {task.team}"
    layout = truth.layout
    if x is None or y is None or x != layout.spaces[task.team].dock_column or not layout.in_grid(task.team, x, y):
        return f"({x},{y}) is not in the dock"
    if reason := ill_named(truth, task.team, name):
        return reason
    if other := task.board.busy.get(robot.id) or task.board.coming.get((task.team, name)):
        return f"{wanted} cannot come: {other.text} of {other.team} came first"
    for attribute, value in task.call.detail.items():
        if attribute != "robot" and not fits(robot.attributes.get(attribute), value):
            return f"{attribute} of {wanted} cannot be {value}"
    task.robot, task.goal, task.bodies = robot, (x, y), (robot,)
    return ""


def end_arrive(truth: Truth, task: Task) -> str:
    assert task.robot is not None
    robot = task.robot
    robot.route = []
    truth.belongs(robot, task.team, str(task.arg("robot")))
    robot.attributes.update({k: v for k, v in task.call.detail.items() if k != "robot"})
    truth.floor.solid(robot.id, True)
    return end_drive(truth, task)


# ---------------------------------------------------------------- the line
def begin_convey(truth: Truth, task: Task) -> str:
    other = task.board.lines.get(task.team)
    return f"{other.text} has the line" if other is not None else ""


def end_convey(truth: Truth, task: Task) -> str:
    for thing in truth.of(task.team):
        if truth.kind(thing).track == "line":
            truth.lie_on_line(thing, truth.line(thing))
    return ""


# ---------------------------------------------------------------- off they go
def launch(truth: Truth, motion: Motion, tasks: Iterable[Task]) -> None:
    """Set everybody moving whose task did not fail."""
    now, period = truth.tick, truth.period
    for task in tasks:
        if task.failed:
            continue
        match task.action.skill:
            case "drive" | "drive_coupled":
                assert task.goal is not None
                motion.hop(task.bodies[0], truth.layout.cell(task.team, *task.goal), *task.bodies[1:])
            case "convey":
                for thing in truth.of(task.team):
                    if truth.kind(thing).track == "line" and truth.line(thing) > 0:
                        truth.floor.lower(thing.id)
                motion.convey(task.team)
            case "depart" | "arrive":
                robot = task.bodies[0]
                start = truth.floor.where(robot.id)
                truth.floor.solid(robot.id, False)
                if task.goal is None:
                    delay = max(truth.transport(task.team), 1)
                    last = now + round((delay - TRANSPORT_MARGIN) * period)
                    robot.route = route(start, truth.layout.to_bench(robot.id, start), now, last)
                else:
                    end = truth.layout.cell(task.team, *task.goal)
                    last = now + round((MOVING + TRANSPORT_MARGIN) * period)
                    robot.route = route(start, truth.layout.from_bench(robot.id, end), now, last)
                motion.travel(robot)
