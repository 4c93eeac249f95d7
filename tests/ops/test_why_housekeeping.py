"""``muster why`` about rooms: why there is no plan, none shorter, none in time, and why an action is not possible."""

from __future__ import annotations

import pytest

from ops.cli import main
from tests.ops.test_why import ask, members

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


@pytest.mark.slow
def test_the_living_room_as_published(capsys: pytest.CaptureFixture[str]) -> None:
    (part,) = ask(capsys, "housekeeping/living_room")
    assert members(part) == {
        "place(comics_1)", "place(novel_1)", "start(at(comics_1),(1,2))", "start(at(novel_1),(6,3))",
        "start(at(r1),(3,2))", "start(connected(r1),none)", "robot(r1)", "free(r1)", "rule(attach_apart)", "rule(busy)",
        "steps(7)",
    }  # fmt: skip
