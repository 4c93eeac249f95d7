"""How fast is one team's planner? ``python -m bench.plan``, or ``muster bench plan``.

Shortest plans with proof for one team of 1 to 3 workers and 3 to 6 boxes, by the planner and by the plain reference
encoding (``reference.lp``), which is the yardstick: seconds of processor time in one thread, each in a fresh process.
The workers start as published: w1 a painter at (1,3), w2 a stamper at (1,2), w3 a waxer at (1,1); the carrier at (1,1).
Where the reference does not finish within ``--limit`` seconds, the ratio is told as a lower bound.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from statistics import median
from typing import Any

from bench.measured import Options, Work, ignored, measured, options, serve, telling
from bench.teams import team
from bus.clock import wall_s
from reasoning import reference
from reasoning.planner import Planner
from reasoning.values import Found

MODULE = "bench.plan"
SECTIONS = ("planner", "reference")
ABOUT = "Shortest plans of one team, with proof."
WORKERS = (((1, 3), 1), ((1, 2), 3), ((1, 1), 2))
Row = dict[str, Any]
"""Figures of one team: ``workers``, ``boxes``, by section what it took, and the ratio if there are both sections."""


def run(chosen: Options | None = None, on_row: Callable[[Row], None] = ignored) -> dict[str, Any]:
    """Measure: seconds (`_s`), megabytes (`_mb`), solver conflicts, and ratios of the reference's to our seconds.
    `on_row` gets each row when it is there."""
    chosen = chosen or options(SECTIONS, ABOUT)
    sizes = [(1, 1), (2, 1)] if chosen.quick else list(product((1, 2, 3), (3, 4, 5, 6)))
    sections = [section for section in SECTIONS if chosen.wants(section)]
    tasks = [(section, _task(section, *size, chosen.limit_s)) for size in sizes for section in sections]
    rows: list[Row] = []
    found: list[dict[str, Any]] = []

    def note(figures: dict[str, Any]) -> None:
        found.append(figures)
        if len(found) == len(sections):
            rows.append(_row(*sizes[len(rows)], dict(zip(sections, found, strict=True))))
            found.clear()
            on_row(rows[-1])

    result: dict[str, Any] = {"limit_s": chosen.limit_s, "teams": rows}
    with telling(result):
        measured(MODULE, tasks, chosen, note)
    ratios = [row["ratio"] for row in rows if "ratio" in row]
    return {**result, **({"median_ratio": median(ratios)} if ratios else {})}


def _row(workers: int, boxes: int, figures: dict[str, Any]) -> Row:
    row = {"workers": workers, "boxes": boxes, **figures}
    if len(figures) == len(SECTIONS):
        row |= {"ratio": _ratio(row), "ratio_is_at_least": row["reference"]["status"] != "optimal"}
    return row


def _task(section: str, workers: int, boxes: int, limit_s: float) -> dict[str, Any]:
    return {"workers": workers, "boxes": boxes, **({"limit_s": limit_s} if section == "reference" else {})}


def _ratio(row: dict[str, Any]) -> float:
    """Of seconds of processor time; of a reference that did not finish, of those that it had."""
    return float(row["reference"]["cpu_s"] / row["planner"]["cpu_s"])


# ---------------------------------------------------------------- work, in processes of its own
def _planner(workers: int, boxes: int) -> dict[str, Any]:
    return _told(Planner(team(WORKERS[:workers], boxes, guest=False)).shortest())


def _reference(workers: int, boxes: int, limit_s: float) -> dict[str, Any]:
    return _told(reference.shortest(team(WORKERS[:workers], boxes, guest=False), seconds=limit_s, clock=wall_s))


def _told(found: Found) -> dict[str, Any]:
    return {"status": found.status, "steps": found.lower_bound, "conflicts": found.conflicts}


WORK: dict[str, Work] = {"planner": _planner, "reference": _reference}


def main() -> None:
    """Measure and print, or do one piece of the work."""
    if serve(WORK):
        return
    chosen = options(SECTIONS, ABOUT)
    head = "workers boxes  steps   planner (range)       conflicts  memory   reference     conflicts     ratio"
    print(head, flush=True)
    result = run(chosen, lambda row: _print_row(row, chosen.limit_s))
    if "median_ratio" in result:
        print(f"median of the ratios: {result['median_ratio']:.1f}")


def _print_row(row: Row, limit_s: float) -> None:
    print(f"{row['workers']:7}{row['boxes']:6}{_planner_words(row)}{_reference_words(row, limit_s)}", flush=True)


def _planner_words(row: dict[str, Any]) -> str:
    if (ours := row.get("planner")) is None:
        return " " * 54
    low, high = ours["cpu_s_range"]
    steps = ours["steps"] if ours["status"] == "optimal" else f">{ours['steps'] - 1}"
    seconds = f"{ours['cpu_s']:8.2f} s ({low:.2f} - {high:.2f})"
    return f"{steps:>7}{seconds:<28}{ours['conflicts']:>8}{ours['memory_mb']:6.0f} MB"


def _reference_words(row: dict[str, Any], limit_s: float) -> str:
    if (plain := row.get("reference")) is None:
        return ""
    if plain["status"] != "optimal":
        words = f"   not in {limit_s:.0f} s: {plain['steps'] - 1} steps refuted"
        return words + (f"   > {row['ratio']:.0f}" if "ratio" in row else "")
    ratio = f"{row['ratio']:10.1f}" if "ratio" in row else ""
    return f"{plain['cpu_s']:10.2f} s{plain['conflicts']:14}{ratio}"


if __name__ == "__main__":
    main()
