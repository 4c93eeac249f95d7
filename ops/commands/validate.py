"""``muster validate``: read a scenario, compile it, say what it is."""

from __future__ import annotations

import argparse

from ops.commands.common import chosen_scenario, json_option, print_json, scenario_options
from ops.compile import compile_scenario


def configure(parser: argparse.ArgumentParser) -> None:
    scenario_options(parser)
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    scenario = chosen_scenario(args)
    compiled = compile_scenario(scenario)
    summary = {
        "scenario": str(scenario.path),
        "story": scenario.story,
        "domain": scenario.domain,
        "teams": list(scenario.teams),
        "bodies": len(compiled.setup.entities),
        "faults": len(scenario.faults),
        "conditions": 1 + len(scenario.verdict.eventually) + len(scenario.verdict.never),
    }
    if args.json:
        print_json({"ok": True, **summary})
    else:
        print(f"{scenario.path}: right. {scenario.story}")
        print(f"  {len(scenario.teams)} teams, {summary['bodies']} bodies, {summary['faults']} faults")
    return 0
