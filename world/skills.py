"""The generic skills: what a robot, a line or a person can do in one period, and what has to be so for it to work. Only
following a way may take several.

Each skill has a beginning and an end, functions of the truth and a `Task`. Both give the reason why nothing comes of
it, or an empty text. Between the two, physics moves the bodies. What a call says is never believed: an action has the
effect that is physically possible, or none.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from world import following, grasping, handling, moving, recalling, stores
from world.tasks import Task
from world.truth import Truth

Part = Callable[[Truth, Task], str]


class Skill(NamedTuple):
    """`rank`: who looks first; a person before the robots, work before the line moves."""

    begin: Part
    end: Part
    rank: int = 2


SKILLS: dict[str, Skill] = {
    "repair": Skill(handling.begin_repair, handling.end_repair, 0),
    "inspect": Skill(handling.begin_inspect, handling.end_inspect, 0),
    "operate": Skill(handling.begin_operate, handling.end_operate, 1),
    "couple": Skill(handling.begin_couple, handling.end_couple),
    "uncouple": Skill(handling.begin_uncouple, handling.end_uncouple),
    "charge": Skill(stores.begin_charge, stores.end_charge),
    "set": Skill(handling.begin_set, handling.end_set),
    "drive": Skill(moving.begin_drive, moving.end_drive),
    "drive_coupled": Skill(moving.begin_drive_coupled, moving.end_drive),
    "depart": Skill(moving.begin_depart, moving.end_depart),
    "arrive": Skill(moving.begin_arrive, moving.end_arrive),
    "convey": Skill(moving.begin_convey, moving.end_convey, 3),
    "follow": Skill(following.begin_follow, following.end_follow),
    "grasp": Skill(grasping.begin_grasp, grasping.end_grasp),
    "release": Skill(grasping.begin_release, grasping.end_release),
    "leave": Skill(grasping.begin_leave, grasping.end_leave),
    "enter": Skill(grasping.begin_enter, grasping.end_enter),
    "recall": Skill(recalling.begin_recall, recalling.end_recall),
}
