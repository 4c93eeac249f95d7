"""What does a kill -9 cost? ``python -m bench.recovery [KILLS]``, or ``muster bench recovery``.

A small run in which a worker breaks is started again and again, with either clock; in each a process is killed at a
drawn moment, by its pid: when a drawn line of the run's report appears, and a drawn while after, so that kills hit the
start, the search, the steps and the diagnosis. The run must reach its goal all the same, and the invariants must hold
on its recording. Drawn with a fixed seed; where exactly a kill hits depends on the load.

- *detected*: from the kill until the supervisor reports the death.
- *back at work*: from the kill until the process itself reports that it is back, with what it remembers.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from statistics import median
from typing import Any, NamedTuple

from bench.measured import progress, telling
from bus.clock import wall_s
from ops.children import environment

KILLS = 50
SEED = 7
SCENARIO = "factory/broken_worker"
VICTIMS = ("T1", "coordinator", "world", "T2")
CLOCKS = ("fast", "fast", "fast", "realtime:20")
PAUSES_S = (0.0, 0.0, 0.01, 0.05, 0.2)
LINES = 36
"""Fewer than the lines of an undisturbed run after all have started, so that nearly every kill hits."""
LIMIT_S = 120.0
STARTED = re.compile(r" supervisor +(\S+) started: pid (\d+)")


class Outcome(NamedTuple):
    """One run. Seconds are None when the kill came too late to be seen, `code` is the run's exit code, `words` say
    what was run and when the kill came."""

    victim: str
    code: int
    detected_s: float | None
    back_s: float | None
    words: str


def run(kills: int = KILLS) -> dict[str, Any]:
    """All kills, and the figures by victim in wall seconds. Progress goes to stderr."""
    draw = random.Random(SEED)
    outcomes: list[Outcome] = []
    result: dict[str, Any] = {}
    with telling(result):
        try:
            for n in range(kills):
                outcomes.append(_one(VICTIMS[n % len(VICTIMS)], CLOCKS[n // len(VICTIMS) % len(CLOCKS)], draw))
                progress(f"{n + 1} of {kills}: {outcomes[-1].words}: exit code {outcomes[-1].code}")
        finally:
            result |= {victim: _figures([o for o in outcomes if o.victim == victim]) for victim in VICTIMS}
    return result


def _figures(outcomes: list[Outcome]) -> dict[str, Any]:
    detected = [o.detected_s for o in outcomes if o.detected_s is not None]
    back = [o.back_s for o in outcomes if o.back_s is not None]
    return {
        "kills": len(outcomes),
        "hit": len(detected),
        "goal_and_invariants": sum(o.code == 0 for o in outcomes),
        "detected_s": {"median": median(detected or [0.0]), "max": max(detected, default=0.0)},
        "back_s": {"median": median(back or [0.0]), "max": max(back, default=0.0)},
        "failed": [o.words for o in outcomes if o.code != 0],
    }


def _one(victim: str, clock: str, draw: random.Random) -> Outcome:
    """One run with one kill, at a drawn line of the report after the victim has started."""
    at, pause_s, seed = draw.randrange(LINES), draw.choice(PAUSES_S), str(draw.randrange(10_000))
    words = ["run", SCENARIO, "--clock", clock, "--headless", "--seed", seed]
    words += ["--set", "verdict.eventually=[]", "--set", "verdict.never=[]", "--set", "verdict.optimal=true"]
    pid, killed_s, died_s, back_s, after, count = 0, 0.0, None, None, "", 0
    with _process([sys.executable, "-m", "ops.cli", *words]) as process:
        for line in process.stdout or ():
            now_s = wall_s()
            if (started := STARTED.search(line)) and started[1] == victim:
                pid = int(started[2])
            elif killed_s and f" {victim} died" in line:
                died_s = died_s or now_s - killed_s
            elif died_s and f" {victim} " in line and " supervisor " not in line:
                back_s = back_s or now_s - killed_s
            if pid and not killed_s:
                if count == at or "every team has reached" in line:
                    threading.Event().wait(pause_s)
                    with suppress(ProcessLookupError):
                        os.kill(pid, signal.SIGKILL)
                    killed_s, after = wall_s(), line.strip()
                count += 1
    return Outcome(
        victim, process.returncode, died_s, back_s, f"{clock} seed {seed}: {victim} {pause_s} s after {after}"
    )


@contextmanager
def _process(command: list[str]) -> Iterator[subprocess.Popen[str]]:
    """A run that is ended after `LIMIT_S`, whatever it does."""
    options: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(command, env=environment(), **options) as process:
        limit = threading.Timer(LIMIT_S, process.terminate)
        limit.start()
        try:
            yield process
        except BaseException:
            process.terminate()  # in order: it ends its own
            raise
        finally:
            process.wait()
            limit.cancel()


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="muster bench recovery", description="Processes are killed, and come back.")
    parser.add_argument("kills", nargs="?", type=int, default=KILLS, help="how many processes are killed")
    kills = parser.parse_args().kills
    try:
        _print(run(kills))
    except KeyboardInterrupt as stopped:
        _print(stopped.args[0])
        raise


def _print(result: dict[str, Any]) -> None:
    print("victim        kills   hit   goal and invariants   detected: median, max   back at work: median, max")
    for victim, row in result.items():
        detected, back = row["detected_s"], row["back_s"]
        print(
            f"{victim:12}{row['kills']:7}{row['hit']:6}{row['goal_and_invariants']:22}"
            f"{detected['median']:15.2f} s {detected['max']:5.2f} s{back['median']:17.2f} s {back['max']:5.2f} s"
        )
        for words in row["failed"]:
            print(f"    failed: {words}", flush=True)


if __name__ == "__main__":
    main()
