"""The programs that judge: what they may share, how they are put together, and silence on the smallest inputs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from reasoning.checker import check
from reasoning.diagnoser import diagnose
from reasoning.domain import core_program, domains, load
from reasoning.setup import Setup, compile_setup
from reasoning.values import Case

INCLUDE = re.compile(r'^#include "(.+)"\.$', re.MULTILINE)
ENTRIES = [(name, entry) for name in domains() for entry in ("check", "diagnose")]
ALONE = [(name, entry) for name in domains() for entry in ("setup", "diagnose_best")]


def parts(entry: Path) -> list[Path]:
    return [entry.parent / name for name in INCLUDE.findall(entry.read_text())]


def files() -> list[Path]:
    found = {file for name, entry in ENTRIES for file in (load(name).program(entry), *parts(load(name).program(entry)))}
    found |= {load(name).program(entry) for name, entry in ALONE}
    return sorted(found | {core_program("match")})


@pytest.mark.parametrize(("name", "entry"), ENTRIES)
def test_an_entry_file_is_include_only_and_one_of_its_parts_displays(name: str, entry: str) -> None:
    program = load(name).program(entry)
    code = [line for line in program.read_text().splitlines() if line and not line.startswith("%")]
    assert all(INCLUDE.match(line) for line in code)
    included = parts(program)
    assert len(included) == len(set(included))
    assert not any(INCLUDE.search(part.read_text()) for part in included), "library files include nothing"
    assert sum("#show" in part.read_text() for part in included) == 1


@pytest.mark.parametrize("name", domains())
def test_the_checker_shares_no_law_with_the_planner(name: str) -> None:
    """What they share is facts alone."""
    domain = load(name)
    shared = set(parts(domain.program("check"))) & set(parts(domain.program("plan")))
    assert not [part for part in shared if ":-" in part.read_text()]


@pytest.mark.parametrize("file", files(), ids=lambda file: file.stem)
def test_a_program_has_a_header_and_a_readable_size(file: Path) -> None:
    lines = file.read_text().splitlines()
    assert lines[0].startswith("% ")
    assert len(lines) < 60
    assert max(map(len, lines)) <= 120
    if not INCLUDE.search(file.read_text()):
        header = lines[: next(number for number, line in enumerate(lines) if not line.startswith("%"))]
        assert any(re.match(r"% (in|out):", line) for line in header), "what goes in, what comes out"


@pytest.mark.parametrize("workers", [[], [{"name": "w1", "at": [1, 1], "effector": 1}]])
def test_the_smallest_teams_are_judged_without_a_message(workers: list[dict[str, object]]) -> None:
    """A message of the grounder is an error in `reasoning.solver`."""
    team = {"boxes": 0, "workers": workers, "carrier": {"name": "c1", "at": [1, 1]}}
    setup = compile_setup("factory", {"teams": {"T1": team}})
    assert isinstance(setup, Setup)
    assert check("factory", setup.static, setup.states, {}) == []
    assert check("factory", setup.static, setup.states, {}, exchanges=[], details={"T1": {}}) == []
    assert check("factory", {}, {}, {}) == []
    start = setup.states["T1"]
    assert diagnose(Case("factory", setup.static, start, (), start)).diagnoses[0].causes == ()
    moved = {**start, "at(c1)": "(2,2)"}
    assert diagnose(Case("factory", setup.static, start, ((),), moved)).diagnoses[0].causes == ("moved(c1)",)
