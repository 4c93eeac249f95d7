"""The dashboard's picture: fits exactly at every size, tells what is going on, and never falls over odd data."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from time import process_time

import msgspec
import pytest
from rich.cells import cell_len

from bus.messages import Beat, BodyFrame, Envelope, Event, Exchange, Frame, Status
from ops.dashboard import Model, render, update
from ops.dashboard.panels import bench
from ops.dashboard.screen import focused, split_keys
from ops.dashboard.text import clean, wrapped
from tests.ops.pictures import folded, picture
from tests.ops.synthetic import scene, story

SIZES = [(80, 24), (120, 40), (160, 50), (200, 60)]


@lru_cache
def made_up(teams: int, steps: int = 18) -> Model:
    return folded(story(teams, steps))


def said(source: str, body: object, at_s: float = 1.0) -> Envelope:
    return Envelope(1, "r", source, 1, 1, "i", at_s, body)  # type: ignore[arg-type]


def event(kind: str, source: str = "T1", **data: object) -> Envelope:
    return said(source, Event(kind, data))


@pytest.mark.slow
@pytest.mark.parametrize(("width", "height"), [*SIZES, (40, 12), (63, 17), (131, 29), (300, 90)])
@pytest.mark.parametrize("teams", [0, 1, 2, 3, 4, 5, 8, 23])
def test_every_size_is_filled_exactly(teams: int, width: int, height: int) -> None:
    model = made_up(teams) if teams else Model()
    picture(model, width, height)
    picture(model, width, height, focus="T1", note="paused")
    picture(folded([], model), width, height, focus="no such team")


@pytest.mark.parametrize(("width", "height"), [(1, 1), (10, 3), (39, 24), (80, 5), (0, 0)])
def test_a_terminal_that_is_too_small_is_told(width: int, height: int) -> None:
    lines = render(made_up(4), width, height).plain.split("\n")
    assert all(cell_len(line) <= width for line in lines)
    assert len(lines) <= max(height, 1)


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_four_teams_are_drawn_at_every_promised_size(width: int, height: int) -> None:
    text = "\n".join(picture(made_up(4), width, height))
    for sign in ("T1 executing", "T2 executing", "T3 executing", "T4 executing", "c1=w2s", "[2p]", "░░░", "▶ 17"):
        assert sign in text
    for words in ("under way T3→T4, there at step 18", "27 steps, proved shortest", "31 questions", "c1 is broken",
                  "pit stop", "painter/painted", "step 17", "q quit"):  # fmt: skip
        assert words in text


GOLDEN = """\
 muster  made-up  factory/four_teams                          20.0 s  step 9/27
 coordinator conducting step 9 · 27 steps, proved shortest · 31 questions
