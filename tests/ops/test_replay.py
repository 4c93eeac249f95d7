"""Replays: the player's time, and a real terminal (a pseudo one) that is resized, interrupted, and found clean."""

from __future__ import annotations

import os
import signal
import termios
from collections.abc import Iterator
from pathlib import Path

import pytest

from ops.recording import Writer
from ops.replay import Player, step_times
from tests.ops.synthetic import recording
from tests.ops.terminal import ENTER, HIDE, Terminal


def test_a_player_steps_forward_and_back_and_pauses() -> None:
    player = Player(recording(2), speed=1 / 64)
    start = player.turn([]).model
    assert start.scene is not None
    assert player.turn(["right"]).model.step == 1
    assert player.turn(["right", "right"]).model.step == 3
    back = player.turn(["left"])
    assert (back.model.step, back.note) == (2, "paused")
    assert player.turn([" "]).note == "replay x0.015625"
    assert player.turn(["up"]).note == "replay x0.03125"


def test_a_player_gets_to_the_end_and_stays() -> None:
    player = Player(recording(2), speed=1e9)
    player.turn([])
    picture = player.turn([])
    assert picture.note == "end of the recording"
    assert picture.model.over is not None
    assert player.turn([]).model is picture.model


def test_speed_must_be_positive() -> None:
    with pytest.raises(ValueError, match="greater than 0"):
        Player(recording(1), speed=0.0)


def test_steps_are_found_by_their_beginnings() -> None:
    times = step_times(recording(2, 5).everything())
    assert times == [0.0, 2.0, 4.0, 6.0, 8.0]


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[Terminal]:
    writer = Writer(tmp_path / "run.mcap")
    run = recording(4)
    assert run.scene is not None
    writer.add("scene", run.scene)
    for stream, envelopes in (("event", run.events), ("status", run.statuses), ("frame", run.frames)):
        for envelope in envelopes:
            writer.add(stream, envelope)
    writer.close()
    terminal = Terminal(f"from ops.replay import replay; replay({str(tmp_path)!r}, 4.0)", 80, 24)
    try:
        yield terminal
    finally:
        terminal.close()


@pytest.mark.parametrize("end", ["SIGINT", "SIGTERM", "q", "ctrl-c"])
def test_a_terminal_is_given_back_clean(terminal: Terminal, end: str) -> None:
    assert terminal.until(lambda: b"move(" in terminal.seen), terminal.seen
    assert terminal.seen.index(ENTER) < terminal.seen.index(b"move(")
    assert HIDE in terminal.seen
    assert termios.tcgetattr(terminal.slave)[3] & termios.ECHO == 0
    small = len(terminal.seen)
    terminal.resize(160, 50)
    assert terminal.until(lambda: "processes ──".encode() in terminal.seen[small:] or terminal.widest(small) > 100)
    if end == "q":
        os.write(terminal.master, b"q")
    elif end == "ctrl-c":
        os.write(terminal.master, b"\x03")
    else:
        terminal.process.send_signal(getattr(signal, end))
    terminal.must_end_clean()
