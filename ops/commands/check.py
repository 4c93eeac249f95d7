"""``muster check``: the independent checker on a plan or on a recorded run."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ops.checking import check_plan
from ops.commands.common import json_option, print_json
from ops.plans import read_plan
from ops.scenario import load
from ops.tables import InputError
from reasoning.domain import domains
from reasoning.domain import load as load_domain
from reasoning.values import Violation
from reasoning.words import count

EPILOG = """\
Exit code 0: nothing is wrong; 1: there are violations; 3: a recorded run breaks an invariant.
A repair in a plan says that its robot broke before: what then had no effect is a discrepancy, which is no violation.
Where teams act for themselves, every recorded step is judged from the truth before it; what cannot be judged is told.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "what", metavar="PLAN_OR_RECORDING", help="a plan in JSON, domain/name of a shipped plan, or a recording"
    )
    parser.add_argument("--scenario", metavar="SCENARIO", help="where the plan starts, if it does not say so itself")
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    path = _file(args.what)
    if path.is_dir() or path.suffix == ".mcap":
        return _recording(path, args.json)
    scenario = load(args.scenario) if args.scenario else None
    file = read_plan(path)
    if scenario is None:
        verdict, breaks = check_plan(file)
    else:
        verdict, breaks = check_plan(file, scenario.domain, scenario.setup)
    if args.json:
        print_json(
            {
                "ok": not verdict.violations,
                "violations": [_table(violation) for violation in verdict.violations],
                "discrepancies": [_table(discrepancy) for discrepancy in verdict.discrepancies],
                "broken": [broken._asdict() for broken in breaks],
            }
        )
    else:
        for violation in verdict.violations:
            print(f"violation    {_text(violation)}")
        for discrepancy in verdict.discrepancies:
            print(f"discrepancy  {_text(discrepancy)}")
        longest = max(map(len, file.teams.values()), default=0)
        size = f"{count(len(file.teams), 'team')}, {count(longest, 'step')}"
        print(f"{path}: {size}: {_found(len(verdict.violations), 'violation')}")
    return 1 if verdict.violations else 0


def _recording(path: Path, as_json: bool) -> int:
    from ops.invariants import check
    from ops.recorded import check_run, static_beside
    from ops.recorded_rooms import Judged
    from ops.recording import load as load_recording

    try:
        recording = load_recording(path)
    except FileNotFoundError as error:
        raise InputError(str(error)) from error
    broken = check(recording)
    static = static_beside(path)
    judged = check_run(recording, static) if static is not None else Judged([])
    violations, unjudged = judged.violations, judged.unjudged
    if static is None:
        print(f"{path}: no TEAM.json beside the recording, so the domain's rules cannot be checked", file=sys.stderr)
    if as_json:
        print_json(
            {
                "ok": not broken and not violations,
                "violations": [*map(_table, violations)],
                "not_judged": dict(unjudged),
                "invariants": broken,
            }
        )
    else:
        for violation in violations:
            print(f"violation    {_text(violation)}")
        for text in broken:
            print(f"invariant    {text}")
        for why, number in sorted(unjudged.items()):
            print(f"not judged   {why}: {number}")
        found = f"{_found(len(violations), 'violation')}, {_found(len(broken), 'broken invariant')}"
        print(f"{path}: {count(len(recording.events), 'event')}: {found}")
    return 3 if broken else 1 if violations else 0


def _file(what: str) -> Path:
    """A path, or ``domain/name`` of a shipped plan. Raises `InputError`."""
    shipped = {f"{domain}/{name}": file for domain in domains() for name, file in load_domain(domain).plans.items()}
    path = Path(what)
    if not path.exists() and what not in shipped:
        there = f"{what}: neither a file, a recording nor a shipped plan. Shipped is {', '.join(shipped)}"
        raise InputError(f"{there}; muster plan SCENARIO --json > plan.json makes others")
    return path if path.exists() else shipped[what]


def _table(violation: Violation) -> dict[str, object]:
    return {name: getattr(violation, name) for name in ("team", "step", "action", "rule", "text")}


def _text(violation: Violation) -> str:
    return f"{violation.team} step {violation.step}  {violation.action}: {violation.text} [{violation.rule}]"


def _found(number: int, what: str) -> str:
    return count(number, what) if number else f"no {what}s"
