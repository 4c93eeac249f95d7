"""The pages that one types along do what they say: their commands are run in order, with the exit codes that they tell,
and every line of output that they show still comes. Numbers may change with the plan that is found and with the
machine; words may not."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from ops.children import environment
from tests.ops.terminal import ENTER, Terminal

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]

ROOT = Path(__file__).resolve().parents[2]
PAGES = ("tutorial", "howto-scenario")
BLOCK = re.compile(r"^```(\w+) ?(\S*)\n(.*?)^```$", re.M | re.S)
DEMO = "muster run factory/broken_carrier --clock realtime:4"
LEFT_OUT = "…"
LIVE = "step 2"  # the live run is disturbed when it is that far


class Typed(NamedTuple):
    """A command, what it is shown to print, and the exit code that it is to have. `where`: which terminal."""

    command: str
    shown: list[str]
    code: int
    where: str


def text_of(page: str) -> str:
    return (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")


def typed(page: str) -> list[Typed]:
    """All that a reader types, in order."""
    found: list[Typed] = []
    for language, where, body in BLOCK.findall(text_of(page)):
        if language != "console":
            continue
        for part in re.split(r"^\$ ", body, flags=re.M)[1:]:
            command, *shown = part.splitlines()
            if command == "echo $?":
                found[-1] = found[-1]._replace(code=int(shown[0]))
            else:
                found.append(Typed(command, [line for line in shown if line not in ("", LEFT_OUT)], 0, where))
    return found


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A reader's empty directory, and `muster` on the path."""
    for name, value in environment().items():
        monkeypatch.setenv(name, value)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "muster").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m ops.cli "$@"\n')
    (tmp_path / "bin" / "muster").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "runtime"))
    desk = tmp_path / "desk"
    desk.mkdir()
    monkeypatch.chdir(desk)
    return desk


@pytest.mark.parametrize("page", PAGES)
def test_the_page_does_what_it_says(page: str, desk: Path) -> None:
    for language, name, body in BLOCK.findall(text_of(page)):
        if language == "toml" and name:
            (desk / name).write_text(body)
    lines = typed(page)
    assert sum("muster" in line.command for line in lines) > 6
    live: tuple[Typed, subprocess.Popen[str], str] | None = None
    for line in lines:
        if live is not None and line.where != "second":
            _end(*live)
            live = None
        if line.where == "first":
            live = (line, *_begin(line))
        elif line.command.split()[:2] in (["muster", "watch"], ["muster", "replay"]):
            _look(line.command)
        elif not line.command.startswith(". ") and (line.command != "make demo" or line.shown):
            done = subprocess.run(
                ["bash", "-c", _hurried(line.command)], capture_output=True, text=True, timeout=400, check=False
            )
            _compare(line, done.stdout + done.stderr, done.returncode)
    assert live is None


def test_the_demo_of_the_tutorial_is_the_demo() -> None:
    recipe = (ROOT / "Makefile").read_text(encoding="utf-8").partition("\ndemo:")[2].splitlines()[1]
    assert recipe.strip().replace("$(BIN)/", "") == DEMO
    assert DEMO in text_of("tutorial")


def _hurried(command: str) -> str:
    """The command as it is run here: without a terminal, and without waiting for the wall."""
    if command == "make demo":
        command = DEMO
    if command.startswith("muster run"):
        return re.sub(r" --clock \S+", "", command) + " --headless"
    return command


def _begin(line: Typed) -> tuple[subprocess.Popen[str], str]:
    """Start the live run and read it until it is under way."""
    words = re.sub(r" --clock \S+", " --clock realtime:4", line.command).split()
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert process.stdout is not None
    said = ""
    for text in process.stdout:
        said += text
        if text.rstrip().endswith(LIVE):
            return process, said
    raise AssertionError(said)


def _end(line: Typed, process: subprocess.Popen[str], said: str) -> None:
    rest, _ = process.communicate(timeout=200)
    _compare(line, said + rest, process.returncode)


def _look(command: str) -> None:
    """Open a dashboard in a terminal and leave it with q."""
    terminal = Terminal(f"import sys; from ops.cli import main; sys.exit(main({command.split()[1:]!r}))", 100, 30)
    try:
        assert terminal.until(lambda: ENTER in terminal.seen and b"T1" in terminal.seen, 60.0), terminal.seen[-2000:]
        os.write(terminal.master, b"q")
        terminal.must_end_clean()
    finally:
        terminal.close()


def _compare(line: Typed, printed: str, code: int) -> None:
    assert code == line.code, f"$ {line.command}\n{printed}"
    there = {_plain(text) for text in printed.splitlines()}
    for shown in line.shown:
        wanted = re.compile(re.escape(_plain(shown)).replace(re.escape(LEFT_OUT), ".*"))
        assert any(wanted.fullmatch(text) for text in there), f"$ {line.command}\nno longer prints: {shown}\n{printed}"


def _plain(text: str) -> str:
    """Without what may change: numbers that are no part of a name, and which of several shortest plans was found."""
    if text.startswith("optimal:"):
        return text
    text = re.sub(r"^( +\d+)  [a-z]+\w*\(.*|^( +\d+)  lineShift.*", r"\1\2 actions", text)
    return re.sub(r" +", " ", re.sub(r"(?<![A-Za-z\d])\d+(\.\d+)*", "#", text)).strip()
