"""Set-ups: from tables to the world's start, and errors that name the key and what was expected."""

from __future__ import annotations

import copy
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoning.domain import domains, load, read
from reasoning.setup import Refused, Setup, compile_setup, sections
from reasoning.setup_help import reference

DOMAIN = "factory"
TEAM: dict[str, Any] = {
    "boxes": 2,
    "workers": [{"name": "w1", "at": [1, 3], "effector": 1}, {"name": "w2", "at": [2, 3], "effector": 3}],
    "carrier": {"name": "c1", "at": [1, 1]},
}


WORKER: dict[str, Any] = {"name": "w1", "at": [1, 3], "effector": 1}


def tables(**changed: Any) -> dict[str, Any]:
    return {"teams": {"T1": {**copy.deepcopy(TEAM), **changed}}}


PAIR = {"from": "T1", "to": "T2", "steps": 3}


def general(*delays: dict[str, Any], sharing: str = "general") -> dict[str, Any]:
    exchange = {"sharing": sharing, "delays": list(delays or [PAIR])}
    return {"teams": {"T1": TEAM, "T2": TEAM}, "exchange": exchange}


def compiled(given: dict[str, Any]) -> Setup:
    setup = compile_setup(DOMAIN, given)
    assert isinstance(setup, Setup)
    return setup


def test_a_set_up_says_all_that_the_world_must_know() -> None:
    setup = compiled({**tables(), "floor": {"width": 4}, "exchange": {"delay": 3}})
    assert setup.static == {"width": 4, "height": 3, "line": 4, "delay": 3}
    assert setup.workspaces == {"T1": {"width": 4, "height": 3, "line_length": 4, "dock_column": 1}}
    assert setup.entities == (
        ("T1", "w1", "worker"), ("T1", "w2", "worker"), ("T1", "c1", "carrier"), ("T1", "1", "box"), ("T1", "2", "box"),
    )  # fmt: skip
    assert setup.states == {
        "T1": {
            "at(w1)": "(1,3)", "effector(w1)": 1, "at(w2)": "(2,3)", "effector(w2)": 3,
            "at(c1)": "(1,1)", "attached(c1)": "none",
            "line(1)": 5, "stage(1)": 0, "wet(1)": 0, "line(2)": 6, "stage(2)": 0, "wet(2)": 0,
        }
    }  # fmt: skip


def test_general_sharing_and_its_delays_are_constants_and_fixed_workers_are_bodies_of_their_own() -> None:
    setup = compiled(general(PAIR))
    assert setup.static.items() >= {"delay": 2, 'delay("T1","T2")': 3, "sharing": "general", "most": 2}.items()
    fixed = compiled(
        {"teams": {"T1": {"boxes": 0, "workers": [{**WORKER, "fixed": 1}, {**WORKER, "name": "w2", "at": [1, 1]}]}}}
    )
    assert [(e.name, e.kind) for e in fixed.entities] == [("w2", "worker"), ("w1", "specialist")]
    assert {fluent for fluent in fixed.states["T1"] if fluent.startswith("fixed")} == {"fixed(w1)"}


def test_teams_keep_the_scenarios_order_and_many_boxes_theirs() -> None:
    setup = compiled({"teams": {"Zoe": {**TEAM, "boxes": 11}, "Ann": TEAM}})
    assert list(setup.states) == ["Zoe", "Ann"]
    assert [e.name for e in setup.entities if (e.team, e.kind) == ("Zoe", "box")] == [str(b) for b in range(1, 12)]


@pytest.mark.parametrize("name", domains())
def test_every_shipped_scenario_compiles(name: str) -> None:
    for file in load(name).scenarios.values():
        with file.open("rb") as opened:
            scenario = tomllib.load(opened)
        result = compile_setup(name, {key: scenario[key] for key in sections(name) if key in scenario})
        assert isinstance(result, Setup), (file, result)


