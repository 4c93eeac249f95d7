"""The skill of driving along a way that the call gives, alone or with another robot that holds the same thing."""

from __future__ import annotations

from collections.abc import Iterable
from math import dist

from world.driving import Driver
from world.tasks import Task, able
from world.truth import Truth
from world.ways import read

START_M = 0.05
"""A way begins so near to where the robot stands."""
MOST_UNITS = 1000
"""No way takes longer."""


def begin_follow(truth: Truth, task: Task) -> str:
    if reason := able(truth, task):
        return reason
    assert task.robot is not None
    units = task.call.detail.get("units")
    if not isinstance(units, int) or not 1 <= units <= MOST_UNITS:
        return "it is not said how many units the way takes"
    task.units = units
    ox, oy = truth.layout.origin(task.team)
    task.way = [(ox + x, oy + y) for x, y in read(task.call.detail.get("way"))]
    if not task.way:
        return "there is no way, or none that can be read"
    if dist(task.way[0], truth.floor.where(task.robot.id)) > START_M:
        task.felt = "blocked"
        return f"the way does not begin where {task.robot.name} stands"
    return ""


def set_out(truth: Truth, driver: Driver, tasks: Iterable[Task]) -> None:
    """Off go all drives that have begun; robots that hold the same heavy thing go together."""
    together: dict[str, list[Task]] = {}
    for task in tasks:
        if task.way and not task.failed and task.robot is not None:
            held = truth.things.get(task.robot.partner)
            heavy = held is not None and held.heavy
            together.setdefault(task.robot.partner if heavy else task.robot.id, []).append(task)
    for group in together.values():
        group.sort(key=lambda task: task.robot.end if task.robot is not None else 0)
        robots = [task.robot for task in group if task.robot is not None]
        units = max(task.units for task in group)
        try:
            trip = driver.set_out(robots, [task.way for task in group], units * truth.period)
        except ValueError as error:
            for task in group:
                task.failed, task.felt = str(error), "blocked"
            continue
        for task in group:
            task.trip = trip


def end_follow(truth: Truth, task: Task) -> str:
    assert task.robot is not None
    if task.trip is None or task.trip.outcome == "there":
        return ""
    if task.robot.broken:
        return f"{task.robot.name} is broken"
    # Who carries something with a broken robot cannot move it alone.
    task.felt = "too_heavy" if task.trip.outcome == "stopped" else task.trip.outcome or None
    return f"{task.robot.name} " + ("cannot move what it holds" if task.felt == "too_heavy" else "was held up")
