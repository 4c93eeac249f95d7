"""Scenario files: what is accepted, and the place and expectation in every refusal."""

from __future__ import annotations

from pathlib import Path

import pytest

from ops.places import shipped
from ops.scenario import Scenario, load, parse
from ops.tables import InputError, line_of, override, read

GOOD = """\
story = "A test."
domain = "factory"
seed = 3

[exchange]
delay = 2

[teams.T1]
boxes = 1
workers = [{name = "w1", at = [1, 3], effector = 1}]
carrier = {name = "c1", at = [1, 1]}

[[fault]]
at_step = 4
kind = "break"
target = "T1.c1"

[[fault]]
at_s = 1.5
kind = "pause"
target = "T1"
for_s = 5.0

[verdict]
makespan_at_most = 20
eventually = [{event = "repair", team = "T1"}]
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "test.toml"
    path.write_text(text)
    return path


def scenario(folder: Path, text: str = GOOD, *overrides: str) -> Scenario:
    return load(str(written(folder, text)), overrides)


def test_a_scenario_is_a_typed_value(tmp_path: Path) -> None:
    read = scenario(tmp_path)
    assert (read.name, read.domain, read.seed, read.teams) == ("test", "factory", 3, ("T1",))
    assert read.setup == {
        "exchange": {"delay": 2},
        "teams": {
            "T1": {
                "boxes": 1,
                "workers": [{"name": "w1", "at": [1, 3], "effector": 1}],
                "carrier": {"name": "c1", "at": [1, 1]},
            }
        },
    }
    first, second = read.faults
    assert (first.kind, first.target, first.at_step, first.at_s, first.args) == ("break", "T1.c1", 4, None, {})
    assert (second.kind, second.at_s, second.args) == ("pause", 1.5, {"for_s": 5.0})
    assert read.verdict.goal
    assert read.verdict.makespan_at_most == 20
    assert read.verdict.eventually == ({"event": "repair", "team": "T1"},)


def test_a_story_on_several_lines_and_defaults(tmp_path: Path) -> None:
    text = 'story = "x"\ndomain = "factory"\n[teams.A]\nboxes = 0\n'
    read = scenario(tmp_path, text)
    assert (read.seed, read.clock.option(), read.faults, read.plan) == (0, "fast", (), None)


@pytest.mark.parametrize("name", sorted(shipped()))
def test_every_shipped_scenario_can_be_read(name: str) -> None:
    assert load(name).story


@pytest.mark.parametrize(
    ("old", "new", "place", "expected"),
    [
        ('story = "A test."\n', "", "test.toml: story: ", "is missing"),
        ("seed = 3", "seed = 3.5", "test.toml, line 3: seed: ", "expected a whole number, got a number"),
        ("seed = 3", "sede = 3", "test.toml, line 3: sede: ", "one of"),
        ('domain = "factory"', 'domain = "fakory"', "line 2: domain: ", "expected one of "),
        ("seed = 3", "seed = ", "test.toml: not valid TOML", "line 3"),
        *(
            (
                "[teams.T1]",
                f"[teams.{taken}]",
                f"line 8: teams.{taken}: ",
                f"{taken} is the name of a process or a place",
            )
            for taken in (
                "world",
                "World",
                "coordinator",
                "supervisor",
                "recorder",
                "router",
                "operator",
                "bench",
                "gone",
            )
        ),
        ("at_step = 4\n", "", "line 13: fault[0]: ", "expected exactly one of at_step, at_s, on_action; it has none"),
        ("at_step = 4\n", "at_step = 4\nat_s = 1.0\n", "line 13: fault[0]: ", "it has at_step and at_s"),
        ("at_step = 4", "at_step = -4", "line 14: fault[0].at_step: ", ">= 0"),
        ("at_step = 4", 'at_step = "4"', "line 14: fault[0].at_step: ", "expected a whole number, got text"),
        ("at_step = 4", 'on_action = "T9.move(w1,right)"', "fault[0].on_action: ", "expected TEAM.ACTION"),
        ('kind = "break"', 'kind = "crush"', "line 15: fault[0].kind: ", "Supported: break ROBOT; move BODY"),
        ('target = "T1"\n', 'target = "T7"\n', "line 21: fault[1].target: ", "There are: world, coordinator, T1"),
        ("for_s = 5.0", "", "line 18: fault[1].for_s: ", "pause needs it. Supported: pause PROCESS for_s=..."),
        ("for_s = 5.0", "for_s = 0", "line 22: fault[1].for_s: ", "expected seconds, more than 0"),
        ("for_s = 5.0", "for_s = 5.0\nshare = 1", "line 23: fault[1].share: ", "pause does not take it"),
        ("makespan_at_most = 20", "makespan = 20", "line 25: verdict.makespan: ", "known here: goal, makespan_at_most"),
        ('event = "repair"', 'event = "repare"', "line 26: verdict.eventually[0].event: ", "not 'repare'"),
        (
            'team = "T1"}]',
            'team = "T1", robt = "w1"}]',
            "line 26: verdict.eventually[0].robt: ",
            "repair has no such field; it has source, text; team, robot",
        ),
        (
            "[verdict]",
            "[clock]\nmode = 'slow'\n[verdict]",
            "line 25: clock.mode: ",
            "'slow'; expected fast or realtime",
        ),
        ("at_step = 4", 'on_action = "T1.atach(c1,w1)"', "fault[0].on_action: ", ", attach, "),
        ("at_step = 4", 'on_action = "T1.atach(c1,w1)"', "line 14: ", "not 'atach'"),
        ("seed = 3", 'seed = 3\nplan = "no.json"', "line 4: plan: ", "there is neither"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(tmp_path: Path, old: str, new: str, place: str, expected: str) -> None:
    assert old in GOOD
    refused(tmp_path, GOOD.replace(old, new, 1), place, expected)


def compile_everything(scenario: Scenario) -> None:
    from ops.compile import compile_scenario

    compile_scenario(scenario)


def refused(tmp_path: Path, text: str, place: str, expected: str) -> None:
    with pytest.raises(InputError) as caught:
        compile_everything(scenario(tmp_path, text))
    assert place in str(caught.value)
    assert expected in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "place", "expected"),
    [
        ("boxes = 1", "boxes = 99", "line 9: teams.T1.boxes: ", "expected an integer, 0 to 40, found 99"),
        ("boxes = 1", "", "line 8: teams.T1.boxes: ", "expected an integer, 0 to 40"),
        ("boxes = 1", "boxes = 1\nrobots = 2", "line 10: teams.T1.robots: ", "expected one of the keys boxes"),
        ("effector = 1", "effector = 4", "line 10: teams.T1.workers[0].effector: ", "1 to 3, found 4"),
        ("at = [1, 3]", "at = [9, 3]", "line 10: teams.T1.workers[0].at: ", "a cell of the grid"),
        ("delay = 2", "delay = 0", "line 6: exchange.delay: ", "1 to 20"),
        ('target = "T1.c1"', 'target = "T1.c7"', "line 16: fault[0].target: ", "There are: T1.w1, T1.c1"),
        ("[exchange]", "[exchnage]", "line 5: exchnage: ", "one of"),
    ],
)
def test_the_domain_refuses_with_the_same_places(tmp_path: Path, old: str, new: str, place: str, expected: str) -> None:
    refused(tmp_path, GOOD.replace(old, new, 1), place, expected)


@pytest.mark.parametrize(
    ("target", "where", "place", "expected"),
    [
        ("T1.w1", "x = 6\ny = 1", "line 17: fault[0].x: ", "in the workspace of T1, 1 to 5; found 6"),
        ("T1.w1", "x = 1\ny = 0", "line 18: fault[0].y: ", "in the workspace of T1, 1 to 3; found 0"),
        ("T1.c1", "x = -1\ny = 1", "line 17: fault[0].x: ", "found -1"),
        ("T1.1", "to = -2", "line 17: fault[0].to: ", "0 or more; found -2"),
    ],
)
def test_nobody_is_moved_off_the_floor(tmp_path: Path, target: str, where: str, place: str, expected: str) -> None:
    text = GOOD.replace('kind = "break"\ntarget = "T1.c1"', f'kind = "move"\ntarget = "{target}"\n{where}')
    refused(tmp_path, text, place, expected)


@pytest.mark.parametrize("kind", ['"stop"', '"deadline"\nunits = 9'])
def test_who_is_conducted_is_not_stopped_and_keeps_no_deadline(tmp_path: Path, kind: str) -> None:
    text = GOOD.replace('kind = "break"\ntarget = "T1.c1"', f'target = "T1"\nkind = {kind}')
    refused(tmp_path, text, "line 16: fault[0].kind: ", "is for teams that act for themselves")


def test_overrides_reach_every_key(tmp_path: Path) -> None:
    read = scenario(
        tmp_path,
        GOOD,
        "seed=9",
        "teams.T1.workers.0.at=[2, 3]",
        "fault.0.at_step=7",
        "clock.mode=realtime",
        "limits.wall_s=5",
        "floor.width=6",
    )
    assert read.seed == 9
    assert read.setup["teams"]["T1"]["workers"][0]["at"] == [2, 3]
    assert read.setup["floor"] == {"width": 6}
    assert read.faults[0].at_step == 7
    assert read.clock.option() == "realtime:1"
    assert read.limits.wall_s == 5


@pytest.mark.parametrize(
    ("assignment", "expected"),
    [
        ("seed", "expected key=value"),
        ("=3", "expected key=value"),
        ("fault.9.at_step=1", "there is no fault.9"),
        ("fault.9=1", "fault is a list of 2"),
        ("seed.x=1", "seed is 3, which has no keys"),
        ("seed.x.y=1", "there is no seed.x"),
        ("seed=[1", "expected a TOML value"),
    ],
)
def test_wrong_overrides_are_refused(tmp_path: Path, assignment: str, expected: str) -> None:
    table, _ = read(written(tmp_path, GOOD))
    with pytest.raises(InputError, match=expected):
        override(table, assignment)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("factory/nothing", r"neither a file nor a shipped scenario\. muster list tells them all$"),
        ("factory/one_workr", r"Did you mean factory/broken_worker or factory/one_worker\? muster list"),
        ("nowhere/four_teams.toml", r"Did you mean factory/four_teams\? muster list"),
        ("broken_carr", r"Did you mean factory/broken_carrier\? muster list"),
        (str(Path(__file__).parent), r": a directory; expected a file, or a shipped scenario"),
    ],
)
def test_a_scenario_that_does_not_exist_is_told_with_those_of_like_names(name: str, expected: str) -> None:
    with pytest.raises(InputError, match=expected):
        load(name)


def test_a_mark_before_the_first_line_is_no_part_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "marked.toml"
    file.write_text(GOOD, encoding="utf-8-sig")
    assert load(str(file)).story


def test_what_is_no_text_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "noise.toml"
    file.write_bytes(b"\xd1\xff")
    with pytest.raises(InputError, match="not a text in UTF-8"):
        load(str(file))


def test_an_unknown_table_is_told_with_all_that_could_stand_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"sead: expected one of the keys clock, .*floor, .*seed, .*found 'sead'"):
        load(str(written(tmp_path, GOOD)), ["sead=3"])


def test_lines_of_keys() -> None:
    assert line_of(GOOD, ["seed"]) == 3
    assert line_of(GOOD, ["teams", "T1", "workers", "0", "at"]) == 10
    assert line_of(GOOD, ["fault", "1", "target"]) == 21
    assert line_of(GOOD, ["nothing"]) == 0


def test_parse_leaves_its_argument_alone(tmp_path: Path) -> None:
    table, text = read(written(tmp_path, GOOD))
    before = str(table)
    parse(table, tmp_path / "test.toml", text)
    assert str(table) == before
