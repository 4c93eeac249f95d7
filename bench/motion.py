"""What motion queries cost: ``python -m bench.motion``, or ``muster bench motion``.

Drawn rooms of 8 x 8 m with nine pieces of furniture at any angle and eight things that are moved about. Exact
connectivity, beside shapely (grown polygons, their union and its parts) in the same run, if it is installed;
trajectories between all cells, as a planner with times wants them; a table carried by two robots. Processor time, of
each question the least of five repetitions.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable, Iterator
from itertools import combinations, product
from statistics import median
from typing import Any

from bench.measured import ignored, progress, telling
from bus.clock import wall_s
from reasoning.motion.connectivity import MARGIN_M, Connectivity
from reasoning.motion.convex import Point
from reasoning.motion.layout import Disc, Layout
from reasoning.motion.oracle import Oracle
from reasoning.motion.payload import PayloadPlanner
from reasoning.motion.rigid import carried

try:
    import shapely
except ImportError:
    shapely = None

ROOMS, ARRANGEMENTS, QUERIES = 60, 20, 40
SIDE_M, RADIUS_M, SPEED = 8.0, 0.25, 3.0
REPEATED = 5
SEED = 1


def run(rooms: int = ROOMS, on_part: Callable[[str, dict[str, Any]], None] = ignored) -> dict[str, Any]:
    """Measure; times in microseconds (`_us`) and milliseconds (`_ms`) of processor time, wall time for payloads.
    `on_part` gets the name of each of the three parts, and its figures, when they are there."""
    rng = random.Random(SEED)
    drawn = [Layout(SIDE_M, SIDE_M, _furniture(rng), _things(rng)) for _ in range(rooms)]
    parts: dict[str, Callable[[], dict[str, Any]]] = {
        "connectivity": lambda: _connectivity(rng, drawn),
        "trajectories": lambda: _trajectories(drawn[: rooms // 4]),
        "payload": lambda: _payload(rng, drawn[: rooms // 4]),
    }
    result: dict[str, Any] = {}
    with telling(result):
        for name, part in parts.items():
            progress(f"{name} in {rooms if name == 'connectivity' else rooms // 4} rooms")
            result[name] = part()
            on_part(name, result[name])
    return result


def _connectivity(rng: random.Random, drawn: list[Layout]) -> dict[str, Any]:
    """Queries for a new layout begin at a free point, so that nothing is left out. Points of others are anywhere."""
    costs: dict[str, list[float]] = {}

    def note(name: str, prepare: Callable[[], Any], ask: Callable[[Any], Any]) -> Any:
        cost, answer = _cost(prepare, ask)
        costs.setdefault(name, []).append(cost)
        return answer

    yes = 0
    for layout in drawn:
        known, q = Connectivity(layout, RADIUS_M), _point(rng)
        p = _free(rng, known)
        # A room that is a millimetre higher is a new one.
        higher = (Layout(SIDE_M, SIDE_M + k / 1000, layout.polygons, layout.discs) for k in range(1, REPEATED + 1))
        note("new_room_ms", lambda r=higher: next(r), lambda r, p=p, q=q: Connectivity(r, RADIUS_M).path_exists(p, q))
        for _ in range(ARRANGEMENTS):
            d, q = _things(rng), _point(rng)
            p = _free(rng, known.with_discs(d))
            note("things_moved_ms", lambda: None, lambda _, k=known, d=d, p=p, q=q: k.with_discs(d).path_exists(p, q))
        fresh = [Connectivity(layout, RADIUS_M) for _ in range(REPEATED)]
        p = _free(rng, known)
        for one in fresh:
            one.path_exists(p, p)
        parts = shapely and note("shapely_new_room_ms", lambda: None, lambda _, layout=layout: _parts(layout))
        for _ in range(QUERIES):
            p, q = _point(rng), _point(rng)
            turn = iter(fresh)
            yes += note("query_us", lambda turn=turn: next(turn), lambda one, p=p, q=q: one.path_exists(p, q))
            note("query_again_us", lambda fresh=fresh: fresh[0], lambda one, p=p, q=q: one.path_exists(p, q))
            if shapely is not None:
                note("shapely_query_us", lambda: None, lambda _, p=p, q=q, parts=parts: _together(parts, p, q))
    units = {"us": 1e-3, "ms": 1e-6}
    figures: dict[str, Any] = {name: _spread(spent, units[name[-2:]]) for name, spent in costs.items()}
    figures["with_a_path"] = yes / len(costs["query_us"])
    for ours, theirs in (("new_room_ms",) * 2, ("things_moved_ms", "new_room_ms"), ("query_us",) * 2):
        if shapely is not None:
            figures[f"ratio_{ours}"] = median(costs[ours]) / median(costs[f"shapely_{theirs}"])
    return figures


def _free(rng: random.Random, known: Connectivity) -> Point:
    return next(p for p in iter(lambda: _point(rng), None) if known.free(p))


def _parts(layout: Layout) -> list[Any]:
    grown = RADIUS_M + MARGIN_M
    solid = [shapely.Polygon(p).buffer(grown) for p in layout.polygons]
    solid += [shapely.Point(x, y).buffer(r + grown) for x, y, r in layout.discs]
    inner = shapely.box(grown, grown, layout.width_m - grown, layout.height_m - grown)
    parts = list(shapely.get_parts(inner.difference(shapely.union_all(solid))))
    shapely.prepare(parts)
    return parts


def _together(parts: list[Any], p: Point, q: Point) -> bool:
    return any(shapely.contains_xy(part, *p) and shapely.contains_xy(part, *q) for part in parts)


def _trajectories(drawn: list[Layout]) -> dict[str, Any]:
    cells = [(x + 0.5, y + 0.5) for x, y in product(range(int(SIDE_M)), repeat=2)]
    costs, found, single = [], 0, []
    for layout in drawn:

        def all_pairs(oracle: Oracle, room: Layout = layout.bare) -> int:
            times = (oracle.time_estimate(room, RADIUS_M, p, q, SPEED) for p, q in combinations(cells, 2))
            return sum(estimate is not None for estimate in times)

        cost, count = _cost(Oracle, all_pairs)
        costs.append(cost)
        found += count
        far = (cells[0], cells[-1])
        single.append(_cost(Oracle, lambda new, layout=layout, far=far: new.shortest(layout, RADIUS_M, *far))[0])
    return {
        "all_pairs_of_64_cells_ms": _spread(costs, 1e-6),
        "with_a_path": found / len(drawn) / math.comb(len(cells), 2),
        "one_in_a_new_layout_ms": _spread(single, 1e-6),
    }


def _payload(rng: random.Random, drawn: list[Layout]) -> dict[str, Any]:
    body = carried(1.0, RADIUS_M, 0.1)
    costs: dict[str, list[float]] = {"yes": [], "no": [], "undecided": []}
    with PayloadPlanner(Oracle()) as planner:
        planner.path(drawn[0], body, (*_point(rng), 0.0), (*_point(rng), 0.0))
        for layout in drawn:
            for _ in range(6):
                start, goal = ((*_point(rng), rng.uniform(-math.pi, math.pi)) for _ in range(2))
                begun = wall_s()
                answer = planner.path(layout, body, start, goal)
                costs[answer.verdict].append(wall_s() - begun)
    return {verdict: {"count": len(spent), "ms": _spread(spent, 1e3)} for verdict, spent in costs.items() if spent}


def _cost(prepare: Callable[[], Any], ask: Callable[[Any], Any]) -> tuple[float, Any]:
    """Nanoseconds of processor time of asking about what was prepared, the least of some repetitions, since other
    work on the machine makes the others longer; and the answer."""
    least = math.inf
    for _ in range(REPEATED):
        prepared = prepare()
        begun = time.thread_time_ns()
        answer = ask(prepared)
        least = min(least, time.thread_time_ns() - begun)
    return least, answer


def _spread(costs: list[float], unit: float) -> dict[str, float]:
    ordered = sorted(costs)
    return {
        "median": unit * median(ordered),
        "p99": unit * ordered[99 * (len(ordered) - 1) // 100],
        "max": unit * ordered[-1],
    }


def _point(rng: random.Random) -> Point:
    return rng.uniform(0.3, SIDE_M - 0.3), rng.uniform(0.3, SIDE_M - 0.3)


def _furniture(rng: random.Random) -> tuple[tuple[Point, ...], ...]:
    def pieces() -> Iterator[tuple[Point, ...]]:
        for _ in range(9):
            x, y, angle = *_point(rng), rng.uniform(0, math.pi)
            long, wide = rng.uniform(0.4, 2.2), rng.uniform(0.2, 0.9)
            c, s = math.cos(angle) / 2, math.sin(angle) / 2
            corners = ((-long, -wide), (long, -wide), (long, wide), (-long, wide))
            yield tuple((x + c * u - s * v, y + s * u + c * v) for u, v in corners)

    return tuple(pieces())


def _things(rng: random.Random) -> tuple[Disc, ...]:
    return tuple((*_point(rng), rng.uniform(0.05, 0.2)) for _ in range(8))


ROW = "{:34}{:10.2f} {unit}{:10.2f} {unit}{:10.2f} {unit}"


def main() -> None:
    """Measure and print."""
    print(f"{'connectivity of a disc':34}{'median':>13}{'p99':>13}{'max':>13}", flush=True)
    run(on_part=lambda name, found: print(*TOLD[name](found), sep="\n", flush=True))


def _connectivity_told(found: dict[str, Any]) -> Iterator[str]:
    for name, key in (
        ("a new room", "new_room_ms"),
        ("things moved", "things_moved_ms"),
        ("a query", "query_us"),
        ("the same again", "query_again_us"),
        ("shapely: a new room", "shapely_new_room_ms"),
        ("shapely: a query", "shapely_query_us"),
    ):
        if key in found:
            yield ROW.format(f"  {name}", *found[key].values(), unit=key[-2:])
    ratios = [value for name, value in found.items() if name.startswith("ratio_")]
    if ratios:
        yield "  of shapely's medians: new room {:.2f}, things moved {:.2f}, query {:.2f}".format(*ratios)
    yield f"  {100 * found['with_a_path']:.0f} % of the queries with a path"


def _trajectories_told(found: dict[str, Any]) -> Iterator[str]:
    yield "trajectories"
    yield ROW.format("  all pairs of 64 cells", *found["all_pairs_of_64_cells_ms"].values(), unit="ms")
    yield ROW.format("  one in a new layout", *found["one_in_a_new_layout_ms"].values(), unit="ms")


def _payload_told(found: dict[str, Any]) -> Iterator[str]:
    yield "a table of 1 m carried by two robots (wall time)"
    for verdict, spent in found.items():
        yield ROW.format(f"  {verdict:10} {spent['count']:4} times", *spent["ms"].values(), unit="ms")


TOLD = {"connectivity": _connectivity_told, "trajectories": _trajectories_told, "payload": _payload_told}


if __name__ == "__main__":
    main()
