"""General sharing, as ``muster plan`` does it: the optimum of one plain program that knows all teams, and never worse
than the published scheme."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import msgspec
import pytest

from agents.setups import CoordinatorSetup, TeamSetup
from bus.scene import Scene, Transport
from ops import shares
from ops.compile import compile_scenario, start
from ops.planning import solve
from ops.scenario import Scenario, parse
from ops.scenario import load as load_scenario
from reasoning.domain import load
from reasoning.solver import Program

DOMAIN = "factory"
MONOLITH = [load(DOMAIN).folder / f"monolith_{part}.lp" for part in ("state", "rules")]
W1 = {"name": "w1", "at": [1, 1], "effector": 1}
TOP = {"name": "w1", "at": [1, 2], "effector": 1}
C1 = {"name": "c1", "at": [1, 1]}
PATIENT = 30
AGREEING = (1, 3, 5, 9, 10, 24, 28)
NOT_BACK = Path(__file__).with_name("joint_not_back.lp")


def team(boxes: int, *workers: dict[str, Any], carrier: dict[str, Any] | None = C1) -> dict[str, Any]:
    given = [{**worker, "name": f"w{n}"} for n, worker in enumerate(workers, 1)]
    return {"boxes": boxes, "workers": given, **({"carrier": carrier} if carrier else {})}


def scenario(*teams: dict[str, Any], width: int = 2, sharing: str = "general", **exchange: Any) -> Scenario:
    table = {
        "story": "A test.",
        "domain": DOMAIN,
        "floor": {"width": width, "height": 2},
        "exchange": {"delay": 1, "sharing": sharing, **exchange},
        "teams": {f"T{n}": given for n, given in enumerate(teams, 1)},
    }
    return parse(table, Path("test.toml"))


def joint(given: Scenario, patient: int = PATIENT, *more: Path) -> int | None:
    """The least makespan by one program for all teams, to which `more` may be added; None: more than `patient`."""
    setup = start(given)
    facts = [f"static({key},{value})." for key, value in setup.static.items()]
    for name, problem in shares.problems(load(DOMAIN), setup).items():
        small = name.lower()
        facts += [f'name({small},"{name}").', *(f"init({small},{f},{v})." for f, v in problem.state.items())]
        facts += [f"guest({small},{guest},{kind})." for guest, kind in problem.guests]
        facts += [f"guest({small},{guest})." for guest, kind in problem.guests if kind != "carrier"]
    program = Program([*MONOLITH, Path(__file__).with_name("joint_share.lp"), *more], facts)
    for within in range(patient + 1):
        program.ground(("step", (within,)) if within else ("base", ()))
        if program.solve([("last", (t,), t == within) for t in range(within + 1)]).satisfiable:
            return within
    return None


HELPER = team(0, W1)
FIXED = {**W1, "effector": 3, "fixed": 1}
SHARED = {
    "two workers of two teams": scenario(team(1, TOP), HELPER, HELPER),
    "a carrier is lent": scenario(team(1, W1, carrier=None), team(0)),
    "a fixed stamper helps": scenario(team(1, TOP), team(0, FIXED)),
    "delays differ by pair": scenario(
        team(1, TOP),
        HELPER,
        HELPER,
        delays=[{"from": "T2", "to": "T1", "steps": 4}, {"from": "T3", "to": "T1", "steps": 2}],
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SHARED)
def test_the_optimum_is_that_of_one_program_for_all_teams(name: str) -> None:
    found = solve(SHARED[name], lambda _: None)
    assert (found.status, found.makespan) == ("optimal", joint(SHARED[name]))


@pytest.mark.slow
def test_the_published_scheme_is_never_better() -> None:
    helped = team(1, TOP), HELPER, HELPER
    found = {sharing: solve(scenario(*helped, sharing=sharing), lambda _: None) for sharing in ("published", "general")}
    assert {plan.status for plan in found.values()} == {"optimal"}
    assert found["general"].makespan <= found["published"].makespan


@pytest.mark.slow
def test_carriers_are_lent_too() -> None:
    lent = solve(SHARED["a carrier is lent"], lambda _: None)
    assert [(x["worker"], x["from"], x["to"], x["as"]) for x in lent.exchanges] == [("c1", "T2", "T1", "c1")]


def test_who_shares_in_general_is_told_how_many_robots_there_are_and_how_long_they_travel() -> None:
    files = compile_scenario(SHARED["delays differ by pair"]).files
    told = msgspec.convert(files["coordinator"], CoordinatorSetup)
    market = told.market()
    assert market is not None
    assert (market.steps("T2", "T1"), market.steps("T3", "T1"), market.steps("T1", "T3")) == (4, 2, 1)
    assert market.most == {"carrier": 2, "worker": 2}
    assert msgspec.convert(files["T2"], TeamSetup).guests == market.most
    scene = files["world"]
    assert isinstance(scene, Scene)
    assert scene.transports == (Transport("T2", "T1", 4), Transport("T3", "T1", 2))


def test_under_the_published_limits_nobody_is_told_of_kinds() -> None:
    files = compile_scenario(scenario(team(1, TOP), HELPER, sharing="published")).files
    assert msgspec.convert(files["coordinator"], CoordinatorSetup).market() is None
    assert not msgspec.convert(files["T1"], TeamSetup).guests


def drawn(seed: int) -> Scenario:
    """Two or three teams with a box or two in all, some of whose workers cannot be re-tooled, some with carriers."""
    dice = random.Random(seed)
    numbers = dice.choice([(1, 0), (1, 1), (1, 0, 0)])

    def worker(cell: tuple[int, int]) -> dict[str, Any]:
        return {"name": "", "at": list(cell), "effector": dice.randint(1, 3), "fixed": dice.choice([0, 0, 1])}

    teams = []
    for boxes in numbers:
        cells = dice.sample([(1, 1), (1, 2), (2, 1), (2, 2)], dice.randint(0, 2))
        teams.append(team(boxes, *map(worker, cells), carrier=C1 if dice.random() < 0.5 else None))
    pair = {"from": "T1", "to": "T2", "steps": dice.randint(1, 3)}
    return scenario(*teams, delay=dice.randint(1, 2), most=1, delays=[pair])


@pytest.mark.slow
@pytest.mark.parametrize("seed", AGREEING)
def test_drawn_problems_have_the_optimum_of_one_program_for_all_teams(seed: int) -> None:
    """With dominance, bounds and questions on the one side, a plain program on the other."""
    given = drawn(seed)
    found = solve(given, lambda _: None)
    assert found.status == "optimal"
    assert found.makespan == joint(given, found.makespan)


@pytest.mark.slow
def test_without_giving_back_all_would_take_longer() -> None:
    """T1 lends its waxer and its stamper, borrows the painter, and has both back: the least of all there is."""
    given = load_scenario("factory/given_back")
    best = solve(given, lambda _: None)
    roles = {(x["from"], x["to"]) for x in best.exchanges}
    assert roles == {("T1", "T2"), ("T2", "T1")}
    assert sorted(int(x["take_step"]) for x in best.exchanges if x["to"] == "T1") == [4, 8, 12]
    assert joint(given, best.makespan, NOT_BACK) is None
