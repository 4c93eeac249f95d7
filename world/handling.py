"""Skills that change a body's properties: coupling, tools, work on an object, and what people do to a robot."""

from __future__ import annotations

from math import dist

from bus.messages import Value
from world.tasks import Task, able, present
from world.things import Thing
from world.truth import Truth

REACH_M = 0.2
"""How far apart two bodies may be that are to be joined."""


def fits(old: Value | None, new: Value | float | None) -> bool:
    """Whether an attribute may take this value: one of the kind that it has."""
    return new is not None and not isinstance(new, bool) and type(new) is type(old)


# ---------------------------------------------------------------- coupling
def begin_couple(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    assert task.robot is not None
    name = str(task.arg("partner"))
    task.other = truth.find(task.team, name)
    if not truth.kind(task.robot).couples or task.robot is task.other:
        return f"{task.robot.name} cannot be coupled to that"
    if task.other is None or truth.kind(task.other).role != "robot":
        return f"there is no robot {name}"
    return _joinable(truth, task.robot, task.other)


def end_couple(truth: Truth, task: Task) -> str:
    assert task.robot is not None
    assert task.other is not None
    if reason := _joinable(truth, task.robot, task.other):
        return reason
    truth.couple(task.robot, task.other)
    return ""


def _joinable(truth: Truth, one: Thing, other: Thing) -> str:
    for thing in (one, other):
        if thing.partner:
            return f"{thing.name} is coupled already"
        if thing.broken:
            return f"{thing.name} is broken"
    apart_m = dist(truth.floor.where(one.id), truth.floor.where(other.id))
    return f"{one.name} and {other.name} are {apart_m:.2f} m apart" if apart_m > REACH_M else ""


def begin_uncouple(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    assert task.robot is not None
    return holds(truth, task.robot)


def end_uncouple(truth: Truth, task: Task) -> str:
    assert task.robot is not None
    if reason := holds(truth, task.robot):
        return reason
    truth.uncouple(task.robot)
    return ""


def holds(truth: Truth, robot: Thing) -> str:
    """Why this robot does not hold another one, or empty. Who is held cannot do anything about it."""
    if not truth.kind(robot).couples:
        return f"{robot.name} cannot be coupled to others"
    return "" if robot.partner else f"{robot.name} is not coupled"


# ---------------------------------------------------------------- properties
def begin_set(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    assert task.robot is not None
    attribute, value = task.action.attribute, task.arg("value")
    if not fits(task.robot.attributes.get(attribute), value):
        return f"{attribute} of {task.robot.name} cannot be {value}"
    return ""


def end_set(truth: Truth, task: Task) -> str:
    value = task.arg("value")
    assert task.robot is not None
    assert value is not None
    task.robot.attributes[task.action.attribute] = value
    return ""


def begin_operate(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    robot, action, name = task.robot, task.action, str(task.arg("object"))
    assert robot is not None
    thing = task.other = truth.find(task.team, name)
    if thing is None or truth.kind(thing).role != "object":
        return f"there is no object {name}"
    if thing.id in task.board.worked:
        return f"{name} is being worked on"
    if reason := _at_work(truth, robot, thing):
        return reason
    tool, done = robot.attributes.get(action.tool), thing.attributes.get(action.attribute)
    if not isinstance(tool, int) or not isinstance(done, int) or tool != done + 1:
        return f"{action.tool} {tool} of {robot.name} does not fit {name} with {action.attribute} {done}"
    if action.marks and thing.attributes.get(action.marks):
        return f"{name} is {action.marks}"
    return ""


def end_operate(truth: Truth, task: Task) -> str:
    robot, thing, action = task.robot, task.other, task.action
    assert robot is not None
    assert thing is not None
    if reason := _at_work(truth, robot, thing):
        return reason
    value = thing.attributes[action.attribute] = robot.attributes[action.tool]
    if action.marks and value == action.marks_on:
        truth.mark(thing, action.marks, action.marks_periods)
    return ""


def _at_work(truth: Truth, robot: Thing, thing: Thing) -> str:
    space = truth.layout.spaces[robot.place]
    x, y = truth.cell(robot)
    position = truth.line(thing)
    if y != space.height or x == space.dock_column:
        return f"{robot.name} is not at the line"
    if x != position:
        return f"{robot.name} is at column {x} and {thing.name} at position {position}"
    return ""


# ---------------------------------------------------------------- people
def begin_repair(truth: Truth, task: Task) -> str:
    return present(truth, task)


def end_repair(truth: Truth, task: Task) -> str:
    assert task.robot is not None
    task.robot.broken = False
    return ""


def begin_inspect(truth: Truth, task: Task) -> str:
    name = str(task.arg("robot"))
    thing = truth.find(task.team, name)
    if thing is None or truth.kind(thing).role != "robot":
        return f"there is no robot {name}"
    # What is found is how it was when the person came; a repair may follow in the same period.
    task.robot, task.finding = thing, "broken" if thing.broken else "sound"
    return ""


def end_inspect(truth: Truth, task: Task) -> str:
    return ""
