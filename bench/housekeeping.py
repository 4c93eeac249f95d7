"""What does geometry inside planning cost, and what does it save? ``muster bench housekeeping``.

Seeded problems of the seventeen published sizes in a room of 8 x 8 cells, each solved to a proven shortest plan with
geometry at each of the four levels: seconds of planning, questions about motion, and replans until the plan can be
executed, every step that is refuted being forbidden in the searches that follow. The yardstick is a plain encoding
(``reference.lp``), with everything worked out before the search. Each figure is processor time in one thread, from a
fresh process; only draws whose shortest plan is as long as published are kept. What does not end within ``--limit``
seconds of the clock is told with a lower bound.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from bench.measured import Options, Work, cpu_s, ignored, measured, options, serve, telling
from bench.rooms import DOMAIN, SIZES, Size, known_room, problem
from bus.clock import wall_s
from reasoning import reference
from reasoning.checker import check
from reasoning.geometry import Cell, cell, lessons, middle, room_facts
from reasoning.motion.oracle import Oracle
from reasoning.planner import Planner
from reasoning.solver import parse
from reasoning.values import Plan, Problem

MODULE = "bench.housekeeping"
LEVELS = ("none", "static", "interleaved", "both")
SECTIONS = (*LEVELS, "reference")
ABOUT = "Geometry inside planning, at four levels."
TARGET = "both"
DRAWS = 200
Row = dict[str, Any]
"""Figures of one size: ``size``, ``seed``, and by section what it took."""


def run(chosen: Options | None = None, on_row: Callable[[Row], None] = ignored) -> dict[str, Any]:
    """Measure: seconds of processor time for planning, all replans together (`planning_s`), the same by the clock
    (`planning_wall_s`), questions about motion, and replans. `on_row` gets the figures of each size when they are
    there."""
    chosen = chosen or options(SECTIONS, ABOUT)
    chosen = chosen._replace(runs=min(chosen.runs, 3))
    sections = [section for section in SECTIONS if chosen.wants(section)]
    rows: list[Row] = []
    result = {"limit_s": chosen.limit_s, "problems": rows}
    with telling(result):
        for size in SIZES[:4] if chosen.quick else SIZES:
            seed = measured(MODULE, [("draw", {"size": list(size)})], chosen._replace(runs=1))[0]["seed"]
            order = sorted(sections, key=lambda section: section in LEVELS)  # what takes longest begins first
            figures = measured(MODULE, [_task(section, size, seed, chosen.limit_s) for section in order], chosen)
            rows.append({"size": list(size), "seed": seed, **dict(zip(order, figures, strict=True))})
            on_row(rows[-1])
    return {**result, "total_s": {section: sum(row[section]["planning_s"] for row in rows) for section in sections}}


def _task(section: str, size: Size, seed: int, limit_s: float) -> tuple[str, dict[str, Any]]:
    told = {"size": list(size), "seed": seed, "limit_s": limit_s}
    return ("reference", told) if section == "reference" else ("level", {**told, "level": section})


# ---------------------------------------------------------------- work, in processes of its own
def _draw(size: list[int]) -> dict[str, Any]:
    """The first draw with a shortest plan of the wanted length, every question of geometry answered."""
    wanted = Size(*size)
    for seed in range(DRAWS):
        drawn = problem(wanted, seed, "both")
        if drawn is None or (planner := Planner(drawn)).hopeless() or planner.lower_bound() != wanted.steps:
            continue
        found = planner.shortest(conflicts=200_000)
        if found.plan is not None and found.plan.makespan == wanted.steps:
            return {"seed": seed}
    raise RuntimeError(f"no draw of {wanted} among {DRAWS}")


def _level(size: list[int], seed: int, level: str, limit_s: float) -> dict[str, Any]:
    begun, used, replans = wall_s(), cpu_s(), 0
    first = drawn = problem(Size(*size), seed, level)
    assert drawn is not None
    assert first is not None
    room = known_room(drawn)
    while True:
        found = Planner(drawn, clock=wall_s).shortest(seconds=limit_s - (wall_s() - begun))
        refuted = _refuted(first, found.plan) if found.status == "optimal" and found.plan else []
        if not refuted:
            break
        replans += 1
        drawn = _forbidding(drawn, refuted)
    spent = {"planning_s": cpu_s() - used, "planning_wall_s": wall_s() - begun}
    queries = lessons(room).asked if level in ("interleaved", "both") else 0
    queries += sum(fact.startswith("path(") for fact in room_facts(room)) // 2
    steps = found.plan.makespan if found.plan else found.lower_bound
    ok = found.plan is not None and not check(
        DOMAIN, first.static, {"T1": first.state}, {"T1": found.plan.steps}, details={"T1": found.plan.details}
    )
    return {
        "status": found.status, "steps": steps, **spent, "replans": replans, "queries": queries,
        "conflicts": found.conflicts, "checked": ok,
    }  # fmt: skip


Refuted = tuple[Cell, Cell, dict[str, Cell]]


def _refuted(drawn: Problem, plan: Plan) -> list[Refuted]:
    """The steps of a plan that cannot be executed: from, to, and what is in the way, ends of things by name."""
    room, oracle, found = known_room(drawn), Oracle(), []
    for step, actions in enumerate(plan.steps):
        before, after = plan.states[step], plan.states[step + 1]
        ends = {f: cell(v) for f, v in before.items() if f.startswith("at(") and f"kind({f[3:]}" in before}
        still = {f: c for f, c in ends.items() if cell(after[f]) == c}
        for action in actions:
            name, args = parse(action)
            if name != "goto":
                continue
            start, end = cell(before[f"at({args[0]})"]), cell(after[f"at({args[0]})"])
            near = {f: c for f, c in still.items() if c not in (start, end)}
            layout = room.layout.with_discs([room.thing(c) for c in near.values()])
            blockers = oracle.blockers(layout, room.robot_m, middle(start), middle(end))
            if blockers is not None:
                names = list(near)
                found.append((start, end, {names[i][3:-1]: near[names[i]] for i in blockers}))
    return found


def _forbidding(drawn: Problem, refuted: list[Refuted]) -> Problem:
    static = dict(drawn.static)
    for start, end, things in refuted:
        number = sum(key.startswith("refuted(") and "," not in key for key in static)
        static[f"refuted({number})"] = f"(({start[0]},{start[1]}),({end[0]},{end[1]}))"
        static |= {f"refuted({number},({name},1))": f"({c[0]},{c[1]})" for name, c in things.items()}
    return replace(drawn, static=static)


def _reference(size: list[int], seed: int, limit_s: float) -> dict[str, Any]:
    begun, used = wall_s(), cpu_s()
    drawn = problem(Size(*size), seed, "static")
    assert drawn is not None
    found = reference.shortest(drawn, seconds=limit_s, clock=wall_s)
    told = {"status": found.status, "steps": found.lower_bound, "conflicts": found.conflicts}
    return {**told, "planning_s": cpu_s() - used, "planning_wall_s": wall_s() - begun}


WORK: dict[str, Work] = {"draw": _draw, "level": _level, "reference": _reference}


def main() -> None:
    """Measure and print, or do one piece of the work."""
    if serve(WORK):
        return
    chosen = options(SECTIONS, ABOUT)
    print("planning, replans included: seconds of processor time / questions about motion / replans")
    print("> : it did not end within the limit; refused: the checker has objections to the plan")
    print("robots things steps" + "".join(f"{section:>24}" for section in SECTIONS), flush=True)
    result = run(chosen, _print_row)
    rows, totals = result["problems"], result["total_s"]
    ended = {section: all(row[section]["status"] == "optimal" for row in rows) for section in totals}
    words = {section: f"{'' if ended[section] else '> '}{total:.1f} s" for section, total in totals.items()}
    print("all together       " + "".join(f"{words.get(section, ''):>24}" for section in SECTIONS))
    if TARGET in totals:
        _print_targets([row[TARGET] for row in rows])


def _print_row(row: Row) -> None:
    cells = (_words(row[section]) if section in row else "" for section in SECTIONS)
    print("{:6}{:7}{:6}".format(*row["size"]) + "".join(f"{cell:>24}" for cell in cells), flush=True)


def _words(figures: dict[str, Any]) -> str:
    seconds = f"{'' if figures['status'] == 'optimal' else '> '}{figures['planning_s']:.1f} s"
    if "replans" not in figures:
        return seconds
    refused = " refused" if figures["status"] == "optimal" and not figures["checked"] else ""
    return f"{seconds} /{figures['queries']:5} /{figures['replans']:3}{refused}"


def _print_targets(figures: list[dict[str, Any]]) -> None:
    """Of the level that has targets, beside them."""
    for name, what in (("planning_s", "of processor time"), ("planning_wall_s", "by the clock")):
        seconds = [each[name] for each in figures]
        print(f"{TARGET}: longest {max(seconds):.1f} s (target 10), all {sum(seconds):.1f} s (target 90) {what}")
    print(f"{TARGET}: {sum(each['replans'] for each in figures)} replans (target 0)")


if __name__ == "__main__":
    main()
