"""``muster diagnose``: the diagnosis alone, on a case file."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import Any

from ops.cases import CaseFile, differences, read_case
from ops.commands.common import json_option, print_json
from ops.tables import InputError
from reasoning.diagnoser import Result, broken_in, diagnose
from reasoning.inspection import Settled, Tree, arbitrary, tree
from reasoning.solver import SolverError
from reasoning.values import Diagnosis

EPILOG = """\
A case file is TOML: before (fluents and values), actions (a list of steps), observed (what is not as before), absent
(fluents that are gone), bound (at most so many broken robots), static (the domain's constants), domain, rates (how
probable it is that a robot breaks in one step).
With rates, all explanations with fewest causes are ranked by their probabilities. Without, those are preferred in which
everything was executed up to the latest step; the others are told as set aside.
Exit code 0: explained, and as [expected] says where the file has that; 1: not so.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("case", metavar="CASE", help="a case file, or domain/name of a shipped case (muster list)")
    parser.add_argument(
        "--all", action="store_true", help="plan the inspections for the explanations that are set aside as well"
    )
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    file = read_case(args.case)
    try:
        result = diagnose(file.case, file.rates)
    except SolverError as error:
        raise InputError(f"{file.path}: states and actions must be terms of the domain: {error}") from error
    wrong = differences(file.expected, result) if file.expected else []
    suspected = [broken_in(d) for d in (*result.diagnoses, *(result.set_aside if args.all else ()))]
    weights = result.probabilities
    inspections = tree(suspected, weights) if suspected else None
    by_chance = arbitrary(suspected, weights) if suspected else 0.0
    if args.json:
        print_json(
            {
                "diagnoses": list(_told(result)),
                "set_aside": [_table(diagnosis) for diagnosis in result.set_aside],
                "executed": result.executed,
                "inspect": result.inspect,
                "inspections": _branch(inspections) if inspections else None,
                "expected_inspections": inspections.expected if inspections else 0.0,
                "expected_in_arbitrary_order": by_chance,
                "as_expected": not wrong,
            }
        )
        return 0 if result.diagnoses and not wrong else 1
    if file.story:
        print(file.story)
    for line in _explanations(file, result):
        print(line)
    if inspections is not None and not isinstance(inspections, Settled):
        print(f"inspections to be expected: {inspections.expected:.2f} (in arbitrary order {by_chance:.2f})")
        for line in _drawn(inspections):
            print(f"  {line}")
    for text in wrong:
        print(f"not as the case file says: {text}")
    return 0 if result.diagnoses and not wrong else 1


# ---------------------------------------------------------------- for programs
def _table(diagnosis: Diagnosis) -> dict[str, Any]:
    return {"causes": diagnosis.causes, "since": dict(diagnosis.since), "happened": diagnosis.happened}


def _told(result: Result) -> Iterator[dict[str, Any]]:
    for number, diagnosis in enumerate(result.diagnoses):
        odds = {"probability": result.probabilities[number]} if result.probabilities else {}
        yield {**_table(diagnosis), **odds}


def _branch(inspections: Tree) -> dict[str, Any]:
    if isinstance(inspections, Settled):
        return {"broken": inspections.broken, "chance": inspections.chance}
    return {
        "inspect": inspections.robot,
        "chance": inspections.chance,
        "if_broken": _branch(inspections.if_broken),
        "if_sound": _branch(inspections.if_sound),
    }


# ---------------------------------------------------------------- for people
def _explanations(file: CaseFile, result: Result) -> Iterator[str]:
    for number, diagnosis in enumerate(result.diagnoses, 1):
        odds = f" ({result.probabilities[number - 1]:.1%})" if result.probabilities else ""
        yield f"explanation {number}{odds}: {_causes(diagnosis)}"
        for cause, steps in diagnosis.since.items():
            yield f"  {cause} since step {' or '.join(map(str, steps))}"
        for step, actions in enumerate(file.case.actions):
            missing = [action for action in actions if action not in diagnosis.happened[step]]
            if missing:
                yield f"  did not happen in step {step}: {', '.join(missing)}"
    if not result.diagnoses:
        yield f"no explanation with at most {file.case.bound} broken robots"
    for diagnosis in result.set_aside:
        yield f"set aside: {_causes(diagnosis)}"
    if result.inspect:
        yield f"inspect: {', '.join(result.inspect)}"


def _causes(diagnosis: Diagnosis) -> str:
    return ", ".join(diagnosis.causes) or "nothing is wrong"


def _drawn(inspections: Tree, found: str = "") -> Iterator[str]:
    """The tree, a line a finding, each inspection indented under the finding that leads to it."""
    begin = f"{found} ({inspections.chance:.1%}): " if found else ""
    if isinstance(inspections, Settled):
        yield f"{begin}broken: {', '.join(inspections.broken) or 'none'}"
        return
    yield f"{begin}inspect {inspections.robot}"
    for finding, after in (("broken", inspections.if_broken), ("sound", inspections.if_sound)):
        for line in _drawn(after, finding):
            yield f"  {line}"
