"""A world that is killed comes back with its last complete step, and nothing is done twice or forgotten."""

from __future__ import annotations

from copy import deepcopy
from math import dist
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

from bus.messages import Execute, Executed, Inject, Injected, Observe, Observed, Ok, Order, ProcessFault
from bus.scene import Fault
from tests.world.stage import PERIOD_S, Stage, call, hand, piece, scene, tug

BODIES = (
    hand("A", "h1", 1, 3),
    hand("A", "h2", 3, 3, tool=2),
    tug("A", "t1", 1, 3),
    piece("A", 1, 3, state=1),
    piece("A", 2, 1),
    hand("B", "h1", 1, 1),
)
STORY: list[dict[str, Any]] = [
    {"A": "join(t1,h1) work(h2,1)", "B": "give(h1)"},
    {"A": "pull(t1) shift go(h2,left)", "B": ""},
    {"A": [call("take(h3,1,3)", robot="B.h1", tool=3)], "B": ""},
    {"A": "part(t1) go(h3,right)", "B": ""},
    {"A": "go(t1,right) go(h3,right) give(h1)", "B": ""},
    {"A": "shift", "B": ""},
]


def first(home: Path, *faults: Fault) -> Stage:
    return Stage(scene(*BODIES, teams=2, faults=faults), home)


def snapshot(stage: Stage) -> list[Any]:
    return deepcopy(stage.world.truth.save())


@pytest.mark.parametrize("killed_after", range(len(STORY)))
def test_it_comes_back_with_its_last_complete_step(tmp_path: Path, killed_after: int) -> None:
    quiet, troubled = first(tmp_path / "quiet"), first(tmp_path / "troubled")
    for number, moves in enumerate(STORY):
        expected, got = quiet.step(number, **moves), troubled.step(number, **moves)
        assert expected == got
        if number == killed_after:
            before = snapshot(troubled)
            troubled = troubled.again()
            assert snapshot(troubled) == before
            assert troubled.now_s == quiet.now_s
            assert troubled.events("started")[0]["recovered"] is True
            assert troubled.events("started")[0]["step"] == number
            for team in "AB":
                assert troubled.state(team) == quiet.state(team)
    for a, b in zip(snapshot(quiet), snapshot(troubled), strict=True):
        # A robot on its way is driven on from where it was; all others stand at the same place to the last bit.
        assert dist(a.at, b.at) < (0.01 if a.place == "bench" else 1e-12)


def test_a_step_under_way_never_was_and_is_executed_again(tmp_path: Path) -> None:
    stage = first(tmp_path)
    stage.step(0, **STORY[0])
    before = snapshot(stage)
    command = stage.mail("A", Execute("A", 1, (call("pull(t1)"), call("shift"))), "A.step.1")
    stage.deliver(command)
    stage.advance(1.3)
    assert snapshot(stage) != before
    stage = stage.again()
    assert snapshot(stage) == before
    assert stage.now_s == PERIOD_S
    stage.deliver(command)
    stage.advance(PERIOD_S)
    assert stage.state()["at(h1)"] == "(1,2)"
    stage.deliver(command)
    assert [body.step for body in stage.bodies(Executed)] == [1, 1]
    assert stage.state()["at(h1)"] == "(1,2)"


@pytest.mark.parametrize("killed_s", [0.3, 1.3])
@pytest.mark.parametrize(("kind", "args"), [("drop", {"share": 0.0}), ("kill", {}), ("pause", {"for_s": 0.1})])
def test_a_disturbance_in_the_middle_of_a_step_does_not_have_it_carried_out_from_there(
    tmp_path: Path, killed_s: float, kind: str, args: dict[str, float]
) -> None:
    """What becomes of processes and links is journalled at any time; the robot would go two cells."""
    stage = first(tmp_path)
    stage.step(0, **STORY[0])
    before = snapshot(stage)
    command = stage.mail("A", Execute("A", 1, (call("pull(t1)"), call("shift"))), "A.step.1")
    stage.deliver(command)
    stage.advance(killed_s)
    assert stage.inject(kind, "B", **args).accepted
    stage.advance(0.2)
    stage = stage.again()
    assert snapshot(stage) == before
    stage.deliver(command)
    stage.advance(PERIOD_S)
    state = stage.state()
    assert (state["at(h1)"], state["line(1)"]) == ("(1,2)", 2)


def test_who_was_answered_before_the_death_is_answered_again_and_not_executed_again(tmp_path: Path) -> None:
    stage = first(tmp_path)
    command = stage.mail("A", Execute("A", 0, (call("shift"),)), "A.step.0")
    stage.deliver(command)
    stage.advance(PERIOD_S)
    told = stage.bodies(Executed)
    stage = stage.again()
    stage.deliver(command)
    assert stage.bodies(Executed) == told
    assert stage.world.next_s() is None
    assert stage.state()["line(1)"] == 2


