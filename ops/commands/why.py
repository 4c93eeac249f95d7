"""``muster why``: what stands in the way, as a minimal set of things that clash, checked by the solver."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from msgspec import structs

from bus.clock import wall_s
from ops.commands.common import json_option, print_json
from ops.compile import start
from ops.planning import solve
from ops.scenario import Scenario, load
from ops.tables import InputError
from ops.whys import Asker, EndedError, Part, Progress, Subject, guests, no_plan_at_all, not_within
from ops.whywords import told
from reasoning.domain import load as load_domain
from reasoning.why import Possible, Unknown

EPILOG = """\
The answer is a set of goals, resources, facts and rules that clash, such that without any one of them there is a way.
Exit code 0: answered, and every member checked; 1: there is nothing to explain, or the time was over before.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("what", metavar="WHAT", help="a scenario, by path or domain/name")
    question = parser.add_mutually_exclusive_group()
    question.add_argument("--none", action="store_true", help="why is there no plan, however long?")
    question.add_argument("--shorter", action="store_true", help="why is there no plan that is one step shorter?")
    question.add_argument("--within", type=int, metavar="STEPS", help="why is there no plan of so many steps?")
    parser.add_argument("--team", metavar="T", help="which team the question is about")
    parser.add_argument(
        "--budget", type=float, default=60.0, metavar="SECONDS", help="end after so many seconds (default: 60)"
    )
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    live = sys.stderr.isatty()

    def progress(text: str) -> None:
        if live:
            print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)

    began = getattr(args, "began", wall_s())
    try:
        parts = _parts(args, began, progress)
    except EndedError as error:
        parts = []
        print(f"the time was over: {error}", file=sys.stderr)
    finally:
        if live:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
    seconds = wall_s() - began
    if args.json:
        print_json({"answered": _answered(parts), "parts": [*map(_table, parts)], "seconds": round(seconds, 3)})
    else:
        for part in parts:
            print("\n".join(_lines(part)))
    return 0 if _answered(parts) else 1


def _parts(args: argparse.Namespace, began: float, progress: Progress) -> list[Part]:
    scenario = load(args.what)
    subject = _scenario(scenario)
    if args.team is not None and args.team not in subject.states:
        raise InputError(f"--team {args.team}: there is no such team; there are {', '.join(subject.states)}")
    asker = Asker(subject, args.budget, progress, began)
    if args.none:
        return no_plan_at_all(asker)
    if args.within is not None:
        return not_within(asker, args.within, args.team or "")
    limits = structs.replace(scenario.limits, search_s=max(asker.left_s(), 0.01))
    plan = solve(replace(scenario, limits=limits), progress, began=wall_s())
    if plan.status == "infeasible" and not args.shorter:
        return no_plan_at_all(asker)
    if plan.status != "optimal":
        raise EndedError(f"{plan.status}, {plan.proof}")
    return not_within(asker, plan.makespan - 1, args.team or "")


def _scenario(scenario: Scenario) -> Subject:
    setup, domain = start(scenario), load_domain(scenario.domain)
    return Subject(scenario.name, domain, setup.static, setup.states, guests(domain, setup.states))


def _answered(parts: list[Part]) -> bool:
    return bool(parts) and all(part.answered for part in parts)


# ---------------------------------------------------------------- what is told
def _lines(part: Part) -> Iterator[str]:
    result = part.result
    if isinstance(result, Possible):
        yield part.possible
        return
    if isinstance(result, Unknown):
        yield f"{part.claim}: not known; the search ended after {result.seconds:.1f} s, {result.conflicts} conflicts"
        return
    yield f"{part.claim}: these {len(result.members)} clash"
    for kind, _, text, otherwise, needed in told(result, part.domain):
        doubt = "" if needed else "  (perhaps not needed)"
        yield f"  {kind:11} {text}{f'; else: {otherwise}' if otherwise else ''}{doubt}"
    yield from (f"  ({note})" for note in part.notes)
    counted = f"{result.searches} searches, {result.conflicts} conflicts, {result.seconds:.1f} s"
    if result.open or not result.checked:
        found = f"of {len(result.members)} members {len(result.without)} are proved to be needed"
        yield f"  not finished: {found}, and they were not all checked by a second solver; {counted}"
    else:
        yield f"  checked: all together are refuted, without any one there is a way; {counted}"


def _table(part: Part) -> dict[str, Any]:
    result = part.result
    table: dict[str, Any] = {"claim": part.claim, "answered": part.answered, "notes": part.notes}
    if isinstance(result, Possible):
        return {**table, "status": "possible", "text": part.possible}
    table |= {"conflicts": result.conflicts, "seconds": round(result.seconds, 3)}
    if isinstance(result, Unknown):
        return {**table, "status": "unknown"}
    members = [member._asdict() for member in told(result, part.domain)]
    return {
        **table,
        "status": "minimal" if part.answered else "clash",
        "members": members,
        "checked": result.checked,
        "searches": result.searches,
    }
