"""A team that is killed before any of its writes and sends comes back and goes on; nothing happens twice, and robots
come home."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from agents.autonomous.thinking import Thinking
from tests.agents.house import Home
from tests.agents.test_autonomous import NOVEL, RUG, TO_KITCHEN, kitchen, living, weigh
from tests.agents.thoughts import remembered

KILLS = 6
"""So many moments of a process's life are tried, evenly spread."""


@pytest.fixture(scope="module")
def thoughts() -> dict[str, Any]:
    return {}


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch, thoughts: dict[str, Any]) -> None:
    """Each thought is thought once."""
    for name in ("_attempt", "_hopeless", "_bound"):
        real = getattr(Thinking, name)

        def again(self: Thinking, *args: Any, real: Any = real, name: str = name, **options: Any) -> Any:
            of = self._words.here(args[0] if name == "_bound" else args[1])
            think = remembered(lambda *_, **__: real(self, *args, **options), thoughts)
            think.__name__ = name
            return think(of, name, *args, **options)

        monkeypatch.setattr(Thinking, name, again)


def home(path: Path) -> Home:
    made = Home(path, {"living": living(RUG, NOVEL, **TO_KITCHEN), "kitchen": kitchen(("mug_1", "mug", 2, 2))})
    weigh(made, "rug", (3, 2))
    return made


@pytest.mark.slow
@pytest.mark.parametrize("name", ["living", "kitchen", "coordinator"])
def test_a_process_may_be_killed_at_any_moment(name: str, tmp_path: Path) -> None:
    whole = home(tmp_path / "whole")
    whole.end()
    operations = whole.processes[name].operations
    whole.close()
    for number in range(KILLS):
        run = home(tmp_path / str(number))
        process = run.processes[name]
        process.left = (operations - process.operations) * number // KILLS
        over = run.end()
        assert over.goal, run.story()
        assert process.lives == 2
        assert run.world.robots["kitchen.r2"].team == "kitchen"
        assert {run.world.things[thing].at[0] for thing in ("rug", "novel_1", "mug_1")} == {5}
        run.close()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["living", "kitchen"])
def test_a_team_may_be_out_of_contact_for_a_while(name: str, tmp_path: Path) -> None:
    for moment_s in (1.0, 16.0, 31.0, 45.0):
        run = home(tmp_path / str(moment_s))
        run.until(lambda run=run, moment_s=moment_s: run.now_s >= moment_s or run.over)
        if run.over is None:
            run.contact(name, "lost_contact")
            run.until(lambda run=run, moment_s=moment_s: run.now_s >= moment_s + 20.0)
            run.contact(name, "back")
        assert run.end().goal, run.story()
        run.close()
