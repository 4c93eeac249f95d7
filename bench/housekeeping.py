"""What does geometry inside planning cost, and what does it save? ``muster bench housekeeping``.

Seeded problems of the seventeen published sizes in a room of 8 x 8 cells, each solved to a proven shortest plan with
geometry at each of the four levels: seconds of planning, questions about motion, and replans until the plan can be
executed, every step that is refuted being forbidden in the searches that follow. The yardstick is a plain encoding
(``reference.lp``), with everything worked out before the search. Each figure is processor time in one thread, from a
fresh process; only draws whose shortest plan is as long as published are kept. What does not end within ``--limit``
seconds of the clock is told with a lower bound.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from bench.measured import Options, Work, cpu_s, measured, options, serve
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
DRAWS = 200


def run(chosen: Options | None = None) -> dict[str, Any]:
    """Measure: seconds of processor time for planning, all replans together (`planning_s`), questions about motion,
    and replans."""
    chosen = chosen or options(SECTIONS, "Geometry inside planning, at four levels.")
    sizes = SIZES[:4] if chosen.quick else SIZES
    chosen = chosen._replace(runs=min(chosen.runs, 3))
    draws = measured(MODULE, [("draw", {"size": list(size)}) for size in sizes], chosen._replace(runs=1))
    sections = [section for section in SECTIONS if chosen.wants(section)]
    tasks = [
        ("reference" if section == "reference" else "level",
         {"size": list(size), "seed": draw["seed"], "limit_s": chosen.limit_s}
         | ({} if section == "reference" else {"level": section}))
        for size, draw in zip(sizes, draws, strict=True)
        for section in sections
    ]  # fmt: skip
    figures = iter(measured(MODULE, tasks, chosen))
    rows = [
        {"size": list(size), "seed": draw["seed"], **{section: next(figures) for section in sections}}
        for size, draw in zip(sizes, draws, strict=True)
    ]
    totals = {section: sum(row[section]["planning_s"] for row in rows) for section in sections}
    return {"limit_s": chosen.limit_s, "problems": rows, "total_s": totals}


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
    begun, used, replans, status = wall_s(), cpu_s(), 0, "optimal"
    first = drawn = problem(Size(*size), seed, level)
    assert drawn is not None
    assert first is not None
    room = known_room(drawn)
    while True:
        found = Planner(drawn, clock=wall_s).shortest(seconds=limit_s - (wall_s() - begun))
        if found.plan is None:
            status = found.status
            break
        refuted = _refuted(first, found.plan)
        if not refuted:
            break
        replans += 1
        drawn = _forbidding(drawn, refuted)
    planning_s = cpu_s() - used
    queries = lessons(room).asked if level in ("interleaved", "both") else 0
    queries += sum(fact.startswith("path(") for fact in room_facts(room)) // 2
    steps = found.plan.makespan if found.plan else found.lower_bound
    ok = found.plan is not None and not check(
        DOMAIN, first.static, {"T1": first.state}, {"T1": found.plan.steps}, details={"T1": found.plan.details}
    )
    return {
        "status": status, "steps": steps, "planning_s": planning_s, "replans": replans, "queries": queries,
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
    used = cpu_s()
    drawn = problem(Size(*size), seed, "static")
    assert drawn is not None
    found = reference.shortest(drawn, seconds=limit_s, clock=wall_s)
    told = {"status": found.status, "steps": found.lower_bound, "conflicts": found.conflicts}
    return {**told, "planning_s": cpu_s() - used}


WORK: dict[str, Work] = {"draw": _draw, "level": _level, "reference": _reference}


def main() -> None:
    """Measure and print, or do one piece of the work."""
    if serve(WORK):
        return
    result = run()
    sections = list(result["total_s"])
    print("planning, replans included: seconds / questions about motion / replans; refused: the checker has objections")
    print("robots things steps" + "".join(f"{section:>22}" for section in sections))
    for row in result["problems"]:
        print("{:6}{:7}{:6}".format(*row["size"]) + "".join(f"{_words(row[section]):>22}" for section in sections))
    print(" " * 19 + "".join(f"{result['total_s'][section]:20.1f} s" for section in sections))


def _words(figures: dict[str, Any]) -> str:
    seconds = f"{figures['planning_s']:.1f}" if figures["status"] == "optimal" else f">{figures['planning_s']:.0f}"
    if "replans" not in figures:
        return f"{seconds} s"
    refused = "" if figures["checked"] else " refused"
    return f"{seconds} s /{figures['queries']:5} /{figures['replans']:3}{refused}"


if __name__ == "__main__":
    main()