def test_the_fault_that_kills_the_world_does_not_kill_it_again(tmp_path: Path) -> None:
    class KilledError(Exception):
        pass

    def kill(to: str, body: Any, timeout_s: float) -> Any:
        raise KilledError

    faults = (
        Fault("kill", "world", at_step=1),
        Fault("break", "A.h2", at_step=1),
        Fault("order", "A", at_step=1, args={"add": 1}),
    )
    stage = first(tmp_path, *faults)
    stage.step(0, A="", B="")
    stage.node.ask = kill  # type: ignore[method-assign]
    with pytest.raises(KilledError):
        stage.step(1, A="shift", B="")
    stage = stage.again()
    # What came with it is not forgotten, nor done twice, and the order is told until it is confirmed.
    assert stage.world.truth.things["A.h2"].broken
    assert stage.bodies(Order) == [Order("A", added=("3",))]
    state = stage.step(1, A="shift", B="")["A"].state
    assert (state["line(1)"], state["line(3)"]) == (2, 5)
    assert stage.asked == []
    assert stage.events("fault_injected") == []


@pytest.mark.parametrize(("kind", "target"), [("kill", "world"), ("restart", "world"), ("kill", "A")])
def test_who_asks_again_after_the_world_died_of_it_does_not_kill_it_again(
    tmp_path: Path, kind: str, target: str
) -> None:
    stage = first(tmp_path)
    asked = stage.mail("operator", Inject(kind, target), "operator.1.1")

    def die(to: str, body: Any, timeout_s: float) -> Any:
        raise RuntimeError("killed")

    stage.node.ask = die  # type: ignore[method-assign]
    with pytest.raises(RuntimeError, match="killed"):
        stage.deliver(asked)
    stage = stage.again()
    stage.deliver(asked)
    stage.deliver(asked)
    assert stage.asked == []
    assert stage.bodies(Injected, "operator") == [Injected(True)] * 2
    assert stage.inject(kind, target).accepted
    assert stage.asked == [ProcessFault(kind, target)]  # type: ignore[arg-type]


def test_who_is_paused_is_resumed_by_the_next_life(tmp_path: Path) -> None:
    stage = first(tmp_path)
    stage.inject("pause", "A", for_s=5.0)
    stage = stage.again()
    stage.advance(6.0)
    assert stage.asked == [ProcessFault("resume", "A")]


def test_an_order_is_told_under_the_same_name_in_every_life(tmp_path: Path) -> None:
    """Whoever has heard of it knows it again."""

    def told(stage: Stage) -> list[str]:
        return [m.id for _, m in stage.sent if isinstance(m.body, Order)]

    stage = first(tmp_path)
    for _ in range(2):
        stage.inject("order", "A", add=1)
    (name,) = told(stage)
    stage = stage.again()
    assert told(stage) == [name]
    stage.deliver(replace(stage.mail("coordinator", Ok()), re=name))
    assert len({*told(stage)}) == 2
    stage.step(0, A="", B="")
    assert told(stage.again()) == told(stage)[1:]


def test_a_confirmed_order_is_not_told_again(tmp_path: Path) -> None:
    stage = first(tmp_path)
    stage.inject("order", "A", add=1)
    request = next(m for _, m in stage.sent if isinstance(m.body, Order))
    stage.deliver(replace(stage.mail("coordinator", Ok()), re=request.id))
    stage.step(0, A="", B="")
    assert stage.again().bodies(Order) == []


def test_an_own_bad_link_stays_bad(tmp_path: Path) -> None:
    stage = first(tmp_path)
    stage.inject("drop", "world>A", share=1.0)
    stage = stage.again()
    stage.ask("A", Observe("A"), Observed)
    stage.ask("B", Observe("B"), Observed)
    assert [key for key, _ in stage.sent if "mail/A" in key] == []
    assert [key for key, _ in stage.sent if "mail/B" in key] != []


def test_a_period_of_several_lives_is_the_same_to_the_last_bit(tmp_path: Path) -> None:
    def end(*kills: int) -> list[Any]:
        home = tmp_path / "-".join(map(str, (0, *kills)))
        stage = first(home)
        for number, moves in enumerate(STORY):
            stage.step(number, **moves)
            if number in kills:
                stage = stage.again()
        return [thing.at for thing in snapshot(stage) if thing.place != "bench"]

    assert end() == end(1) == end(3, 4)
