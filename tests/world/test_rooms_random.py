"""Whatever robots are told to drive and wherever people walk: nobody touches anybody, and nobody is nowhere."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.messages import Event, Frame
from bus.scene import Solid, Stop
from ops.recording import Recording
from ops.touching import pushed, touching
from tests.world.house import House, cart, do, go, house, human, pot, room

TABLE = Solid("table", ((3.1, 3.2), (4.4, 2.9), (4.9, 4.6), (3.4, 4.8)))
CELLS = st.tuples(st.integers(0, 7), st.integers(0, 7))


def middle(cell: tuple[int, int]) -> tuple[float, float]:
    return cell[0] + 0.5, cell[1] + 0.5


@pytest.mark.slow
@settings(max_examples=6, deadline=None)
@given(
    places=st.lists(
        CELLS.filter(lambda c: not 2 <= c[0] <= 5 or not 2 <= c[1] <= 5), min_size=5, max_size=5, unique=True
    ),
    goals=st.lists(CELLS, min_size=6, max_size=6),
    walks=st.lists(CELLS, min_size=4, max_size=4),
)
def test_nobody_touches_anybody(
    places: list[tuple[int, int]], goals: list[tuple[int, int]], walks: list[tuple[int, int]]
) -> None:
    stops = [[Stop(0.0, *middle(walks[2 * i])), Stop(3.0, *middle(walks[2 * i + 1]))] for i in range(2)]
    scene = house(
        *(cart("A", f"r{i}", *places[i]) for i in range(3)),
        *(human("A", f"p{i}", *places[3 + i], *stops[i], again_s=9.0) for i in range(2)),
        rooms=(room("A", TABLE),),
    )
    stage = House(scene)
    for turn in range(2):
        calls = []
        for i in range(3):
            at = stage.world.truth.local(stage.world.truth.things[f"A.r{i}"])
            calls.append(go(f"r{i}", at, middle(goals[2 * i + turn]), units=2))
        told = stage.act("A", *calls)
        assert {f"at(r{i})" for i in range(3)} <= told.state.keys()
        for i in range(3):
            arrived = (
                told.state[f"at(r{i})"] == "({},{})".format(*goals[2 * i + turn]) and f"pose(r{i})" not in told.state
            )
            assert arrived == (f"r{i}" not in told.felt)
    assert violations(stage) == []


def violations(stage: House) -> list[str]:
    messages = [message for _, message in stage.sent]
    recording = Recording(
        scene=stage.scene,
        events=tuple(message for message in messages if isinstance(message.body, Event)),
        frames=tuple(message for message in messages if isinstance(message.body, Frame)),
    )
    return [*touching(recording, stage.scene), *pushed(recording, stage.scene)]


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(
    places=st.lists(
        CELLS.filter(lambda c: not 2 <= c[0] <= 5 or not 2 <= c[1] <= 5), min_size=8, max_size=8, unique=True
    ),
    holds=st.booleans(),
)
def test_whoever_is_called_home_touches_nobody(places: list[tuple[int, int]], holds: bool) -> None:
    """It comes home, or it is said that it has no way; what it held lies by itself."""
    guest, *others = places
    bodies = [cart("B", f"c{i}", *others[i]) for i in range(2)] + [human("B", "anna", *others[2])]
    things = [pot("B", f"p{i}", *([guest, *others[3:]][i])) for i in range(5)]
    rooms = room("A", room_b=(3, 4, 7, 7)), room("B", TABLE, room_a=(0, 1, 0, 0))
    stage = House(house(cart("A", "r1", 3, 7), *bodies, *things, rooms=rooms))
    truth, robot = stage.world.truth, stage.world.truth.things["A.r1"]
    truth.belongs(robot, "B", "r1")
    truth.floor.put("A.r1", truth.layout.cell("B", *guest))
    if holds:
        assert stage.act("B", do("take", "r1", what="grip(p0,1)")).felt == {}
    tries = 0
    while robot.place != "A" and tries < 14 and "no way" not in robot.waits:
        stage.act("A", do("home", "r1", robot="A.r1"))
        tries += 1
    assert robot.place == "A" or "no way" in robot.waits, stage.waits() + stage.reasons()
    lying = [truth.cell(truth.things[f"B.p{i}"]) for i in range(5)]
    assert len({*lying}) == 5
    assert violations(stage) == []
