"""The table of causes, row by row: from what was predicted, what is seen and what was felt to a cause with a name."""

from __future__ import annotations

import pytest

from agents.autonomous.causes import Cause, causes
from agents.autonomous.words import words
from reasoning.values import State

WORDS = words("housekeeping")
BEFORE: State = {
    "room": "kitchen", "elapsed": 3, "at(r1)": "(1,1)", "connected(r1)": "none",
    "at(mug)": "(4,1)", "kind(mug)": "mug", "at(pan)": "(2,3)", "kind(pan)": "pan",
}  # fmt: skip
HOLDING = {**BEFORE, "at(r1)": "(4,1)", "connected(r1)": "grip(mug,1)"}
GO, GRIP, CARRY = "goto(r1,4,1)", "attach(r1)", "goto(r1,0,1)"
THERE = {**BEFORE, "at(r1)": "(4,1)"}
CARRIED = {**HOLDING, "at(r1)": "(0,1)", "at(mug)": "(0,1)"}
STOPPED = {**BEFORE, "at(r1)": "(2,1)", "pose(r1)": "(2600,1500)"}
BESIDE = {"at(vase)": "(3,1)", "kind(vase)": "vase"}
ANNA = {"at(anna)": "(3,1)", "kind(anna)": "person"}
FAR = {"at(vase)": "(7,7)", "kind(vase)": "vase"}
NO_MUG = {fluent: value for fluent, value in THERE.items() if "mug" not in fluent}

ROWS: dict[str, tuple[State, str, State, State, dict[str, str], list[Cause]]] = {
    "as predicted": (BEFORE, GO, THERE, THERE, {}, []),
    "time goes its own way": (BEFORE, GO, THERE, {**THERE, "elapsed": 9}, {}, []),
    "too heavy to be gripped": (
        THERE, GRIP, HOLDING, {**THERE, "end(mug)": "(5,1)"}, {"r1": "too_heavy"}, [Cause("heavy_object", "mug", "r1")]
    ),
    "too heavy to be dragged": (
        HOLDING, CARRY, CARRIED, HOLDING, {"r1": "too_heavy"}, [Cause("heavy_object", "mug", "r1")]
    ),
    "grasped into the air": (
        THERE, GRIP, HOLDING, NO_MUG, {"r1": "nothing_there"}, [Cause("object_not_found", "mug", "r1")]
    ),
    "gone when it got there": (BEFORE, GO, THERE, NO_MUG, {}, [Cause("object_not_found", "mug")]),
    "moved meanwhile": (BEFORE, GO, THERE, {**THERE, "at(mug)": "(5,5)"}, {}, [Cause("object_not_found", "mug")]),
    "taken out of the hand": (HOLDING, CARRY, CARRIED, {**NO_MUG, "at(r1)": "(0,1)"}, {}, [
        Cause("object_not_found", "mug", "r1"),
    ]),
    "a person in the way": (
        BEFORE, GO, THERE, {**STOPPED, **ANNA, **BESIDE}, {"r1": "blocked"},
        [Cause("person_in_way", "anna", "r1"), Cause("object_appeared", "vase")],
    ),
    "an unknown object in the way": (
        BEFORE, GO, THERE, {**STOPPED, **BESIDE}, {"r1": "blocked"}, [Cause("unknown_object", "vase", "r1")]
    ),
    "held up by another robot": (
        {**BEFORE, "at(r2)": "(3,1)", "connected(r2)": "none"}, GO,
        {**THERE, "at(r2)": "(3,1)", "connected(r2)": "none"},
        {**STOPPED, "at(r2)": "(3,1)", "connected(r2)": "none"},
        {"r1": "blocked"}, [Cause("held_up", "r2", "r1")],
    ),
    "nothing done, nothing felt": (BEFORE, GO, THERE, BEFORE, {}, [Cause("robot_broken", "r1", "r1")]),
    "something new that is in nobody's way": (
        BEFORE, GO, THERE, {**THERE, **FAR}, {}, [Cause("object_appeared", "vase")]
    ),
    "only its other end is new": (BEFORE, GO, THERE, {**THERE, "end(pan)": "(2,4)"}, {}, []),
}  # fmt: skip


@pytest.mark.parametrize("row", ROWS)
def test_every_difference_has_its_cause(row: str) -> None:
    before, action, predicted, seen, felt, expected = ROWS[row]
    assert causes(WORDS, before, predicted, seen, felt, [action]) == expected
