"""``muster list``: what can be run, and what is running."""

from __future__ import annotations

import argparse

from ops.cases import shipped_cases
from ops.commands.common import json_option, print_json
from ops.places import runnable, shipped
from ops.registry import listing
from ops.tables import read


def configure(parser: argparse.ArgumentParser) -> None:
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    scenarios = {name: str(read(path)[0].get("story", "")) for name, path in shipped().items()}
    runs = runnable()
    cases = {name: str(path) for name, path in shipped_cases().items()}
    running = listing()
    if args.json:
        print_json({"scenarios": scenarios, "runnable": [*runs], "cases": cases, "running": running})
        return 0
    width = max(map(len, [*scenarios, *cases]), default=0)
    print("scenarios (muster run NAME):")
    for name in runs:
        print(f"  {name:<{width}}  {scenarios[name]}")
    if len(runs) < len(scenarios):
        print("scenarios that can be planned, but not run yet (muster plan NAME):")
    for name in scenarios:
        if name not in runs:
            print(f"  {name:<{width}}  {scenarios[name]}")
    print("diagnosis cases (muster diagnose NAME):")
    for name in cases:
        print(f"  {name}")
    print("running now:" if running else "running now: nothing")
    for one in running:
        print(f"  {one.run}  {one.scenario}  {one.connect}  {one.home}")
    return 0
