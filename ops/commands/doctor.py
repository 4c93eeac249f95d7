"""``muster doctor``: what is wrong with this machine, and what to do."""

from __future__ import annotations

import argparse

from ops.commands.common import json_option, print_json
from ops.doctor import examine


def configure(parser: argparse.ArgumentParser) -> None:
    json_option(parser)


def execute(args: argparse.Namespace) -> int:
    findings = []
    for finding in examine():
        findings.append(finding)
        if not args.json:
            print(f"{'ok' if finding.ok else 'WRONG':<6} {finding.check:<14} {finding.found}", flush=True)
            if finding.advice:
                print(f"{'':<6} {'':<14} -> {finding.advice}")
    well = all(finding.ok for finding in findings)
    if args.json:
        print_json({"ok": well, "findings": [finding._asdict() for finding in findings]})
    return 0 if well else 1
