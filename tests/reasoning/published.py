"""The published run, for the tests of the checker and the diagnoser: set-up, steps, exchanges and the known break."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from reasoning.checker import Break, Exchange
from reasoning.setup import Setup, compile_setup
from reasoning.values import Step

FILE = Path(__file__).parents[1] / "data" / "factory_published_plan.json"
DOMAIN = "factory"
EXCHANGES = (Exchange("w3", "T2", 11, "T1", 13, "w2"), Exchange("w1", "T3", 13, "T4", 18, "w2"))
BREAKS = (Break("T4", "c1", 16),)
TOOLS = {("T1", 13, "takeRobot(w2,1,2)"): 3, ("T4", 18, "takeRobot(w2,1,2)"): 3}
DETAILS = {team: {(step, action): {"effector": tool}} for (team, step, action), tool in TOOLS.items()}


def load() -> tuple[Setup, dict[str, list[Step]]]:
    data: dict[str, Any] = json.loads(FILE.read_text())
    teams = {
        f"T{number}": {
            "boxes": team["boxes"],
            "workers": [
                {"name": name, "at": worker["pos"], "effector": worker["effector"]}
                for name, worker in team["workers"].items()
            ],
            "carrier": {"name": "c1", "at": team["carrier"]["c1"]},
        }
        for number, team in data["setup"].items()
    }
    setup = compile_setup(DOMAIN, {"teams": teams, "exchange": {"delay": 2}})
    assert isinstance(setup, Setup)
    return setup, {f"T{number}": [tuple(step) for step in steps] for number, steps in data["steps"].items()}
