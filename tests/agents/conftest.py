"""Fixtures of the minds' tests."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from bus.messages import State
from tests.agents.thoughts import remember_thoughts
from tests.agents.together import System

STORE: dict[str, Any] = {}
MakeSystem = Callable[..., System]


@pytest.fixture
def make_system(monkeypatch: pytest.MonkeyPatch) -> Iterator[MakeSystem]:
    """Systems of their own, all closed at the end."""
    remember_thoughts(monkeypatch, STORE)
    made: list[System] = []
    memory = "/dev/shm" if Path("/dev/shm").is_dir() else None  # a hundred journals a second are much for a disk
    with tempfile.TemporaryDirectory(dir=memory) as home:

        def make(rooms: Mapping[str, State], **options: Any) -> System:
            system = System(Path(home, str(len(made))), rooms, **options)
            made.append(system)
            return system

        yield make
        for system in made:
            system.close()
