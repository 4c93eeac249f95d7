"""Stores: an attribute of a robot that its actions take units of, and that a charger fills."""

from __future__ import annotations

from world.handling import holds
from world.tasks import Task, able
from world.truth import Truth


def lacks(task: Task) -> str:
    """Why its robot has too little left for this action, or empty."""
    left = _left(task)
    return f"{task.robot.name} has no {task.action.drains} left" if task.robot is not None and left == 0 else ""


def drain(task: Task) -> None:
    """The action has had its effect, and took a unit."""
    left = _left(task)
    if task.robot is not None and left is not None:
        task.robot.attributes[task.action.drains] = left - 1


def _left(task: Task) -> int | None:
    """None: the action takes nothing of this robot."""
    left = task.robot.attributes.get(task.action.drains) if task.robot is not None else None
    return left if isinstance(left, int) else None


def begin_charge(truth: Truth, task: Task) -> str:
    """Why the robot cannot fill the store of the one that it holds, or empty."""
    if reason := able(truth, task):
        return reason
    assert task.robot is not None
    if reason := holds(truth, task.robot):
        return reason
    other = task.other = truth.things[task.robot.partner]
    if not isinstance(other.attributes.get(task.action.attribute), int):
        return f"{other.name} has no {task.action.attribute}"
    return ""


def end_charge(truth: Truth, task: Task) -> str:
    """`gain` more units are in the store, up to `most`."""
    other, action = task.other, task.action
    assert other is not None
    left = other.attributes[action.attribute]
    assert isinstance(left, int)
    other.attributes[action.attribute] = min(left + action.gain, action.most)
    return ""
