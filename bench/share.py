"""What sharing robots costs: ``python -m bench.share``, or ``muster bench share``.

Everything that the coordinator and the teams compute, in one process without a bus: questions, answers, matching. Teams
answer at the same time, each with a solver of its own; processor time is that of all together.

- *four teams*: the published set-up, from a cold start: the shared optimum with its proof.
- *broken carrier*: the published run after T4's carrier broke: until the first shared plan, and until the optimum.
- *drawn*: 4 to 32 drawn teams, a quarter of which must borrow.
- *one program*: the models of all four teams in one plain program (``monolith.lp``), as far as it comes.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from statistics import median
from typing import Any

from bench import teams
from bench.measured import Options, Work, ignored, measured, options, serve, telling
from bus.clock import wall_s
from reasoning import reference
from reasoning.planner import Planner
from reasoning.sharing import Asking, Known, advance
from reasoning.values import Answer

MODULE = "bench.share"
SECTIONS = ("four_teams", "broken_carrier", "drawn", "one_program")
ABOUT = "Shared plans of several teams, with proof."
SIZES, QUICK_SIZES = (4, 8, 16, 32), (2,)
Row = dict[str, Any]
NUMBERS = ("steps", "loans", "questions", "conflicts", "first_s", "wall_s", "cpu_s", "memory_mb")


def run(chosen: Options | None = None, on_row: Callable[[str, Row], None] = ignored) -> dict[str, Any]:
    """Measure: seconds (`_s`), megabytes (`_mb`), solver conflicts, questions. `on_row` gets each row when it is there,
    with its name for people."""
    chosen = chosen or options(SECTIONS, ABOUT)
    result: dict[str, Any] = {"limit_s": chosen.limit_s}
    with telling(result):
        for section in (section for section in SECTIONS if chosen.wants(section)):
            if section == "drawn":
                result[section] = {}
                for size in QUICK_SIZES if chosen.quick else SIZES:
                    rows: list[Row] = []
                    try:
                        _draw(size, chosen, rows)
                    finally:  # of those that there are, when somebody interrupts
                        if rows:
                            result[section][str(size)] = _medians(rows)
                            on_row(f"{size} drawn teams", result[section][str(size)])
            else:
                given = {"limit_s": chosen.limit_s} if section == "one_program" else {}
                result[section] = measured(MODULE, [(section, given)], chosen)[0]
                on_row(section.replace("_", " "), result[section])
    return result


def _draw(size: int, chosen: Options, rows: list[Row]) -> None:
    """As many draws as runs are wanted, but no further one once they have taken `chosen.limit_s`."""
    while len(rows) < chosen.runs and sum(row["wall_s"] for row in rows) < chosen.limit_s:
        rows += measured(MODULE, [("drawn", {"seed": len(rows), "count": size})], chosen._replace(runs=1))


def _medians(rows: list[Row]) -> Row:
    figures = {name: median(row[name] for row in rows) for name in NUMBERS}
    spread = [row["cpu_s"] for row in rows]
    proved = sum(row["status"] == "optimal" for row in rows)
    return {**figures, "cpu_s_range": [min(spread), max(spread)], "proved": proved, "runs": len(rows)}


# ---------------------------------------------------------------- work, in processes of its own
def share(given: teams.Teams) -> dict[str, Any]:
    """The search for the shared plan, and when it had its first plan."""
    begun, first_s = wall_s(), None
    with ThreadPoolExecutor() as pool:
        planners = {name: Planner(problem) for name, problem in given.problems.items()}
        bounds = {name: planner.lower_bound() for name, planner in planners.items()}
        ledgers = {name: given.ledger(name, bound) for name, bound in bounds.items()}
        asked = conflicts = 0
        while isinstance(result := advance(ledgers, int(teams.STATIC["delay"]), given.bench), Asking):
            if result.so_far.roles and first_s is None:
                first_s = wall_s() - begun
            named = sorted(result.questions.items())
            answers = pool.map(lambda item: planners[item[0]].answer(item[1]), named)
            for (name, _), answer in zip(named, answers, strict=True):
                ledgers[name] = ledgers[name].learn(_known(answer))
                asked, conflicts = asked + 1, conflicts + answer.conflicts
    end_s = wall_s() - begun
    return {
        "status": result.status,
        "steps": result.makespan,
        "bound": result.lower_bound,
        "loans": len(result.loans),
        "questions": asked,
        "conflicts": conflicts,
        "first_s": end_s if first_s is None else first_s,
    }


def _known(answer: Answer) -> Known:
    plan = answer.plan
    finish, at = (plan.makespan, plan.exchange[1] if plan.exchange else 0) if plan else (0, 0)
    return Known(answer.question, answer.verdict, finish, at, answer.conflicts)


def _one_program(limit_s: float) -> dict[str, Any]:
    problems = {name.lower(): problem for name, problem in teams.published().problems.items()}
    found = reference.joint(problems, seconds=limit_s, clock=wall_s)
    return {"status": found.status, "bound": found.lower_bound, "conflicts": found.conflicts}


WORK: dict[str, Work] = {
    "four_teams": lambda: share(teams.published()),
    "broken_carrier": lambda: share(teams.broken_carrier()),
    "one_program": _one_program,
    "drawn": lambda seed, count: share(teams.drawn(seed, count)),
}


def main() -> None:
    """Measure and print, or do one piece of the work."""
    if serve(WORK):
        return
    chosen = options(SECTIONS, ABOUT)
    head = (
        "                 steps  loans  questions  conflicts  first plan     proved  processor time (range)    memory"
    )
    print(head, flush=True)
    run(chosen, lambda name, row: print(_words(name, row, chosen.limit_s), flush=True))


def _words(name: str, row: Row, limit_s: float) -> str:
    if name == "one program":
        words = f"{row['bound']} steps" if row["status"] == "optimal" else f"not finished in {limit_s:.0f} s"
        return (
            f"one program for all four teams: {words}; {row['bound'] - 1} steps refuted, {row['conflicts']} conflicts"
        )
    counts = f"{row['steps']:7.0f}{row['loans']:7.0f}{row['questions']:11.0f}{row['conflicts']:11.0f}"
    low, high = row["cpu_s_range"]
    seconds = f"{row['first_s']:10.2f} s{row['wall_s']:9.2f} s{row['cpu_s']:10.2f} s {f'({low:.2f} - {high:.2f})':15}"
    return f"{name:15}{counts}{seconds}{row['memory_mb']:5.0f} MB{row['runs']:5} runs"


if __name__ == "__main__":
    main()
