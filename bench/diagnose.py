"""What a diagnosis costs and is worth: ``python -m bench.diagnose``, or ``muster bench diagnose``.

Drawn runs: robots that wander and work at random but legally, some of which break unseen; every break has an effect.

- *small*: 4 robots, 27 steps, 1 to 3 broken: one optimisation beside the published enumeration, one call of the solver
  for each set of robots and each prefix of the plan. Both must say the same. Where the enumeration does not finish
  within ``--limit`` seconds, the ratio is told as a lower bound.
- *large*: 20 robots, 50 steps, 3 broken: is the truth among the least explanations, and how many inspections does it
  take until one is left? A person inspects in arbitrary order: all robots of the run, or only those that are in some
  explanation but not in all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import mean, median
from typing import Any

from bench.measured import Options, Work, cpu_s, ignored, measured, options, serve, telling
from bus.clock import wall_s
from reasoning.diagnoser import broken_in, diagnose
from reasoning.enumeration import agrees, enumerated
from reasoning.inspection import arbitrary, tree
from tests.reasoning.drawn import Run
from tests.reasoning.drawn import run as draw
from tests.reasoning.simulator import needed

MODULE = "bench.diagnose"
SECTIONS = ("small", "large")
ABOUT = "Diagnoses of drawn runs."
Row = dict[str, Any]
LARGE_RUNS = 100


def run(chosen: Options | None = None, on_row: Callable[[str, Row], None] = ignored) -> dict[str, Any]:
    """Measure: seconds of processor time (`_s`), megabytes (`_mb`), expected numbers of inspections. `on_row` gets each
    row when it is there, with how many are broken, or ``large``."""
    chosen = chosen or options(SECTIONS, ABOUT)
    result: dict[str, Any] = {"limit_s": chosen.limit_s}
    with telling(result):
        if chosen.wants("small"):
            small = result["small"] = {}
            for broken in (1,) if chosen.quick else (1, 2, 3):
                _note(_small_tasks(broken, chosen), chosen, small, str(broken), _small, on_row)
        if chosen.wants("large"):
            tasks = [("large", {"seed": seed}) for seed in range(2 if chosen.quick else LARGE_RUNS)]
            _note(tasks, chosen, result, "large", _large, on_row)
    return result


def _note(
    tasks: Sequence[tuple[str, dict[str, Any]]],
    chosen: Options,
    rows: dict[str, Row],
    name: str,
    summed: Callable[[list[Row]], Row],
    on_row: Callable[[str, Row], None],
) -> None:
    """Note the row of these tasks, each run once; when somebody interrupts, of those that are done."""
    found: list[Row] = []
    try:
        measured(MODULE, tasks, chosen._replace(runs=1), found.append)
    finally:
        if len(found) > 1:
            rows[name] = summed(found)
            on_row(name, rows[name])


def _small_tasks(broken: int, chosen: Options) -> list[tuple[str, dict[str, Any]]]:
    """As many drawn runs as runs are wanted, each told by both."""
    drawn: list[dict[str, Any]] = [{"seed": seed, "broken": broken} for seed in range(chosen.runs)]
    both = [[("optimisation", run), ("enumeration", {**run, "limit_s": chosen.limit_s})] for run in drawn]
    return [task for pair in both for task in pair]


def _small(found: list[Row]) -> Row:
    """Medians; one that has no other yet is left out."""
    theirs = found[1::2]
    ours = found[::2][: len(theirs)]
    ratios = [other["cpu_s"] / one["cpu_s"] for one, other in zip(ours, theirs, strict=True)]
    return {
        "runs": len(ours),
        "optimisation": _spread([one["cpu_s"] for one in ours]),
        "enumeration": _spread([other["cpu_s"] for other in theirs]),
        "memory_mb": median(one["memory_mb"] for one in ours),
        "calls": median(other["calls"] for other in theirs),
        "ratio": median(ratios),
        "finished": sum(other["finished"] for other in theirs),
        "agreed": sum(other["agreed"] for other in theirs),
    }


def _large(rows: list[Row]) -> Row:
    return {
        "runs": len(rows),
        "optimisation": _spread([row["cpu_s"] for row in rows]),
        "memory_mb": median(row["memory_mb"] for row in rows),
        "truth_found": sum(row["truth"] for row in rows),
        "several_explanations": sum(row["explanations"] > 1 for row in rows),
        **{f"mean_{name}": mean(row[name] for row in rows) for name in ("expected", "arbitrary", "arbitrary_useful")},
    }


def _spread(seconds: Sequence[float]) -> dict[str, float]:
    return {"median_s": median(seconds), "least_s": min(seconds), "most_s": max(seconds)}


# ---------------------------------------------------------------- work, in processes of its own
def _four_robots(seed: int, broken: int) -> Run:
    return draw(seed, 3, 1, 27, broken)


def _optimisation(seed: int, broken: int) -> dict[str, Any]:
    case = _four_robots(seed, broken).case
    begun = cpu_s()
    found = diagnose(case)
    return {"cpu_s": cpu_s() - begun, "explanations": len(found.least)}


def _enumeration(seed: int, broken: int, limit_s: float) -> dict[str, Any]:
    case = _four_robots(seed, broken).case
    begun, end = cpu_s(), wall_s() + limit_s
    found = enumerated(case, stop=lambda: wall_s() > end)
    used_s = cpu_s() - begun
    agreed = agrees(case, diagnose(case), found)
    return {"cpu_s": used_s, "calls": found.calls, "finished": found.finished, "agreed": agreed}


def _one_large(seed: int) -> dict[str, Any]:
    drawn = draw(seed, 14, 6, 50, 3, size=(12, 6))
    begun = cpu_s()
    suspected = [broken_in(diagnosis) for diagnosis in diagnose(drawn.case).least]
    used_s = cpu_s() - begun
    robots = {robot for step in drawn.case.actions for action in step for robot in needed(action)}
    return {
        "cpu_s": used_s,
        "explanations": len(suspected),
        "truth": drawn.truth in map(frozenset, suspected),
        "expected": tree(suspected).expected,
        "arbitrary": arbitrary(suspected, among=len(robots)),
        "arbitrary_useful": arbitrary(suspected),
    }


WORK: dict[str, Work] = {"optimisation": _optimisation, "enumeration": _enumeration, "large": _one_large}


def main() -> None:
    """Measure and print, or do one piece of the work."""
    if serve(WORK):
        return
    chosen = options(SECTIONS, ABOUT)
    if chosen.wants("small"):
        head = "4 robots, 27 steps   one optimisation (range)   enumeration (range)       calls  ratio  agreed  memory"
        print(head, flush=True)
    run(chosen, _print_row)


def _print_row(name: str, row: Row) -> None:
    if name != "large":
        unfinished = "" if row["finished"] == row["runs"] else f"; {row['finished']} of {row['runs']} finished"
        print(
            f"{name} broken          {_words(row['optimisation'])}{_words(row['enumeration'])}{row['calls']:9.0f}"
            f"{'>' if unfinished else ' '}{row['ratio']:6.0f}{row['agreed']:5} of {row['runs']}"
            f"{row['memory_mb']:6.0f} MB{unfinished}",
            flush=True,
        )
        return
    print(f"20 robots, 50 steps, 3 broken: {row['runs']} runs")
    print(f"  one optimisation    {_words(row['optimisation'])}{row['memory_mb']:6.0f} MB")
    print(f"  truth among the least explanations   {row['truth_found']} of {row['runs']}")
    print(f"  more than one explanation            {row['several_explanations']} of {row['runs']}")
    print(f"  inspections to be expected           {row['mean_expected']:.2f}, on the average of all runs")
    for key, words in (("arbitrary", "all robots"), ("arbitrary_useful", "those worth it")):
        share = f", {row['mean_expected'] / row[f'mean_{key}']:.0%} of it" if row[f"mean_{key}"] else ""
        print(f"  in arbitrary order, {words:15}  {row[f'mean_{key}']:.2f}{share}", flush=True)


def _words(seconds: dict[str, float]) -> str:
    return f"{seconds['median_s']:8.2f} s ({seconds['least_s']:.2f} - {seconds['most_s']:.2f})".ljust(27)


if __name__ == "__main__":
    main()
