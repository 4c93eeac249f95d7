"""``muster validate``: read a scenario, compile it, say what it is."""

from __future__ import annotations

import argparse

from ops.commands.common import chosen_scenario, json_option, print_json, scenario_options
from ops.compile import compile_scenario, start
from reasoning.domain import load
from reasoning.words import count


def configure(parser: argparse.ArgumentParser) -> None:
    scenario_options(parser)
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    scenario = chosen_scenario(args)
    runs = load(scenario.domain).can_run
    setup = compile_scenario(scenario).setup if runs else start(scenario)
    summary = {
        "scenario": str(scenario.path),
        "story": scenario.story,
        "domain": scenario.domain,
        "can_run": runs,
        "teams": list(scenario.teams),
        "bodies": len(setup.entities),
        "faults": len(scenario.faults),
        "conditions": 1 + len(scenario.verdict.eventually) + len(scenario.verdict.never),
    }
    if args.json:
        print_json({"ok": True, **summary})
    else:
        sizes = ("team", len(scenario.teams)), ("body", len(setup.entities)), ("fault", len(scenario.faults))
        counted = [count(number, noun) for noun, number in sizes]
        print(f"{scenario.path}: right. {scenario.story}")
        print(f"  {', '.join(counted)}")
        if not runs:
            print(f"  scenarios of the domain {scenario.domain} can be planned and checked, but not run yet")
    return 0
