"""Measuring pieces of work, each in a process of its own, so that nothing is warm and memory is its own.

A benchmark module lists its pieces of work by name in `WORK`: a function from plain values to figures. `measured` runs
one in a fresh process, several times, and adds seconds of processor time, wall seconds and the peak of memory.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from resource import RUSAGE_SELF, getrusage
from statistics import median
from typing import Any, NamedTuple

from bus.clock import wall_s

ROOT = Path(__file__).parents[1]
Work = Callable[..., dict[str, Any]]


class Options(NamedTuple):
    """`runs` of each piece of work; `limit_s` seconds for what may not end; `quick`: the smallest instances only;
    `jobs` processes at once; `only` these sections (empty: all)."""

    runs: int = 5
    limit_s: float = 60.0
    quick: bool = False
    jobs: int = 2
    only: tuple[str, ...] = ()

    def wants(self, section: str) -> bool:
        return not self.only or section in self.only


def options(sections: Sequence[str], what: str) -> Options:
    """From the command line. Ends the process with code 2 when it is wrong."""
    parser = argparse.ArgumentParser(prog=f"muster bench {Path(sys.argv[0]).stem}", description=what)
    parser.add_argument("--runs", type=int, default=5, help="runs of each piece of work, of which medians are told")
    parser.add_argument("--limit", type=float, default=60.0, metavar="SECONDS", help="for work that may not end")
    parser.add_argument("--quick", action="store_true", help="the smallest instances only")
    parser.add_argument("--jobs", type=int, default=2, help="processes at once")
    parser.add_argument("--only", action="append", default=[], choices=sections, help="this part; repeatable")
    given = parser.parse_args()
    if min(given.runs, given.jobs) < 1 or given.limit <= 0:
        parser.error("expected numbers above 0")
    return Options(given.runs, given.limit, given.quick, given.jobs, tuple(given.only))


def measured(module: str, tasks: Sequence[tuple[str, Mapping[str, Any]]], chosen: Options) -> list[dict[str, Any]]:
    """The figures of each task, (name of its work, arguments). A task is run `chosen.runs` times, but not again once
    its runs have taken `chosen.limit_s` together. Progress goes to stderr."""

    def repeated(task: tuple[str, Mapping[str, Any]]) -> dict[str, Any]:
        runs: list[dict[str, Any]] = []
        while len(runs) < chosen.runs and sum(run["wall_s"] for run in runs) < chosen.limit_s:
            runs.append(fresh(module, *task))
        figures = summary(runs)
        words = ", ".join(f"{key} {value}" for key, value in task[1].items() if not isinstance(value, (dict, list)))
        print(f"{task[0]}: {words}: {figures['cpu_s']:.2f} s, {len(runs)} runs", file=sys.stderr, flush=True)
        return figures

    with ThreadPoolExecutor(chosen.jobs) as pool:
        return list(pool.map(repeated, tasks))


def fresh(module: str, work: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """One run in a new process. Raises RuntimeError when it fails."""
    command = [sys.executable, "-m", module, "work", work, json.dumps(arguments)]
    begun = wall_s()
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{work} {arguments} failed: {done.stderr}")
    figures: dict[str, Any] = json.loads(done.stdout)
    return {**figures, "process_wall_s": wall_s() - begun}


def cpu_s() -> float:
    """Seconds of processor time that this process has used."""
    used = getrusage(RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def serve(works: Mapping[str, Work]) -> bool:
    """Is this process one that `fresh` has started? Then do the work and print its figures. What the work measures by
    itself stays as it is."""
    if sys.argv[1:2] != ["work"]:
        return False
    work, arguments = works[sys.argv[2]], json.loads(sys.argv[3])
    cpu, wall = cpu_s(), wall_s()
    figures = work(**arguments)
    figures.setdefault("cpu_s", cpu_s() - cpu)
    figures.setdefault("wall_s", wall_s() - wall)
    figures["memory_mb"] = getrusage(RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps(figures))
    return True


def summary(runs: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Medians of what is measured in seconds and megabytes, and the range of seconds; the rest from the first run."""
    figures = dict(runs[0])
    for name, value in runs[0].items():
        if isinstance(value, float) and name.endswith(("_s", "_mb")):
            figures[name] = median(run[name] for run in runs)
            if name.endswith("_s"):
                figures[f"{name}_range"] = [min(run[name] for run in runs), max(run[name] for run in runs)]
    return {**figures, "runs": len(runs)}
