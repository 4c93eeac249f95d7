"""Team agent -> world: acting and looking."""

from __future__ import annotations

from typing import Literal

import msgspec

from bus.messages.basics import Body, Name, State, Step, Value


class SkillCall(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One action of a plan as the world is asked to carry it out.

    `name` and `args` are the action's term, ``move(w1,right)``; `detail` carries what the written
    form leaves out (which end effector a robot is given on its way, which physical robot a guest is).
    """

    name: Name
    args: tuple[Value, ...] = ()
    detail: dict[str, Value] = {}


class Execute(Body, frozen=True):
    """Carry out these actions as the team's discrete step `step`. Reply: `Executed`."""

    team: Name
    step: Step
    calls: tuple[SkillCall, ...] = ()


class Executed(Body, frozen=True):
    """The step is over: what the team's sensors show now.

    `findings` holds what inspections of this step found: ``{"c1": "broken"}`` or ``"sound"``. `felt` is what robots
    felt that did not do what they were to: ``blocked`` stopped before something in its way, or was held up,
    ``too_heavy`` pulled and nothing moved, ``nothing_there`` grasped into the air.
    """

    team: Name
    step: Step
    state: State
    findings: dict[str, Literal["broken", "sound"]] = {}
    felt: dict[str, Literal["blocked", "too_heavy", "nothing_there"]] = {}


class Observe(Body, frozen=True):
    """Look without acting. Reply: `Observed`."""

    team: Name


class Observed(Body, frozen=True):
    team: Name
    state: State
