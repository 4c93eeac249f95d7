"""``muster inject``: disturb a running system. The world takes it, or refuses with the reason."""

from __future__ import annotations

import argparse
import os
import re

from bus.access import OPERATOR
from bus.faults import KINDS
from bus.messages import Inject, Injected
from bus.node import NoAnswer, NodeConfig, open_node
from bus.transport import TransportError
from ops.commands.common import json_option, print_json, running_options
from ops.faultwords import problem, usage
from ops.registry import Running, find
from ops.tables import InputError

PATIENCE_S = 10.0

EPILOG = "kinds:\n" + "\n".join(f"  {usage(kind, known):<44} {known.help}" for kind, known in KINDS.items())


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("kind", metavar="KIND", help="what happens; see below")
    parser.add_argument("target", metavar="TARGET", help="T4.c1 (robot), T1.2 (object), T1 (team, process, link)")
    parser.add_argument("args", metavar="NAME=VALUE", nargs="*", default=[], help="the kind's arguments")
    running_options(parser)
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    values = dict(_argument(written) for written in args.args)
    if wrong := problem(args.kind, args.target, values):
        raise InputError(f"{wrong[0]}: {wrong[1]}")
    running = find(args.run, args.connect, args.identity)
    answer = _send(running, Inject(args.kind, args.target, values))
    if args.json:
        print_json({"run": running.run, "accepted": answer.accepted, "reason": answer.reason})
    elif answer.accepted:
        print(f"{running.run}: {args.kind} {args.target} accepted")
    if not answer.accepted:
        raise InputError(f"refused: {answer.reason}")
    return 0


def _send(running: Running, inject: Inject) -> Injected:
    name = f"{OPERATOR}-{os.getpid()}"
    config = NodeConfig(running.run, name, running.connect, outsider=True, identity=running.proof())
    try:
        with open_node(config) as node:
            answer = node.ask("world", inject, PATIENCE_S)
    except TransportError as error:
        raise InputError(str(error)) from error
    except NoAnswer as error:
        raise InputError(
            f"{error}; the run {running.run} may be over, or its world is being restarted: try again"
        ) from error
    if not isinstance(answer, Injected):
        raise InputError(f"the world answered {type(answer).__name__}, which is no answer to this")
    return answer


def _argument(written: str) -> tuple[str, int | str | float]:
    name, equals, value = written.partition("=")
    if not name or not equals:
        raise InputError(f"{written}: expected NAME=VALUE, for instance share=0.1")
    if re.fullmatch(r"-?\d+", value):
        return name, int(value)
    try:
        return name, float(value)
    except ValueError:
        return name, value
