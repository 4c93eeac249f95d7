"""Commonsense: defaults that yield to what is more special, and where things found in a room are to be."""

from __future__ import annotations

import pytest

from reasoning.domain import load
from reasoning.solver import models

FOLDER = load("housekeeping").folder
SHOWN = "#show home/2. #show fragile/1."


def derived(*facts: str) -> set[str]:
    (model,) = models([FOLDER / "commonsense.lp"], [*facts, SHOWN])
    return {f"{atom.name}({','.join(map(str, atom.args))})" for atom in model.atoms}


@pytest.mark.parametrize(
    ("facts", "expected"),
    [
        (["usual(book,study)."], {"home(book,study)"}),
        (["usual(book,study).", "is_a(novel,book)."], {"home(book,study)", "home(novel,study)"}),
        (["usual(book,study).", "is_a(cookbook,book).", "usual(cookbook,kitchen).", "is_a(bakebook,cookbook)."],
         {"home(book,study)", "home(cookbook,kitchen)", "home(bakebook,kitchen)"}),
        (["care(cup).", "is_a(mug,cup).", "is_a(paper_cup,cup).", "sturdy(paper_cup)."],
         {"fragile(cup)", "fragile(mug)"}),
        (["care(cup).", "sturdy(cup)."], set()),
        (["is_a(pen,tool)."], set()),
    ],
)  # fmt: skip
def test_defaults_hold_unless_something_more_special_is_known(facts: list[str], expected: set[str]) -> None:
    assert derived(*facts) == expected


@pytest.mark.parametrize(
    ("kind", "room"),
    [("novel", "living_room"), ("cookbook", "kitchen"), ("red_pillow", "bedroom"), ("plate", "kitchen"),
     ("teddy", "bedroom"), ("ball", "living_room"), ("lamp", "living_room"), ("night_lamp", "bedroom")],
)  # fmt: skip
def test_the_base_that_ships(kind: str, room: str) -> None:
    files = [FOLDER / "commonsense.lp", FOLDER / "commonsense" / "base.lp", FOLDER / "commonsense" / "built.lp"]
    (model,) = models(files, [SHOWN])
    homes = {atom.args[1] for atom in model.atoms if atom.name == "home" and atom.args[0] == kind}
    fragile = {atom.args[0] for atom in model.atoms if atom.name == "fragile"}
    assert homes == {room}
    assert {"plate", "wine_glass", "night_lamp"} <= fragile
    assert not {"paper_cup", "plastic_cup", "novel"} & fragile


@pytest.mark.parametrize(
    ("kind", "places"),
    [("novel", {"(0,0)"}), ("plate", {"(2,0)"}), ("cookbook", {"(2,0)"}), ("red_pillow", {"(0,1)", "(1,1)"}),
     ("meteorite", {"(0,0)"})],
)  # fmt: skip
def test_a_thing_belongs_in_the_deposit_area_or_towards_its_room(kind: str, places: set[str]) -> None:
    files = [FOLDER / name for name in ("signature.lp", "commonsense.lp", "commonsense/base.lp")]
    facts = [
        "static(size(living_room),(3,2)).", "static(area(living_room,living_room),(0,0,0,0)).",
        "static(area(living_room,kitchen),(2,2,0,0)).", "static(area(living_room,bedroom),(0,1,1,1)).",
        "init(room,living_room).", f"init(kind(it),{kind}).", "init(at(it),(1,0)).", "#show wanted/2.",
    ]  # fmt: skip
    (model,) = models(files, facts)
    assert {str(atom.args[1]) for atom in model.atoms} == places
