"""What is sensed comes from the bodies."""

from __future__ import annotations

import itertools

import pytest

from tests.world.stage import Stage, hand, piece, scene, tug


def test_everything_of_the_own_workspace_and_nothing_else() -> None:
    bodies = (hand("A", "h1", 2, 2, tool=3), tug("A", "t1", 2, 2, holds="h1"), piece("A", 1, 9, state=2))
    stage = Stage(scene(*bodies, hand("B", "h1", 5, 1), teams=3))
    assert stage.state("A") == {
        "at(h1)": "(2,2)",
        "tool(h1)": 3,
        "at(t1)": "(2,2)",
        "holds(t1)": "h1",
        "line(1)": 9,
        "state(1)": 2,
        "hot(1)": 0,
    }
    assert stage.state("B") == {"at(h1)": "(5,1)", "tool(h1)": 1}
    assert stage.state("C") == {}


@pytest.mark.parametrize(
    ("dx_m", "dy_m", "seen"),
    [
        (0.0, 0.0, "(3,2)"),
        (0.39, -0.39, "(3,2)"),
        (0.45, 0.0, "(none)"),
        (0.0, 0.55, "(none)"),
        (0.7, 0.0, "(4,2)"),
        (-1.2, 0.8, "(2,3)"),
    ],
)
def test_a_robot_is_seen_where_its_body_is(dx_m: float, dy_m: float, seen: str) -> None:
    stage = Stage(scene(hand("A", "h1", 3, 2)))
    stage.world.truth.floor.put("A.h1", (3 + dx_m, 2 + dy_m))
    assert stage.state()["at(h1)"] == seen


def test_workspaces_are_apart() -> None:
    stage = Stage(scene(teams=10))
    layout = stage.world.truth.layout
    origins = [layout.origins[team] for team in "ABCDEFGHIJ"]
    assert all(b[1] - a[1] >= 3 + 1 + 1 for a, b in itertools.pairwise(origins))
    assert layout.cell("B", 1, 1) == (1.0, origins[1][1] + 1.0)
    assert layout.line("B", 5) == (5.0, origins[1][1] + 4.0)
