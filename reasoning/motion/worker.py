"""The one door to ompl: a process that plans motions of rigid bodies, a query a line.

``python -m reasoning.motion.worker`` says ``ready``, then reads queries and writes paths as JSON, one a line, until
its input ends. It is a process of its own because ompl holds the interpreter's lock while it plans and may crash it.
Each query brings a seed and a budget of clearances that may be looked up, so equal queries give equal answers.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from ompl import base, geometric, util

from reasoning.motion.layout import Layout
from reasoning.motion.rigid import Body, Capsule, Pose, Surroundings

RANGE_M = 1.0
"""How far RRT-Connect grows a tree at once; longer and shorter did worse in narrow scenes."""


class Counted(Surroundings):
    """Surroundings that count the clearances looked up, and how often it is asked whether they were enough."""

    def __init__(self, layout: Layout, budget: int) -> None:
        super().__init__(layout)
        self._left = budget

    def clearance(self, body: Body, pose: Pose) -> float:
        self._left -= 1
        return super().clearance(body, pose)

    def spent(self) -> bool:
        self._left -= 1  # so that a planner that waits for something ends as well
        return self._left <= 0


class EdgeCheck(base.MotionValidator):  # type: ignore[misc]
    """Checks whole edges, without gaps between the poses that are looked at."""

    def __init__(self, information: Any, around: Surroundings, body: Body, margin_m: float) -> None:
        super().__init__(information)
        self._around, self._body, self._margin_m = around, body, margin_m

    def checkMotion(self, first: Any, second: Any) -> bool:  # noqa: N802 (ompl's name)
        return self._around.moves(self._body, _pose(first), _pose(second), self._margin_m)


def plan(
    layout: Layout, body: Body, start: Pose, goal: Pose, margin_m: float, seed: int, budget: int
) -> list[Pose] | None:
    """A path of poses with a clearance of the margin at its corners; None: none found within the budget."""
    util.RNG.setSeed(seed)
    around = Counted(layout, budget)
    space = base.SE2StateSpace()
    bounds = base.RealVectorBounds(2)
    for axis, side in enumerate((layout.width_m, layout.height_m)):
        bounds.setLow(axis, 0.0)
        bounds.setHigh(axis, side)
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(lambda state: around.clearance(body, _pose(state)) >= margin_m)
    information.setMotionValidator(EdgeCheck(information, around, body, margin_m))
    ends = []
    for x, y, yaw in (start, goal):
        state = information.allocState()  # never freed: Python owns it
        state.setXY(x, y)
        state.setYaw(yaw)
        space.enforceBounds(state)  # half a turn is written as -pi
        ends.append(state)
    setup.setStartAndGoalStates(*ends)
    planner = geometric.RRTConnect(information)
    planner.setRange(RANGE_M)
    setup.setPlanner(planner)
    setup.solve(base.PlannerTerminationCondition(around.spent))
    if not setup.haveExactSolutionPath():
        return None
    path = setup.getSolutionPath()
    # Not `simplifySolution`, which is timed, nor its splines, which leave the free space.
    simplifier = geometric.PathSimplifier(information)
    simplifier.reduceVertices(path)
    simplifier.partialShortcutPath(path)
    return [_pose(state) for state in path.getStates()]


def _pose(state: Any) -> Pose:
    return state.getX(), state.getY(), state.getYaw()


def main() -> None:
    util.noOutputHandler()
    print("ready", flush=True)
    for line in sys.stdin:
        query = json.loads(line)
        width_m, height_m = query["room"]
        discs = tuple((x, y, radius) for x, y, radius in query["discs"])
        layout = Layout(width_m, height_m, tuple(map(_points, query["polygons"])), discs)
        body = tuple(Capsule((a[0], a[1]), (b[0], b[1]), radius) for a, b, radius in query["body"])
        path = plan(
            layout, body, tuple(query["start"]), tuple(query["goal"]), query["margin_m"], query["seed"], query["budget"]
        )
        print(json.dumps(path), flush=True)


def _points(polygon: list[list[float]]) -> tuple[tuple[float, float], ...]:
    return tuple((x, y) for x, y in polygon)


if __name__ == "__main__":
    main()
