"""The commands of muster, a module each: `configure(parser)` declares options, `execute(args)` returns the exit code.

A command's module is imported only when that command was asked for, so that ``muster list`` does not wait for a solver.
"""

from __future__ import annotations

COMMANDS: dict[str, str] = {
    "run": "run a scenario: processes, live dashboard, recording, verdict",
    "plan": "plan a scenario without starting anything",
    "check": "hold a plan or a recorded run against the independent checker",
    "diagnose": "explain an observed state: all minimal causes, what to inspect",
    "why": "what stands in the way of a plan, an action, a suspicion: a minimal clash, checked",
    "watch": "the live dashboard, attached to a running system",
    "replay": "the dashboard from a recording",
    "inject": "disturb a running system: bodies, orders, deadlines, processes, links",
    "list": "the shipped scenarios and diagnosis cases, and what is running now",
    "validate": "is this scenario file right?",
    "compile": "write the files that a scenario's processes are given",
    "commonsense": "build a commonsense base from a ConceptNet assertions file",
    "doctor": "is this machine fit to run muster? what is wrong, and what to do",
    "bench": "run a benchmark and print its figures",
    "reference": "write the reference pages of the documentation from the code",
}
