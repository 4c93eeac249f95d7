"""``muster why``: what stands in the way, as a minimal set of things that clash, checked by the solver."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from msgspec import structs

from bus.clock import wall_s
from ops.commands.common import json_option, overrides_option, print_json
from ops.planning import JointPlan, solve
from ops.tables import InputError
from ops.whyasker import Asker, EndedError, Part
from ops.whys import impossible, no_plan_at_all, not_within, other_role, suspicion
from ops.whysubjects import Subject, subject_of
from ops.whywords import told
from reasoning.checker import Exchange
from reasoning.why import Possible, Unknown

EPILOG = """\
Without a question: why is there no plan, or why no shorter one.
The answer is a set of goals, resources, facts and rules that clash, while without any one of them there is a way. Both
are checked by a second solver. Where the time does not suffice, it says how far it got.
Exit code 0: answered and checked; 1: there is nothing to explain, or the time was over before.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "what", metavar="WHAT", help="a scenario, a plan in JSON or a recording; for --suspected, or a diagnosis case"
    )
    question = parser.add_mutually_exclusive_group()
    question.add_argument("--none", action="store_true", help="why is there no plan, however long?")
    question.add_argument("--shorter", action="store_true", help="why is there no plan that is one step shorter?")
    question.add_argument("--within", type=int, metavar="STEPS", help="why is there no plan of so many steps?")
    question.add_argument("--borrows", metavar="T", help="why does this team borrow (and, with --not, not that one)?")
    question.add_argument("--lends", metavar="T", help="why does this team lend (and, with --not, not that one)?")
    question.add_argument("--suspected", metavar="ROBOT", help="why is it suspected (and, with --not, not that one)?")
    question.add_argument("--action", metavar="ACTION", help="why was this action not possible in --step?")
    parser.add_argument("--not", dest="other", metavar="NAME", default="", help="the team or robot that it is not")
    parser.add_argument("--step", type=int, metavar="STEP", help="of --action, or of the discrepancy of --suspected")
    parser.add_argument(
        "--team", metavar="T", help="which team is meant; of a shared plan, why this one stands in the way"
    )
    parser.add_argument(
        "--budget", type=float, default=60.0, metavar="SECONDS", help="end after so many seconds (default: 60)"
    )
    overrides_option(parser)
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    live = sys.stderr.isatty()

    def progress(text: str) -> None:
        if live:
            print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)

    began = getattr(args, "began", wall_s())
    parts: list[Part] = []
    late = ""
    try:
        parts = _parts(args, Asker(subject_of(args.what, args.overrides), args.budget, progress, began))
    except EndedError as error:
        late = f"the time was over: {error}"
    finally:
        if live:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
    answered = bool(parts) and all(part.answered for part in parts)
    if args.json:
        seconds = round(wall_s() - began, 3)
        print_json({"answered": answered, "late": late, "parts": [*map(_table, parts)], "seconds": seconds})
    else:
        for line in (line for part in parts for line in _lines(part)):
            print(line)
        if late:
            print(late)
    return 0 if answered else 1


def _parts(args: argparse.Namespace, asker: Asker) -> list[Part]:
    """The question that the options ask. Raises `InputError`, `EndedError`."""
    subject = asker.subject
    if not subject.domain.data.why:
        raise InputError(f"{args.what}: the domain {subject.domain.name} cannot be asked why yet: it has no why.lp")
    if not 0.0 <= args.budget < float("inf"):
        raise InputError(f"--budget {args.budget}: expected seconds, 0 or more")
    for option, team in (("team", args.team), ("borrows", args.borrows), ("lends", args.lends)):
        if team is not None and team not in subject.states:
            raise InputError(f"--{option} {team}: there is no such team; there are {', '.join(subject.states)}")
    if args.suspected is not None or (args.other and not args.borrows and not args.lends):
        return suspicion(asker, _team(args, subject), args.suspected or "", args.other, args.step)
    if subject.case is not None:
        raise InputError(f"{args.what}: a diagnosis case; ask --suspected ROBOT, or --not ROBOT")
    if args.within is not None:
        if args.within < 0:
            raise InputError(f"--within {args.within}: expected steps, 0 or more")
        return not_within(asker, args.within, args.team or "")
    if args.none:
        return no_plan_at_all(asker, args.team or "")
    status = _plan(asker)
    if args.action is not None:
        if args.step is None:
            raise InputError("--action needs --step, counted from 0")
        return impossible(asker, _team(args, subject), args.action, args.step)
    if args.borrows or args.lends:
        return other_role(
            asker, "borrow" if args.borrows else "lend", args.borrows or args.lends, args.other, args.team or ""
        )
    if status == "infeasible":
        return no_plan_at_all(asker, args.team or "")
    if not asker.subject.makespan:
        raise InputError(f"{args.what}: nothing is to be done, and no plan is shorter than that")
    return not_within(asker, asker.subject.makespan - 1, args.team or "")


def _team(args: argparse.Namespace, subject: Subject) -> str:
    if args.team is None and len(subject.states) > 1:
        raise InputError(f"say which team with --team: {', '.join(subject.states)}")
    return str(args.team or next(iter(subject.states)))


def _plan(asker: Asker) -> str:
    """See that there is a plan to speak of: that of the file or the run, else the best of the scenario. Returns its
    status. Raises `EndedError`."""
    scenario = asker.subject.scenario
    if scenario is None:
        return "given"
    limits = structs.replace(scenario.limits, search_s=max(asker.left_s(), 0.01))
    plan = solve(replace(scenario, limits=limits), asker.progress)
    if plan.status in ("unknown", "feasible"):
        raise EndedError(f"the best plan is not known: {plan.proof}")
    asker.subject = replace(asker.subject, teams=plan.teams, exchanges=_exchanges(plan))
    return plan.status


def _exchanges(plan: JointPlan) -> tuple[Exchange, ...]:
    return tuple(
        Exchange(str(x["worker"]), str(x["from"]), int(x["give_step"]), str(x["to"]), int(x["take_step"]), str(x["as"]))
        for x in plan.exchanges
    )


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
    for kind, _, text, otherwise, needed in told(result, part.domain, part.first):
        doubt = "" if needed else "  (perhaps not needed)"
        yield f"  {kind:11} {text}{f'; or else: {otherwise}' if otherwise else ''}{doubt}"
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
    members = [member._asdict() for member in told(result, part.domain, part.first)]
    return {
        **table,
        "status": "minimal" if part.answered else "clash",
        "members": members,
        "checked": result.checked,
        "searches": result.searches,
    }
