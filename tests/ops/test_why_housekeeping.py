"""``muster why`` about rooms: why there is no plan, none shorter, none in time, and why an action is not possible."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from bus.scene import Scene
from ops.cli import main
from ops.compile import compile_scenario
from ops.recording import Writer
from ops.scenario import load
from ops.whysubjects import subject_of
from tests.ops.test_why import ask, members

pytestmark = pytest.mark.slow

BEDROOM = "housekeeping/bedroom"
GAP = {"robot(r1)", "rule(no_way)", "solid(bed)", "solid(nightstand)"}
SMALL = (
    "housekeeping/living_room", "--set", "teams.living_room.width=4", "--set", "teams.living_room.height=3",
    "--set", "teams.living_room.deposit=[3,3,0,1]", "--set", "teams.living_room.exchange=[]",
    "--set", "teams.living_room.furniture=[]", "--set", 'teams.living_room.robots=[{name="r1", at=[0,0]}]',
    "--set", 'teams.living_room.things=[{name="novel", kind="novel", at=[1,1]}]',
)  # fmt: skip
NOVEL = {"place(novel)", "start(at(novel),(1,1))", "start(connected(r1),none)", "robot(r1)", "rule(attach_apart)"}


def test_a_gap_that_is_too_narrow(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, BEDROOM)
    assert part["claim"] == "bedroom has no plan, however long"
    assert members(part) == {"place(pillow_1)", "crew", "start(at(pillow_1),(1,2))", *GAP}
    assert main(["why", BEDROOM]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "  goal        pillow_1 is to be where it belongs" in lines
    assert {"  fact        bed stands in the room", "  fact        nightstand stands in the room"} <= set(lines)


def test_a_way_that_is_not_there(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, BEDROOM, "--action", "goto(r1,1,2)", "--step", "0")
    assert members(part) == {"action(goto(r1,1,2))", "start(at(r1),(4,6))", *GAP}
    (way,) = (member for member in part["members"] if member["member"] == "rule(no_way)")
    assert way["otherwise"] == "r1 has no way there: between are bed and nightstand (step 0)"
    blind = "house.geometry=none"
    assert ask(capsys, BEDROOM, "--set", blind, "--action", "goto(r1,1,2)", "--step", "0", code=1)


def test_why_not_one_step_shorter(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, *SMALL)
    assert part["claim"] == "living_room cannot finish in 3 steps"
    assert members(part) == {*NOVEL, "start(at(r1),(0,0))", "free(r1)", "rule(busy)", "steps(3)"}


def test_why_not_within_the_deadline(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, *SMALL, "--set", "teams.living_room.deadline=3")
    assert part["claim"] == "living_room has no plan, however long"
    assert members(part) == {*NOVEL, "start(at(r1),(0,0))", "free(r1)", "rule(busy)", "deadline(3)"}
    assert "the deadline is at 3 units of time" in {member["text"] for member in part["members"]}


def test_rooms_are_asked_one_by_one(capsys: pytest.CaptureFixture[str]) -> None:
    mug = 'teams.kitchen.things=[{name="mug", kind="mug", at=[8, 3]}]'
    both = ("housekeeping/deadline_with_help", "--set", mug, "--set", "teams.kitchen.deadline=0", "--within", "3")
    bedroom, kitchen = ask(capsys, *both)
    assert (bedroom["claim"], kitchen["claim"]) == (
        "bedroom cannot finish in 3 steps",
        "kitchen cannot finish in 3 steps",
    )
    assert members(bedroom) >= {"place(pillow_1)", "steps(3)"}
    assert members(kitchen) >= {"place(mug)", "steps(3)"}
    (one,) = ask(capsys, *both, "--team", "bedroom")
    assert members(one) == members(bedroom)


def test_the_living_room_as_published(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, "housekeeping/living_room")
    assert members(part) == {
        "place(comics_1)", "place(novel_1)", "start(at(comics_1),(1,2))", "start(at(novel_1),(6,3))",
        "start(at(r1),(3,2))", "start(connected(r1),none)", "robot(r1)", "free(r1)", "rule(attach_apart)", "rule(busy)",
        "steps(7)",
    }  # fmt: skip


@pytest.mark.parametrize("name", ["person_in_doorway", "three_rooms", "heavy_pillow", "kitchen"])
def test_a_recorded_run_begins_as_its_scenario_does(tmp_path: Path, name: str) -> None:
    compiled = compile_scenario(load(f"housekeeping/{name}"))
    compiled.write(tmp_path)
    writer = Writer(tmp_path / "run.mcap")
    writer.add("scene", msgspec.json.decode((tmp_path / "world.json").read_bytes(), type=Scene))
    writer.close()
    assert subject_of(str(tmp_path)).states == compiled.setup.states


def test_rooms_know_no_suspicions(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["why", BEDROOM, "--suspected", "r1"]) == 2
    assert "the domain housekeeping cannot be asked about suspicions yet" in capsys.readouterr().err


def test_what_a_robot_holds_is_told_by_its_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["why", *SMALL, "--action", "attach(r1)", "--step", "2"]) == 0
    assert "  fact        r1 holds novel" in capsys.readouterr().out.splitlines()
