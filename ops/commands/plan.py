"""``muster plan``: the shared plan of a scenario with its proof, without starting anything."""

from __future__ import annotations

import argparse
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace

from msgspec import structs

from bus.clock import wall_s
from ops.commands.common import chosen_scenario, json_option, print_json, scenario_options
from ops.planning import JointPlan, solve
from ops.scenario import Scenario
from reasoning.words import count

EPILOG = """\
When the budget is spent, or on Ctrl-C, the best plan so far is printed, with the proven bound and the gap between them.
Another limit is --set limits.conflicts=100000 (for one question; 0: none).
Exit code 0: a plan was found; 1: there is none, none was found within the limits, or the checker refuses it.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    scenario_options(parser)
    parser.add_argument(
        "--budget",
        type=_seconds,
        metavar="SECONDS",
        help="end after so many seconds with the best plan so far, the proven bound and the gap (0: no limit); "
        "instead of the scenario's limits.search_s",
    )
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    began = getattr(args, "began", wall_s())
    scenario = chosen_scenario(args)
    if args.budget is not None:
        scenario = replace(scenario, limits=structs.replace(scenario.limits, search_s=args.budget))
    live = sys.stderr.isatty()

    def progress(text: str) -> None:
        if live:
            print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)

    try:
        with _interrupted() as stop:
            plan = solve(scenario, progress, began=began, stop=stop)
    finally:
        if live:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
    if args.json:
        print_json(as_json(plan, scenario))
    else:
        print(as_text(plan))
    return 0 if plan.status in ("optimal", "feasible") else 1


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = -1.0
    if not 0.0 <= seconds < float("inf"):
        raise argparse.ArgumentTypeError(f"expected seconds, 0 or more, not {text}")
    return seconds


@contextmanager
def _interrupted() -> Iterator[Callable[[], bool]]:
    """Whether somebody has pressed Ctrl-C since. The second time it ends the process as ever."""
    pressed = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield pressed.is_set
        return
    before = signal.getsignal(signal.SIGINT)

    def once(*_: object) -> None:
        pressed.set()
        signal.signal(signal.SIGINT, before)

    signal.signal(signal.SIGINT, once)
    try:
        yield pressed.is_set
    finally:
        signal.signal(signal.SIGINT, before)


def as_json(plan: JointPlan, scenario: Scenario) -> dict[str, object]:
    """The plan as a file, for ``muster check`` and ``muster run --plan``; `scenario` says where it starts."""
    return {
        "status": plan.status,
        "makespan": plan.makespan,
        "lower_bound": plan.lower_bound,
        "gap": plan.gap,
        "proof": plan.proof,
        "exchanges": plan.exchanges,
        "teams": {team: {"steps": steps} for team, steps in plan.teams.items()},
        "questions": plan.questions,
        "seconds": round(plan.seconds, 3),
        "refused": [asdict(violation) for violation in plan.refused],
        "scenario": {"domain": scenario.domain, "setup": scenario.setup},
    }


def as_text(plan: JointPlan) -> str:
    """The plan for people: a line a step and team."""
    lines = [f"{plan.status}: {count(plan.makespan, 'step')}, no fewer than {plan.lower_bound}"]
    if plan.gap:
        lines[0] += f" (gap {plan.gap})"
    if plan.status == "unknown":
        lines = [f"unknown: no plan yet, no fewer than {count(plan.lower_bound, 'step')}"]
    elif plan.status == "infeasible":
        lines = ["infeasible: no plan"]
    elif plan.status == "refused":
        lines = [f"refused: {count(plan.makespan, 'step')}, but the checker finds that it cannot be done"]
    lines.append(f"proof: {plan.proof or 'none'}")
    for x in plan.exchanges:
        given = f"{x['from']} gives {x['worker']} in step {x['give_step']}"
        lines.append(f"{given}; {x['to']} takes it as {x['as']} in step {x['take_step']}")
    for team, steps in plan.teams.items():
        lines.append(f"{team}:")
        lines += [f"  {step:3}  {', '.join(actions) or '-'}" for step, actions in enumerate(steps)]
    lines += [f"refused: {v.team} step {v.step}  {v.action}: {v.text} [{v.rule}]" for v in plan.refused]
    lines.append(f"{count(plan.questions, 'question')}, {plan.seconds:.1f} s")
    return "\n".join(lines)