W1, W2 = TEAM["workers"]
WRONG: list[tuple[dict[str, Any], str, str]] = [
    ({}, "teams", "at least one table [teams.NAME]"),
    ({"teams": {}}, "teams", "at least one table [teams.NAME]"),
    ({"teams": {"T 1": TEAM}}, "teams.T 1", "a team's name: a letter"),
    ({"teams": {"T1": 7}}, "teams.T1", "a table"),
    ({**tables(), "flor": {}}, "flor", "one of the keys teams, floor, exchange"),
    ({**tables(), "floor": {"width": 99}}, "floor.width", "an integer, 2 to 12"),
    ({**tables(), "floor": {"width": True}}, "floor.width", "an integer, 2 to 12"),
    ({**tables(), "floor": [3]}, "floor", "a table"),
    ({**tables(), "exchange": {"delay": "2"}}, "exchange.delay", "an integer, 1 to 20"),
    (tables(boxes=-1), "teams.T1.boxes", "an integer, 0 to 40"),
    (tables(bowls=1), "teams.T1.bowls", "one of the keys boxes, workers, carrier"),
    ({"teams": {"T1": {"carrier": TEAM["carrier"]}}}, "teams.T1.boxes", "an integer, 0 to 40"),
    (tables(carrier=1), "teams.T1.carrier", "a table"),
    (tables(carrier=False), "teams.T1.carrier", "a table"),
    (tables(workers=[{**W1, "name": "not"}]), "teams.T1.workers[0].name", "and not the word not"),
    ({**tables(), "exchange": {"sharing": "all"}}, "exchange.sharing", "published or general"),
    (general(sharing="published"), "exchange.delays", "none, unless sharing is general"),
    (general({"from": "T1", "to": "T3", "steps": 3}), "exchange.delays[0].to", "a team of this scenario"),
    (general({"from": "T2", "to": "T2", "steps": 3}), "exchange.delays[0].to", "another team than from"),
    (general(PAIR, {**PAIR, "steps": 4}), "exchange.delays[1]", "a pair of teams that has no other entry"),
    (general({**PAIR, "steps": 0}), "exchange.delays[0].steps", "an integer, 1 to 20"),
    (general({**PAIR, "to": "2"}), "exchange.delays[0].to", "a team's name"),
    (tables(workers={"name": "w1"}), "teams.T1.workers", "a list of tables"),
    (tables(workers=[W1, 5]), "teams.T1.workers[1]", "a table"),
    (tables(workers=[{**W1, "at": [1]}]), "teams.T1.workers[0].at", "a cell [column, row] of two integers"),
    (tables(workers=[{**W1, "name": "W 1"}]), "teams.T1.workers[0].name", "a name: a small letter"),
    (tables(workers=[{**W1, "effector": 4}]), "teams.T1.workers[0].effector", "an integer, 1 to 3"),
    # what the domain's own program says
    (tables(workers=[{**W1, "at": [6, 1]}]), "teams.T1.workers[0].at", "a cell of the grid: column 1 to 5, row 1 to 3"),
    (tables(carrier={"name": "c1", "at": [0, 1]}), "teams.T1.carrier.at", "a cell of the grid"),
    (tables(workers=[W1, {**W2, "at": [1, 3]}]), "teams.T1.workers[1].at", "without another worker; w1 stands there"),
    (tables(workers=[W1, {**W2, "name": "w1"}]), "teams.T1.workers[0].name", "a name that no other robot"),
    (tables(carrier={"name": "w1", "at": [1, 1]}), "teams.T1.carrier.name", "a name that no other robot"),
    (tables(carrier={"name": "none", "at": [1, 1]}), "teams.T1.carrier.name", "none is a word of the domain"),
    (tables(workers=[{**W1, "name": "other"}]), "teams.T1.workers[0].name", "other is a word of the domain"),
]


@pytest.mark.parametrize(
    ("given_tables", "key", "expected"), WRONG, ids=lambda value: value if isinstance(value, str) else ""
)
def test_a_wrong_key_is_named_with_what_was_expected(given_tables: dict[str, Any], key: str, expected: str) -> None:
    refused = compile_setup(DOMAIN, given_tables)
    assert isinstance(refused, Refused)
    assert any(error.key == key and expected in error.expected for error in refused.errors), refused.errors
    assert all(str(error).startswith(f"{error.key}: expected ") for error in refused.errors)


def test_all_errors_are_told_at_once() -> None:
    refused = compile_setup(DOMAIN, {**tables(boxes="many", colour=3), "floor": {"width": 1}})
    assert isinstance(refused, Refused)
    assert {error.key for error in refused.errors} == {"teams.T1.boxes", "teams.T1.colour", "floor.width"}


def test_carriers_and_workers_may_share_a_cell_and_teams_their_names() -> None:
    both = {**TEAM, "carrier": {"name": "c1", "at": [1, 3]}}
    assert isinstance(compile_setup(DOMAIN, {"teams": {"T1": both, "T2": both}}), Setup)


def test_the_reference_tells_every_key_with_its_limits_default_and_help() -> None:
    lines = {line.key: line for line in reference(DOMAIN)}
    assert lines["floor.width"][1:4] == ("int", "2..12", "5")
    assert lines["teams.NAME.workers[].at"].type == "cell"
    assert lines["teams.NAME.boxes"].default == ""
    assert all(line.help for line in lines.values())


JUNK = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=6) | st.floats(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3),
    max_leaves=6,
)


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_junk_anywhere_is_refused_or_compiled_but_never_crashes(data: st.DataObject) -> None:
    changed: Any = tables()
    here = changed
    while isinstance(here, (dict, list)) and here:
        key = data.draw(st.sampled_from(list(here) if isinstance(here, dict) else list(range(len(here)))))
        if data.draw(st.booleans()) or not isinstance(here[key], (dict, list)):
            here[key] = data.draw(JUNK)
            break
        here = here[key]
    assert isinstance(compile_setup(DOMAIN, changed), (Setup, Refused))


def test_a_new_domain_needs_no_python(tmp_path: Path) -> None:
    folder = tmp_path / "harbour"
    folder.mkdir()
    (folder / "domain.toml").write_text(
        'name = "harbour"\nstory = ""\n[time]\n[setup.team.cranes]\ntype = "int"\ndefault = 1\n'
        "[kinds.crane]\n[actions]\n"
    )
    (folder / "setup.lp").write_text(
        "static(tide,2).\nentity(G,crane(1..N),crane) :- given((teams,G,cranes),N).\n"
        'init(G,free(C),1) :- entity(G,C,crane).\nbad(P,"fewer than {0}",(3,)) :- given(P,N), N > 2.\n'
    )
    harbour = read(folder)
    setup = compile_setup(harbour, {"teams": {"T1": {}}})
    assert isinstance(setup, Setup)
    assert setup.states == {"T1": {"free(crane(1))": 1}}
    refused = compile_setup(harbour, {"teams": {"T1": {"cranes": 3}}})
    assert isinstance(refused, Refused)
    assert str(refused.errors[0]) == "teams.T1.cranes: expected fewer than 3"
