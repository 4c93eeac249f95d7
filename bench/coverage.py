"""Does the planner find the least makespan from every start? ``python -m bench.coverage``.

All starts of one or two workers and one to three boxes on the published floor, complete up to the names of the workers
(`tests.reasoning.starts`): alone, lending (whenever, or early), and for one worker borrowing. The truth is told by
retrograde analysis (`tests.reasoning.retrograde`), which the tests hold against the reference; the planner's program is
asked for many starts at once. Told for each kind: starts, how many differ, seconds of processor time.
"""

from __future__ import annotations

import argparse
import sys
from random import Random

from bench.measured import cpu_s
from reasoning.reference import Kind
from tests.reasoning.everywhere import alone, borrowing, least, lending
from tests.reasoning.retrograde import Floor
from tests.reasoning.starts import Start, optima, starts

SIZE = (5, 3)
LONGEST = {1: 40, 2: 30}
"""By number of workers: starts that need more steps are left out. Alone nobody does."""
TOGETHER = 200
"""So many starts are asked of one program."""
TEAMS = [(workers, boxes) for boxes in (1, 2, 3) for workers in (1, 2)]
ASKED: list[tuple[Kind, int | None]] = [("alone", None), ("lend", None), ("lend", 10), ("borrow", 0), ("borrow", 8)]


def main() -> None:
    """Ends with code 1 if anything differs."""
    parser = argparse.ArgumentParser(prog="python -m bench.coverage", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--most", type=int, metavar="N", help="at most N starts of each kind, drawn with a seed")
    most = parser.parse_args().most
    print("workers boxes  question       starts  different   retrograde   planner", flush=True)
    wrong = 0
    for (workers, boxes), (kind, step) in ((team, asked) for team in TEAMS for asked in ASKED):
        if kind == "borrow" and workers > 1:  # retrograde analysis of three workers takes too much memory
            continue
        begun = cpu_s()
        known = truth(workers, boxes, kind, step)
        found_s = cpu_s() - begun
        chosen = Random(str((workers, boxes))).sample(sorted(known), min(most or len(known), len(known)))
        different = 0
        for n in range(0, len(chosen), TOGETHER):
            different += compare(chosen[n : n + TOGETHER], known, kind, step)
            print(f"{min(n + TOGETHER, len(chosen))} of {len(chosen)}", end="\r", file=sys.stderr, flush=True)
        wrong += different
        words = f"{kind} {'' if step is None else step}"
        seconds = f"{found_s:11.1f} s{cpu_s() - begun - found_s:9.1f} s"
        print(f"{workers:7}{boxes:6}  {words:12}{len(chosen):9}{different:11}{seconds}", flush=True)
    sys.exit(1 if wrong else 0)


def truth(workers: int, boxes: int, kind: Kind, step: int | None) -> dict[Start, int]:
    """The least makespan of every start that has a plan."""
    floor, longest = Floor(*SIZE, workers, boxes), LONGEST[workers]
    if kind == "alone":
        row = alone(floor, longest)
    else:
        row = lending(floor, longest, step) if kind == "lend" else borrowing(floor, longest, step or 0)
    every = {start: least(row, floor, start.workers, start.carrier) for start in starts(SIZE, workers, boxes)}
    return {start: steps for start, steps in every.items() if steps is not None}


def compare(chosen: list[Start], known: dict[Start, int], kind: Kind, step: int | None) -> int:
    """Of how many starts the planner's program finds another least makespan."""
    expected = [known[start] for start in chosen]
    low, guest = max(min(expected) - 1, 1), kind == "borrow"
    found = optima(chosen, kind, "plan", step=step, guest=guest, shortest=low)
    return sum(one != other for one, other in zip(found, expected, strict=True))


if __name__ == "__main__":
    main()
