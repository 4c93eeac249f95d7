"""``muster compile``: the files that the processes of a scenario are given, for those who start them themselves."""

from __future__ import annotations

import argparse
from pathlib import Path

from ops.commands.common import chosen_scenario, json_option, print_json, scenario_options
from ops.compile import compile_scenario
from ops.plans import read_plan
from ops.scenario import Scenario


def configure(parser: argparse.ArgumentParser) -> None:
    scenario_options(parser)
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="directory for the files")
    parser.add_argument("--teams", metavar="T1,T2,...", help="fail unless the scenario has exactly these teams")
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    scenario = chosen_scenario(args)
    if args.teams is not None:
        _expect_teams(scenario, args.teams.split(","))
    compiled = compile_scenario(scenario, read_plan(scenario.plan).given() if scenario.plan else None)
    compiled.write(args.output)
    files = [str(args.output / f"{name}.json") for name in compiled.files]
    if args.json:
        print_json({"files": files})
    else:
        print("\n".join(files))
    return 0


def _expect_teams(scenario: Scenario, expected: list[str]) -> None:
    if sorted(scenario.teams) != sorted(expected):
        wanted = f"expected exactly the teams {', '.join(expected)}, for which there are services"
        raise scenario.complaint(["teams"], f"{wanted}; found {', '.join(scenario.teams)}")
