"""Measuring pieces of work, each in a process of its own, so that nothing is warm and memory is its own.

A benchmark module lists its pieces of work by name in `WORK`: a function from plain values to figures. `measured` runs
one in a fresh process, several times, and adds seconds of processor time, wall seconds and the peak of memory.

Who presses Ctrl-C has what was measured till then: rows are told as they come, the interrupt carries the figures, and
no process outlives it.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
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


def ignored(*_: object) -> None:
    """For those who want the figures at the end only."""


@contextmanager
def telling(result: dict[str, Any]) -> Iterator[None]:
    """Ctrl-C inside carries `result`, the figures so far, as its argument."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(result) from None


def measured(
    module: str,
    tasks: Sequence[tuple[str, Mapping[str, Any]]],
    chosen: Options,
    on_figures: Callable[[dict[str, Any]], None] = ignored,
) -> list[dict[str, Any]]:
    """The figures of each task, (name of its work, arguments). A task is run `chosen.runs` times, but not again once
    its runs have taken `chosen.limit_s` together. Progress goes to stderr. `on_figures` gets the figures in the order
    of the tasks, each as soon as it and all before it are there. Raises RuntimeError when a run fails."""
    with ThreadPoolExecutor(chosen.jobs) as pool, _Processes(module) as processes:

        def repeated(task: tuple[str, Mapping[str, Any]]) -> dict[str, Any]:
            given = [f"{key} {value}" for key, value in task[1].items() if not isinstance(value, (dict, list))]
            words = f"{task[0]}: {', '.join(given)}" if given else task[0]
            runs: list[dict[str, Any]] = []
            while len(runs) < chosen.runs and sum(run["wall_s"] for run in runs) < chosen.limit_s:
                runs.append(processes.run(*task))
                progress(f"{words}: {runs[-1]['cpu_s']:.2f} s, run {len(runs)} of {chosen.runs}")
            return summary(runs)

        every = []
        for figures in pool.map(repeated, tasks):
            every.append(figures)
            on_figures(figures)
        return every


def progress(text: str) -> None:
    """A line on stderr, in one piece: several threads tell theirs."""
    sys.stderr.write(text + "\n")
    sys.stderr.flush()


class _Processes:
    """Runs in new processes, none of which outlives the ``with`` block."""

    def __init__(self, module: str) -> None:
        self._module, self._lock, self._over = module, threading.Lock(), False
        self._running: set[subprocess.Popen[str]] = set()

    def __enter__(self) -> _Processes:
        return self

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._over = True
            for process in self._running:
                process.kill()

    def run(self, work: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """Figures of one run. Raises RuntimeError when it fails, and when the block is over."""
        command = [sys.executable, "-m", self._module, "work", work, json.dumps(arguments)]
        begun = wall_s()
        with self._lock:
            if self._over:
                raise RuntimeError(f"{work} {arguments} was to begin after the end")
            process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self._running.add(process)
        with process:
            out, errors = process.communicate()
        with self._lock:
            self._running.remove(process)
        if process.returncode:
            raise RuntimeError(f"{work} {arguments} failed: {errors}")
        figures: dict[str, Any] = json.loads(out)
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
