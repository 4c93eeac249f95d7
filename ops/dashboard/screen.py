"""The terminal: a full screen that is drawn a few times a second, read for keys, and always given back clean."""

from __future__ import annotations

import contextlib
import os
import select
import sys
import termios
import threading
import tty
from collections.abc import Callable, Iterator
from typing import NamedTuple

from rich.console import Console
from rich.live import Live

from ops.dashboard.layout import KEYS, render
from ops.dashboard.model import Model

PAUSE_S = 0.1
BUSY_TURNS, IDLE_TURNS = 2, 10
"""Turns between two pictures while things change, and while they do not. A key or a new size is answered at once."""
ESCAPES = {"\x1b[A": "up", "\x1b[B": "down", "\x1b[C": "right", "\x1b[D": "left", "\x1b": "escape", "\t": "tab"}


class Picture(NamedTuple):
    """What is to be on the screen now. `note` stands beside the clock; `over` ends the show."""

    model: Model
    note: str = ""
    over: bool = False


Turn = Callable[[list[str]], Picture]
"""Called about ten times a second with the keys that were pressed; returns what to show."""


def show(turn: Turn, stop: threading.Event, *, keys: str = KEYS, console: Console | None = None) -> Model:
    """Show what `turn` returns until it says that it is over, ``q`` is pressed, or `stop` is set; the last model.

    Needs a terminal on standard output. The terminal is restored by whatever way this is left.
    """
    # COLUMNS and LINES would pin rich to one size; the terminal's own answer follows a resize.
    environment = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "LINES")}
    console = console or Console(_environ=environment)
    ascii_only = not (console.encoding or "").lower().startswith("utf")
    focus, waited, urgent = "", 0, True
    scene = turn([])
    drawn: tuple[Model, str] | None = None
    size = console.size
    with keyboard() as read, Live(console=console, screen=True, auto_refresh=False) as live:
        while True:
            urgent = urgent or size != console.size or scene.over
            changed = drawn is None or drawn[0] is not scene.model or drawn[1] != scene.note
            if urgent or waited >= (BUSY_TURNS if changed else IDLE_TURNS):
                size = console.size
                picture = render(scene.model, size.width, size.height, focus=focus, note=scene.note, keys=keys,
                                 ascii_only=ascii_only)  # fmt: skip
                live.update(picture, refresh=True)
                drawn, waited, urgent = (scene.model, scene.note), 0, False
            pressed = read(PAUSE_S, stop)
            waited += 1
            if stop.is_set() or scene.over or "q" in pressed:
                return scene.model
            for key in pressed:
                focus = focused(key, focus, scene.model.teams)
            urgent = bool(pressed)
            scene = turn(pressed)


def focused(key: str, focus: str, teams: tuple[str, ...]) -> str:
    """The team to show alone after a key: tab goes round, a digit picks, 0 and escape show all again."""
    if key == "tab":
        ring = ("", *teams)
        return ring[(ring.index(focus) + 1) % len(ring)] if focus in ring else ""
    if key in ("escape", "0"):
        return ""
    if key.isdigit():
        return teams[int(key) - 1] if int(key) <= len(teams) else focus
    return focus


Read = Callable[[float, threading.Event], list[str]]


@contextlib.contextmanager
def keyboard() -> Iterator[Read]:
    """Keys one by one and unechoed, if standard input is a terminal; otherwise there are none."""
    if not sys.stdin.isatty():
        yield _nothing
        return
    fd = sys.stdin.fileno()
    before = termios.tcgetattr(fd)
    try:
        tty.setcbreak(fd)
        attributes = termios.tcgetattr(fd)
        attributes[6][termios.VSUSP] = b"\0"  # ctrl-z would leave the shell on the alternate screen
        termios.tcsetattr(fd, termios.TCSANOW, attributes)
        yield lambda wait_s, stop: _keys(fd, wait_s)
    finally:
        with contextlib.suppress(termios.error):  # the terminal itself may be gone
            termios.tcsetattr(fd, termios.TCSADRAIN, before)


def _nothing(wait_s: float, stop: threading.Event) -> list[str]:
    stop.wait(wait_s)
    return []


def _keys(fd: int, wait_s: float) -> list[str]:
    ready, _, _ = select.select([fd], [], [], wait_s)
    if not ready:
        return []
    data = os.read(fd, 64)
    if not data:  # the terminal hung up
        return ["q"]
    return split_keys(data.decode(errors="replace"))


def split_keys(text: str) -> list[str]:
    """Characters and escape sequences by name; unknown sequences are dropped."""
    out: list[str] = []
    while text:
        known = next((code for code in ESCAPES if text.startswith(code)), None)
        if known == "\x1b" and len(text) > 1:
            end = next((i for i, c in enumerate(text[2:], 2) if c.isalpha() or c == "~"), len(text) - 1)
            text = text[end + 1 :]
            continue
        out.append(ESCAPES[known] if known else text[0])
        text = text[len(known) if known else 1 :]
    return out
