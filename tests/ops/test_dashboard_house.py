"""A house in the dashboard: drawn to scale at every size, with who does what, and never falling over odd data."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from time import process_time

import pytest
from msgspec.structs import replace

from bus.events import KINDS
from bus.messages import BodyFrame, Envelope, Event, Frame, Status
from ops.dashboard import Model, render, update
from ops.dashboard.house import draw, remaining, room
from ops.dashboard.model import TONES
from ops.dashboard.rooms import arranged
from ops.recording import Writer
from tests.ops.pictures import folded, picture
from tests.ops.synthetic_house import ROOMS, said, scene, told
from tests.ops.terminal import Terminal

SIZES = [(80, 24), (120, 40), (160, 50), (200, 60)]


@lru_cache
def made_up(rooms: int = 3) -> Model:
    return folded(told(rooms))


@pytest.mark.parametrize(("width", "height"), [*SIZES, (40, 12), (63, 17), (131, 29), (300, 90)])
@pytest.mark.parametrize("rooms", [1, 2, 3])
def test_every_size_is_filled_exactly(rooms: int, width: int, height: int) -> None:
    picture(made_up(rooms), width, height)
    picture(made_up(rooms), width, height, focus="T1", note="paused")
    picture(folded([scene(rooms)]), width, height)


GOLDEN = """\
 muster  made-up  three rooms                                            21.0 s
 coordinator waiting for the rooms
 ⢀⣀⣀⣀⣀⣀⣀⣀ ↑ki⢀⣀⣀⣀⣀⣀⣀⡀⢀ T3 living_room ⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⣀⡀⢀⣀⣀⣀⣀⣀⣀⣀ ↑li⢀⣀⣀⣀⣀⣀⣀⡀
 ⢸       ::::  ⣀    ⡇⢸         ⢀⣀⡀                        ⡇⢸   ⠄ ⠠ ::::       ⡇
 ⢸           ⢀⣾⡿⠃   ⡇⢸         ⣾sofa⣷⣶⡆                   ⡇⢸r1=pan            ⡇
 ⢸          ⠘⢿⠟     ⡇⢸         ⠉⠉⠛⠛⠛⠿⠿⠃            ·······⡇⢸  ⢠⣥⣀⣬⡄r2=pan     ⡇
 ⢸⣗r1=pillow_1⠐   ::⠁⠈::         ⣀⣀⣀⡀              ·······⡇⠈:: ⠉ ⠉   anna⠚⠃   ⡇
 ⢸⣗bed⢕⡆⢀⡀  »r2⠨⣶···→←::         ⠷⠵⠵⠇              ·······⡇←······⢀⣀⣀⣀⣀⣀⣀     ⡇
 ⢸ ⠉⠑⠓⠽ ⠙⠃⠂⠠ ⡀⢀·····⡄⢠::                           ·······⡇⢠······⢸table⢽     ⡇
 ⢸           ···⠁···⡇⢸              ⠙ novel_1      ·······⡇⢸······⠘⠓⠓⠓⠓⠓⠛     ⡇
 ⢸           ·······⡇⢸                                    ⡇⢸·······           ⡇
 ⢸           ·······⡇⢸                         ::::       ⡇⢸·······           ⡇
 ⠈ T1 bedroom ⠉⠉⠉⠉⠉⠉⠁⠈⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉ ↓ki⠈⠉⠉⠉⠉⠉⠉⠁⠈ T2 kitchen ⠉⠉⠉⠉⠉⠉⠁
 ● T1            7/25 ━━────  executing step 2  goto(r1…  » r2 of T3 helps here
 ● T2           22/25 ━━━━━─  executing step 2  goto(r1,6,2)
 ● T3            7 units      waiting                 » r1 helps in the bedroom"""


def test_a_house_looks_like_this() -> None:
    lines = [line.rstrip() for line in picture(made_up(), 80, 24)]
    assert "\n".join(lines[: len(GOLDEN.splitlines())]) == GOLDEN


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_everybody_and_everything_is_told_at_every_promised_size(width: int, height: int) -> None:
    text = "\n".join(picture(made_up(), width, height))
    for sign in ("r1=pillow", "r1=pan", "r2=pan", "»r2", "anna", "novel", "bed", "sofa", "table"):
        assert sign in text
    for words in ("» r2 of T3 helps here", "» r1 helps in the bedroom", " 7/25 ━", "22/25 ━", "7 units", "too heavy",
                  "bedroom", "kitchen", "living_room", "door", "helper", "q quit"):  # fmt: skip
        assert words in text
    assert "step 3" not in text.splitlines()[0]  # every team counts steps of its own


@pytest.mark.parametrize(("width", "height", "own", "next_door"), [(80, 24, 7, 2), (160, 50, 12, 4)])
def test_areas_are_told_apart_and_explained(width: int, height: int, own: int, next_door: int) -> None:
    """Of the bedroom, in the south-east its own; in the north and in the east those for the rooms next door."""
    lines = picture(folded([scene(3)]), width, height)
    rows = [line[: line.index("⡇") if "⡇" in line else 0] for line in lines]
    assert any(row.endswith("·" * own) for row in rows)
    assert any(line[: width // 3].count(":" * next_door) == 1 for line in lines)
    assert "· own : next door" in " ".join(lines[-2:])
    bare = replace(scene(3), workspaces=tuple(replace(space, store=None, doors={}) for space in ROOMS))
    assert not {"own", "next"} & set(" ".join(picture(folded([bare]), width, height)[-2:]).split())


def test_a_plan_is_shown_around_its_current_step() -> None:
    text = "\n".join(picture(made_up(1), 80, 24))
    assert "▶  2 goto(r1,6,2)" in text
    assert "  3 detach(r1)" in text
    assert "executing step 2  goto(r1" in "\n".join(picture(made_up(3), 80, 24))


def test_without_place_for_a_picture_there_is_a_line_a_team() -> None:
    rows = picture(made_up(), 63, 17)
    assert [row.split()[1] for row in rows[2:5]] == ["T1", "T2", "T3"]
    assert "22/25" in rows[3]
    assert "and 2 more teams" in picture(made_up(), 40, 12)[3]


def test_before_the_first_frame_everybody_is_where_the_scene_says() -> None:
    views = arranged(tuple(room(space) for space in ROOMS[:1]), 60, 24).views
    start = folded([scene(1)])
    moved = folded([said("world", Frame(0.0, 0, (BodyFrame("T1.r1", "r1", "robot", "T1", 4.5, 6.5),
                                                 BodyFrame("T1.pillow_1", "pillow_1", "thing", "T1", 1.5, 2.5))))],
                   start)  # fmt: skip
    assert [line.plain for line in draw(start, views)] == [line.plain for line in draw(moved, views)]


def test_what_is_left_of_a_way_begins_where_the_robot_is() -> None:
    way = [(0.5, 0.5), (0.5, 4.5), (6.5, 4.5)]
    assert remaining(way, (0.5, 0.5)) == [(0.5, 0.5), (0.5, 4.5), (6.5, 4.5)]
    assert remaining(way, (0.6, 2.0)) == [(0.6, 2.0), (0.5, 4.5), (6.5, 4.5)]
    assert remaining(way, (3.0, 4.5)) == [(3.0, 4.5), (6.5, 4.5)]
    assert remaining(way[:1], (3.0, 4.5)) == []


def test_time_that_has_run_out_is_told() -> None:
    late = update(made_up(1), replace(said("T1", Status("team", "going on", elapsed=27, deadline=25)), seq=2))
    assert any("27/25" in line and "deadline missed" in line for line in picture(late, 80, 24))


def test_time_goes_on_while_a_team_thinks_and_stands_when_it_is_finished() -> None:
    later = update(made_up(), said("world", Frame(40.0, 4, ()), at_s=40.0))
    text = "\n".join(picture(later, 160, 50))
    assert "14/25 ━" in text  # of three seconds each
    assert " 7 units" in text


def test_who_was_done_in_time_stays_so_while_its_robot_helps() -> None:
    done = folded([said("T2", Event("team_finished", {"team": "T2"}), at_s=70.0)], made_up())
    later = update(done, said("world", Frame(90.0, 9, ()), at_s=90.0))
    again = update(later, said("T2", Event("team_finished", {"team": "T2"}), at_s=91.0))
    for model in (later, again):
        text = "\n".join(picture(model, 160, 50))
        assert "24/25 ━" in text
        assert text.count("deadline missed") == 1  # T1's
    busy = update(later, said("T2", Event("plan_adopted", {"team": "T2"}), at_s=92.0))
    assert "\n".join(picture(busy, 160, 50)).count("deadline missed") == 2


def test_who_is_between_two_rooms_is_told() -> None:
    away = said("world", Frame(1.0, 1, (BodyFrame("T1.r1", "r1", "robot", "bench", 0.0, 0.0),)))
    for width, height in SIZES:
        before, after = (picture(model, width, height) for model in (made_up(), update(made_up(), away)))
        assert any(line.startswith(" hallway r1 of T1 under way") for line in after)
        titles = [[i for i, line in enumerate(lines) if " T2 kitchen " in line] for lines in (before, after)]
        assert titles[0] == titles[1]  # the picture stays


def test_a_broken_robot_is_marked() -> None:
    broken = said("world", Frame(1.0, 1, (BodyFrame("T1.r1", "r1", "robot", "T1", 3.0, 3.0, broken=True),)))
    assert any("r1✗" in line for line in picture(update(made_up(), broken), 80, 24))


def test_what_teams_say_of_trouble_and_help_has_its_tone() -> None:
    assert set(TONES) <= set(KINDS)
    told_of = [("heavy_object", "cause"), ("new_way", "recovery"), ("help_wanted", "recovery"), ("set_aside", "fault")]
    model = folded([said("T1", Event(kind, {"team": "T1", "text": kind})) for kind, _ in told_of], made_up())
    assert [(note.kind, note.tone) for note in model.events[-4:]] == told_of
    found = update(model, said("T1", Event("robot_broken", {"team": "T1", "robot": "r2", "text": "x"})))
    assert found.suspects == {("T1", "r2"): "broken"}
    assert any("r2?" in line for line in picture(found, 160, 50))


FAR = tuple((x, y) for x in (-1e9, 0.0, 1e9) for y in (-1e9, 4.0, 1e9))
ODD = [
    said("world", Frame(1.0, 1, tuple(BodyFrame(f"T1.r{i}", f"r{i}", "robot", "T1", *at) for i, at in enumerate(FAR)))),
    said("T1", Status("team", "x" * 999, ways={f"r{i}": FAR for i in range(9)}, elapsed=10**9, deadline=1)),
    said("T1", Status("team", "", ways={"r1": (), "r2": ((1.0, 1.0),), "nobody": FAR}, helping="y" * 1999)),
    said("world", Frame(1.0, 1, (BodyFrame("b", "b" * 64, "no such kind", "T1", 1.0, 1.0, coupled_to="((,"),))),
    said("world", Frame(1.0, 1, tuple(BodyFrame(f"T1.{i}", f"thing_{i}", "thing", "T1", 3.0, 3.0) for i in range(99)))),
]


def test_odd_data_breaks_nothing() -> None:
    model = made_up()
    for number, message in enumerate(ODD, 2):
        assert isinstance(message, Envelope)
        model = update(model, replace(message, seq=number), 1.0)
        for width, height in ((80, 24), (160, 50)):
            picture(model, width, height)


def test_a_terminal_without_unicode_gets_ascii() -> None:
    assert render(made_up(), 80, 24, ascii_only=True).plain.isascii()


def test_drawing_is_quick() -> None:
    model = made_up()
    render(model, 200, 60)
    start_s = process_time()
    for _ in range(10):
        render(model, 200, 60)
    assert (process_time() - start_s) / 10 < 0.05


def test_a_replay_in_a_terminal_survives_resizing_and_leaves_it_clean(tmp_path: Path) -> None:
    writer = Writer(tmp_path / "run.mcap")
    for message in told():
        if isinstance(message, Envelope):
            writer.add(type(message.body).__name__.lower(), message)
        else:
            writer.add("scene", message)
    writer.close()
    terminal = Terminal(f"from ops.replay import replay; replay({str(tmp_path)!r})", 80, 24)
    try:
        assert terminal.until(lambda: b"r1=pan" in terminal.seen), terminal.seen[-3000:]
        small = len(terminal.seen)
        terminal.resize(160, 50)
        assert terminal.until(lambda: b"answer ms" in terminal.seen[small:]), terminal.seen[-3000:]
        terminal.resize(30, 8)
        assert terminal.until(lambda: b"too small" in terminal.seen), terminal.seen[-3000:]
        terminal.process.terminate()
        terminal.must_end_clean()
    finally:
        terminal.close()
