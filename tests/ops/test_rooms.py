"""What the world is told of a house, what the teams are not told, and which disturbances of it are refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec
import pytest

from bus.scene import Scene, Solid, Stop
from ops.compile import Compiled, compile_scenario
from ops.scenario import parse
from ops.tables import InputError

HOUSE: dict[str, Any] = {
    "story": "two rooms",
    "domain": "housekeeping",
    "house": {"robot_radius_cm": 20, "hallway": 3},
    "teams": {
        "K": {
            "room": "kitchen",
            "width": 6,
            "height": 5,
            "deposit": [0, 1, 0, 2],
            "exchange": [{"to": "bedroom", "area": [5, 5, 1, 2]}],
            "robots": [{"name": "r1", "at": [1, 1], "short_arm": 1}],
            "things": [{"name": "cup", "kind": "cup", "at": [2, 2], "raised": 1}],
            "heavy": [{"name": "pan", "kind": "pan", "at": [3, 3], "end": [3, 4], "known": 0}],
            "furniture": [{"name": "shelf", "corners": [[400, 300], [500, 300], [450, 400]], "tall": 1}],
            "persons": [{"name": "anna", "at": [0, 4], "stops": [{"to": [5, 4], "after": 2}], "again": 20}],
        },
        "B": {"room": "bedroom", "deposit": [0, 1, 0, 2], "robots": []},
    },
}


def compiled(**more: Any) -> Compiled:
    return compile_scenario(parse({**HOUSE, **more}, Path("house.toml")))


def test_the_world_is_told_of_walls_doors_people_and_what_is_heavy() -> None:
    scene = compiled().files["world"]
    assert isinstance(scene, Scene)
    kitchen, bedroom = scene.workspaces
    assert (kitchen.room, kitchen.width, kitchen.height, bedroom.room) == ("kitchen", 6, 5, "bedroom")
    assert kitchen.solids == (Solid("shelf", ((4.0, 3.0), (5.0, 3.0), (4.5, 4.0)), tall=True),)
    assert (kitchen.doors, bedroom.doors) == ({"bedroom": (5, 5, 1, 2)}, {})
    assert (kitchen.store, bedroom.store) == ((0, 1, 0, 2), (0, 1, 0, 2))
    assert (kitchen.fluents, kitchen.clock) == ({"room": "kitchen", "elapsed": 0, "attaches": 0}, "elapsed")
    bodies = {entity.id: entity for entity in scene.entities}
    assert (bodies["K.pan"].end, bodies["K.pan"].known, bodies["K.cup"].end) == ("(3,4)", False, "")
    assert bodies["K.cup"].attributes == {"kind": "cup", "raised": 1}
    assert bodies["K.anna"].stops == (Stop(6.0, 5.5, 4.5),)
    assert (bodies["K.anna"].again_s, bodies["K.anna"].place) == (60.0, "(0,4)")
    assert (scene.kinds["robot"].radius_m, scene.kinds["thing"].radius_m) == (0.2, 0.12)
    assert (scene.conducted, scene.transport_delay_steps) == (False, 3)


def test_teams_are_told_nothing_of_people_and_weights() -> None:
    files = compiled().files
    for team in ("K", "B"):
        told = msgspec.json.encode(files[team]).decode()
        assert "anna" not in told
        assert "pan" not in told


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        ({"kind": "bring", "target": "K.ball", "what": "ball", "x": 6, "y": 0}, "0 to 5; found 6"),
        ({"kind": "bring", "target": "K.ball", "what": "A ball", "x": 0, "y": 0}, "expected what it is"),
        ({"kind": "bring", "target": "X.ball", "what": "ball", "x": 0, "y": 0}, "a new thing of a team"),
        ({"kind": "take", "target": "K.r1"}, "take needs an object"),
        ({"kind": "take", "target": "K.ball"}, "take needs an object"),
        ({"kind": "move", "target": "K.cup", "to": 2}, "all else to a cell x, y"),
        ({"kind": "move", "target": "K.anna", "x": 0, "y": 5}, "0 to 4; found 5"),
    ],
)
def test_disturbances_that_cannot_be_are_refused(fault: dict[str, Any], expected: str) -> None:
    with pytest.raises(InputError) as wrong:
        compiled(fault=[{"at_s": 1.0, **fault}])
    assert expected in str(wrong.value)


def test_disturbances_that_can_be_are_passed_on() -> None:
    faults = [
        {"kind": "bring", "target": "K.ball", "what": "ball", "x": 0, "y": 0, "at_s": 1.0},
        {"kind": "move", "target": "K.ball", "x": 5, "y": 4, "at_s": 2.0},
        {"kind": "take", "target": "K.ball", "at_s": 3.0},
        {"kind": "move", "target": "K.anna", "x": 1, "y": 4, "at_s": 3.0},
    ]
    scene = compiled(fault=faults).files["world"]
    assert isinstance(scene, Scene)
    assert [fault.kind for fault in scene.faults] == ["bring", "move", "take", "move"]
