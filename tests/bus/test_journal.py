from __future__ import annotations

import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from bus.journal import REPLIES_KEPT, Journal


def test_incarnations_count_lives(tmp_path: Path) -> None:
    for life in (1, 2, 3):
        journal = Journal(tmp_path / "T1.sqlite")
        assert journal.incarnation == life
        journal.close()
    assert Journal().incarnation == 1


def test_entries_survive(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "T1.sqlite")
    journal.put("plan/1", b"a")
    journal.put("plan/2", b"b")
    journal.put("plan/2", b"c")
    journal.put("planet", b"")
    journal.put("other", b"d")
    journal.delete("plan/1")
    journal.delete("nothing")
    journal.close()
    journal.close()
    again = Journal(tmp_path / "T1.sqlite")
    assert again.get("plan/2") == b"c"
    assert again.get("plan/1") is None
    assert again.items("plan/") == [("plan/2", b"c")]
    assert [key for key, _ in again.items()] == ["other", "plan/2", "planet"]
    again.close()


def test_a_transaction_is_kept_whole_or_not_at_all() -> None:
    journal = Journal()
    done: list[str] = []

    def change(fails: bool) -> None:
        with journal.transaction():
            journal.put("a", b"new")
            journal.afterwards(lambda: done.append("outer"))
            with journal.transaction():
                journal.put("b", b"new")
                journal.afterwards(lambda: done.append("inner"))
            assert done == []
            if fails:
                raise RuntimeError("in the middle")

    with pytest.raises(RuntimeError, match="in the middle"):
        change(fails=True)
    assert (journal.get("a"), journal.get("b"), done) == (None, None, [])
    change(fails=False)
    assert (journal.get("a"), journal.get("b"), done) == (b"new", b"new", ["outer", "inner"])
    journal.afterwards(lambda: done.append("at once"))
    assert done[-1] == "at once"


def test_what_is_not_committed_is_gone_with_the_process(tmp_path: Path) -> None:
    life = """
import os, sys
from pathlib import Path
from bus.journal import Journal
journal = Journal(Path(sys.argv[1]))
journal.put("whole", b"kept")
with journal.transaction():
    journal.put("half", b"lost")
    os._exit(9)
"""
    path = tmp_path / "T1.sqlite"
    assert subprocess.run([sys.executable, "-c", life, str(path)], check=False).returncode == 9
    journal = Journal(path)
    assert journal.items() == [("whole", b"kept")]
    assert journal.incarnation == 2
    journal.close()


def test_two_processes_cannot_live_on_one_journal(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "T1.sqlite")
    with pytest.raises(sqlite3.OperationalError, match="locked"):
        Journal(tmp_path / "T1.sqlite", patience_s=0.05)
    journal.close()


def test_replies_are_remembered_but_not_for_ever() -> None:
    journal = Journal()
    journal.remember_reply("T1", "T1.1.1", b"first")
    for number in range(REPLIES_KEPT + 1000):
        journal.remember_reply("T2", f"T2.1.{number}", b"%d" % number)
    assert journal.reply_to("T1", "T1.1.1") == b"first", "another requester's flood does not push it out"
    assert journal.reply_to("T2", f"T2.1.{REPLIES_KEPT + 999}") is not None
    assert journal.reply_to("T2", "T2.1.1000") is not None
    assert journal.reply_to("T2", "T2.1.1") is None
    assert journal.reply_to("T2", "T1.1.1") is None


def test_events_by_life_and_number(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "T1.sqlite")
    for number in (1, 2, 3):
        journal.add_event(number, b"%d" % number)
    journal.close()
    again = Journal(tmp_path / "T1.sqlite")
    again.add_event(1, b"new life")
    assert (again.last_event(1), again.last_event(2), again.last_event(9)) == (3, 1, 0)
    assert again.events(1, 2, 10) == [b"2", b"3"]
    assert again.events(1, 1, 2) == [b"1", b"2"]
    assert again.events(2, 1, 10) == [b"new life"]
    assert again.events(1, 2**63, 10) == again.events(2**63, 1, 10) == []
    assert (again.last_event(2**63), again.events(0, 1, 10)) == (0, [])
    again.close()


def test_what_was_undone_may_be_done_again() -> None:
    journal = Journal()
    journal.remember_reply("T1", "first", b"1")
    journal.add_event(1, b"1")
    with pytest.raises(RuntimeError), journal.transaction():  # noqa: PT012
        journal.remember_reply("T1", "second", b"2")
        journal.add_event(2, b"2")
        raise RuntimeError
    assert (journal.reply_to("T1", "second"), journal.last_event(1)) == (None, 1)
    journal.remember_reply("T1", "second", b"3")
    assert (journal.reply_to("T1", "first"), journal.reply_to("T1", "second")) == (b"1", b"3")
    with pytest.raises(ValueError, match="answered before"):
        journal.remember_reply("T1", "second", b"4")