┌─ ● T1 executing step 9 ─────────────────────────────────── 1 raw  3 painted ─┐
│════════════[1p]════[2r]════[3p]════[4p]═══    7 -                            │
│  ┌───────┬───────┬───────┬───────┬───────┐    8 move(c1,right)  workOn(w1,4) │
│3 │░░░░░░░│   ·   │   ·   │  w1p  │   ·   │ ▶  9 move(w1,left)                │
│  ├───────┼───────┼───────┼───────┼───────┤   10 move(w1,left)                │
│2 │░░░░░░░│   ·   │   ·   │   ·   │   ·   │   11 workOn(w1,2)                 │
│  ├───────┼───────┼───────┼───────┼───────┤   12 move(w1,left)                │
│1 │░░░░░░░│  c1   │   ·   │   ·   │   ·   │   13 move(w1,left)  takeRobot(w2,…│
│  └───────┴───────┴───────┴───────┴───────┘   14 move(c1,up)  swapEndEffector…│
│                                              15 move(w1,right)  move(w2,righ…│
 bench empty"""


def test_one_team_looks_like_this() -> None:
    lines = [line.rstrip() for line in picture(made_up(1, 10), 80, 24)]
    assert "\n".join(lines[: len(GOLDEN.splitlines())]) == GOLDEN


def test_what_is_broken_or_suspected_is_marked() -> None:
    events = list(story(4, 27))
    broken = next(i for i, m in enumerate(events) if isinstance(m, Envelope) and isinstance(m.body, Event)
                  and m.body.kind == "fault_injected")  # fmt: skip
    told = next(i for i, m in enumerate(events) if isinstance(m, Envelope) and isinstance(m.body, Event)
                and m.body.kind == "diagnosis")  # fmt: skip
    unseen = "\n".join(picture(folded(events[: broken + 2]), 160, 50))
    assert "c1✗" in unseen
    assert "w1?" not in unseen
    suspected = "\n".join(picture(folded(events[: told + 1]), 160, 50))
    assert "c1✗" in suspected
    assert "w1?" in suspected  # the letter of its tool gives way in a full cell
    cleared = "\n".join(picture(folded(events), 160, 50))
    assert "✗ broken" in cleared
    assert "c1✗" not in cleared
    assert "w1?" not in cleared


def test_suspicion_follows_the_explanations_that_are_left() -> None:
    doubt = event("diagnosis", "T1", causes=[["broken(c1)"], ["broken(w1)", "moved(w2)"]])
    model = folded([doubt])
    assert model.suspects == {("T1", "c1"): "suspected", ("T1", "w1"): "suspected"}
    found = update(model, event("inspection", "T1", robot="c1", finding="broken"))
    assert found.suspects == {("T1", "c1"): "broken"}  # the other explanation would not need it
    assert update(found, event("repair", "T1", robot="c1")).suspects == {}
    cleared = update(model, event("inspection", "T1", robot="c1", finding="sound"))
    assert cleared.suspects == {("T1", "w1"): "broken"}
    assert update(model, event("plan_adopted", "T1", team="T1")).suspects == {}


def test_a_wet_box_and_a_lost_process_are_marked() -> None:
    model = made_up(2, 10)
    assert model.frame is not None
    wet = [msgspec.structs.replace(b, attributes={"stage": 1, "wet": 1}) if b.id == "T1.1" else b
           for b in model.frame.bodies]  # fmt: skip
    model = folded([said("world", Frame(20.0, 9, tuple(wet))), event("contact", "world", name="T2",
                                                                    state="lost_contact")], model)  # fmt: skip
    text = "\n".join(picture(model, 120, 40))
    assert "[1p~]" in text
    assert "○ T2 lost contact" in text
    text = "\n".join(picture(update(model, event("contact", "world", name="T2", state="back")), 80, 24))
    assert "lost contact" not in text


def test_a_silent_process_is_told_and_rates_are_per_second() -> None:
    beats = [(0.0, 100), (1.0, 350), (6.0, 350)]
    model = Model()
    for clock_s, sent in beats[:2]:
        model = update(model, said("T1", Beat(7, sent=sent, received=2 * sent, latency_ms=0.25)), clock_s)
    pulse = model.pulses["T1"]
    assert (pulse.sent_per_s, pulse.received_per_s) == (250.0, 500.0)
    later = update(model, said("T2", Beat(8)), 6.0)
    assert any("silent for 5 s" in line for line in picture(later, 160, 50))


def test_questions_are_listed_until_something_else_happens() -> None:
    asked = [event("question", "coordinator", text=f"question {i}") for i in range(9)]
    model = folded([event("search_started", text="begins"), *asked])
    assert [n.text for n in model.events] == ["begins", "question 7", "question 8"]
    model = folded([event("shared_plan", text="found")], model)
    assert [n.text for n in model.events] == ["begins", "found"]
    assert model.recorded == 11


def test_the_verdict_is_shown_at_the_end() -> None:
    assert "GOAL REACHED  27 steps, 1 replan · all teams are done" in picture(made_up(4, 27), 80, 24)[1]
    lost = folded([event("run_over", "coordinator", goal=False, reason="no painter", makespan=0, replans=0)])
    assert "GOAL NOT REACHED" in picture(lost, 80, 24)[1]
    assert "no painter" in picture(lost, 80, 24)[1]


def test_the_search_is_told_while_it_goes_on() -> None:
    """What is proved, what is found and what lies between, within the narrowest screen that is promised."""
    asking = Status("coordinator", "asking about 23 steps", bound=20, questions=35)
    for best, words in ((-1, "no plan yet, at least 20"), (27, "best 27, at least 20, gap 7")):
        model = folded([said("coordinator", msgspec.structs.replace(asking, best=best))])
        assert f"asking about 23 steps · {words} · 35 questions" in picture(model, 80, 24)[1]
    model = folded([said("coordinator", msgspec.structs.replace(asking, best=27, bound=27))])
    assert "27 steps, proved shortest" in picture(model, 80, 24)[1]
    conducting = Status("coordinator", "conducting", bound=22, best=22, questions=43)
    later = Status("T1", "executing", step=15, start=15, plan=(("lineShift",),) * 22)
    model = folded([said("coordinator", conducting), said("T1", later)])
    told = " coordinator conducting · 22 steps from step 15, proved shortest · 43 questions"
    assert picture(model, 80, 24)[1].rstrip() == told


def test_that_a_person_is_needed_stands_out() -> None:
    text = "a person is needed: T1 died 6 times"
    model = folded([event("needs_person", "supervisor", cause="gave_up", text=text)], made_up(2))
    assert (model.events[-1].text, model.events[-1].tone) == (text, "fault")
    assert any(text in line for line in picture(model, 160, 50))


def test_one_of_many_teams_can_be_looked_at() -> None:
    teams = made_up(4).teams
    seen, focus = [], ""
    for _ in range(6):
        focus = focused("tab", focus, teams)
        seen.append(focus)
    assert seen == ["T1", "T2", "T3", "T4", "", "T1"]
    assert focused("3", "", teams) == "T3"
    assert focused("9", "T1", teams) == "T1"
    assert focused("escape", "T1", teams) == ""
    text = "\n".join(picture(made_up(4), 80, 24, focus="T3"))
    assert "T3 executing" in text
    assert "T1 executing" not in text


def test_keys_are_told_from_escape_sequences() -> None:
    assert split_keys("q") == ["q"]
    assert split_keys("\x1b[C\x1b[D \t1") == ["right", "left", " ", "tab", "1"]
    assert split_keys("\x1b") == ["escape"]
    assert split_keys("\x1b[5~q") == ["q"]


ODD = [
    event("diagnosis", causes="not a list"),
    event("diagnosis", causes=[["broken(c1)"], 7, None, [["x"]]]),
    event("contact", name=7, state=None),
    event("run_over"),
    event("plan_adopted", start="x", makespan=None),
    event("step_started", step="many"),
    event("refused", text="two\nlines\x1b[31m and \ttabs, 漢字, e\u0301"),
    event("what is this", source="x" * 64, text="y" * 1999),
    said("T1", Status("team", "z" * 1999, step=-1, start=10, plan=((), ("a" * 500,)))),
    said("T1", Status("team", "", step=10**9, start=-5, plan=(("a",),))),
    said("c", Status("coordinator", "?", bound=9, best=3, exchanges=(Exchange("w", "r", "A", -1, "B", 0, "w"),))),
    said("world", Frame(1e9, -1, (BodyFrame("b", "b", "no such kind", "T1", -1e6, 1e6, attributes={"stage": "?"}),))),
    said("world", Frame(1.0, 1, tuple(BodyFrame(f"{i}", f"w{i}", "worker", "T1", 2.0, 3.0) for i in range(9)))),
    said("T1", Beat(1, sent=2**40, latency_ms=1e12, refused=2**40)),
    scene(1),
]


@pytest.mark.parametrize("start", [Model(), made_up(2)], ids=["empty", "running"])
def test_odd_data_changes_little_and_breaks_nothing(start: Model) -> None:
    model = start
    for message in ODD:
        model = update(model, message, 1.0)
        for width, height in ((80, 24), (160, 50)):
            assert "\x1b" not in render(model, width, height).plain
            picture(model, width, height)


def test_a_terminal_without_unicode_gets_ascii() -> None:
    assert render(made_up(4), 80, 24, ascii_only=True).plain.isascii()


def test_texts_are_cut_to_their_place() -> None:
    assert wrapped("one two three four", 9, 2) == ["one two", "three fo…"]
    assert wrapped("push(c1) swap(w1,3)", 12, 2) == ["push(c1)", "swap(w1,3)"]
    assert wrapped("", 9, 2) == [""]
    assert wrapped("x" * 30, 10, 2) == ["x" * 10, "x" * 9 + "…"]
    assert clean("a\nb漢c\x07") == "a b?c?"


def test_drawing_is_quick() -> None:
    """A few pictures a second must be nothing: a third of a processor's tenth of a second each would be too much."""
    model = made_up(4)
    render(model, 160, 50)
    start_s = process_time()
    for _ in range(10):
        render(model, 160, 50)
    assert (process_time() - start_s) / 10 < 0.033


def test_several_robots_are_under_way_and_one_that_is_passed_on_has_its_next_way() -> None:
    model = made_up(4, 12)
    coordinator = model.coordinator
    assert coordinator is not None
    assert model.frame is not None
    exchanges = (
        Exchange("w3", "T2.w3", "T2", 3, "T1", 5, "w2"),
        Exchange("w2", "T2.w3", "T1", 11, "T2", 14, "w4"),
        Exchange("w1", "T3.w1", "T3", 11, "T4", 13, "w2"),
    )
    status = msgspec.structs.replace(coordinator, exchanges=exchanges)
    bodies = tuple(
        msgspec.structs.replace(b, place="bench") if b.id in ("T2.w3", "T3.w1") else b for b in model.frame.bodies
    )
    frame = msgspec.structs.replace(model.frame, bodies=bodies)
    text = bench(replace(model, statuses={**model.statuses, "coordinator": status}, frame=frame, step=12), 160).plain
    assert "under way T1→T2, there at step 14" in text
    assert "under way T3→T4, there at step 13" in text
