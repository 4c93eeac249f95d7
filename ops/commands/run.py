"""``muster run``: start everything, watch, judge."""

from __future__ import annotations

import argparse
import signal
from pathlib import Path
from typing import NoReturn

from ops.commands.common import has_screen, json_option, print_json, scenario_options
from ops.ports import HOST
from ops.running import Options, Outcome, Show
from ops.running import execute as run_scenario
from ops.scenario import load
from ops.shows import Lines, Screen, Silence
from ops.tables import InputError
from ops.verdict import Report
from reasoning.words import count

EPILOG = """\
With a terminal the run is shown on the live dashboard (q ends it); without one, or with --headless, as lines.
At the end comes the verdict. Without --record the recording is thrown away when all is well; otherwise its directory is
said, with the logs of all processes in it.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    scenario_options(parser)
    parser.add_argument("--seed", metavar="N", type=int, help="instead of the scenario's seed")
    parser.add_argument(
        "--clock",
        metavar="MODE",
        help="fast (time jumps; same seed, same run), realtime, or realtime:FACTOR (simulated per wall seconds)",
    )
    parser.add_argument("--headless", action="store_true", help="no dashboard: one line an event")
    parser.add_argument("--record", metavar="DIR", type=Path, help="keep the recording, journals and logs in DIR")
    parser.add_argument(
        "--plan", metavar="FILE", type=Path, help="execute this plan first; muster takes over if it fails"
    )
    parser.add_argument(
        "--port", metavar="N", type=int, default=0, help="the router's port (default: any that is free)"
    )
    parser.add_argument(
        "--host",
        metavar="ADDRESS",
        default=HOST,
        help="address of the router (default %(default)s); 0.0.0.0 lets other machines watch and inject: anybody there",
    )
    parser.add_argument(
        "--secure",
        action="store_true",
        help="certificates for all processes: each may say and hear only what it should",
    )
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    scenario = load(args.scenario, [*args.overrides, *_as_overrides(args)])
    if not 0 <= args.port <= 65535:
        raise InputError(f"--port {args.port}: expected a number from 0 to 65535")
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _interrupt)
    outcome = run_scenario(scenario, Options(args.record, args.plan, args.port, args.host, args.secure), _show(args))
    if args.json:
        print_json(as_json(outcome))
    else:
        print(as_text(outcome))
    return outcome.report.exit_code


def as_json(outcome: Outcome) -> dict[str, object]:
    """The verdict as ``--json`` prints it."""
    report = outcome.report
    return {
        "run": outcome.run,
        "exit": report.exit_code,
        **{field: getattr(report, field) for field in Report.__struct_fields__},
        "home": str(outcome.home) if outcome.home else None,
        "pids": outcome.pids,
    }


def as_text(outcome: Outcome) -> str:
    """The verdict for people."""
    report, messages = outcome.report, outcome.report.messages
    lines = [
        "",
        f"goal        {'reached' if report.goal else 'not reached'}: {report.reason}",
        f"makespan    {count(report.makespan, 'step')}",
        f"replans     {report.replans}",
    ]
    for diagnosis in report.diagnoses or ({"text": "none"},):
        lines.append(f"diagnosis   {diagnosis.get('text', diagnosis)}")
    lines.append(
        f"messages    {messages.sent} sent, {messages.received} received, {messages.repeated} repeated, "
        f"{messages.refused} refused; {count(messages.events, 'event')}"
    )
    broken = report.invariants
    lines.append(
        f"invariants  {'not checked' if broken is None else f'{len(broken)} broken' if broken else 'all hold'}"
    )
    lines += [f"            broken: {text}" for text in broken or ()]
    for condition in report.conditions:
        found = f" ({condition.found})" if condition.found else ""
        lines.append(f"{'ok' if condition.ok else 'FAILED':<11} {condition.text}{found}")
    if outcome.home is not None:
        lines.append(f"recording   {outcome.home}")
    return "\n".join(lines)


def _as_overrides(args: argparse.Namespace) -> list[str]:
    """--seed and --clock say the same as --set."""
    overrides = [] if args.seed is None else [f"seed={args.seed}"]
    if args.clock is not None:
        mode, _, factor = args.clock.partition(":")
        try:
            good = (mode == "fast" and not factor) or (mode == "realtime" and float(factor or 1) > 0)
        except ValueError:
            good = False
        if not good:
            raise InputError(f"--clock {args.clock}: expected fast, realtime, or realtime:FACTOR with FACTOR > 0")
        overrides += [f'clock={{mode = "{mode}", factor = {float(factor or 1)!r}}}']
    return overrides


def _show(args: argparse.Namespace) -> Show:
    if args.json:
        return Silence()
    return Screen() if has_screen() and not args.headless else Lines()


def _interrupt(_number: int, _frame: object) -> NoReturn:
    raise KeyboardInterrupt
