"""What must be true in rooms: of a world by hand, and of frames that were spoiled."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from msgspec.structs import replace

from bus.messages import BodyFrame, Envelope, Event, Frame
from bus.scene import Solid, Stop
from ops.recording import Recording
from ops.touching import pushed, touching
from tests.world.house import House, cart, go, house, human, pot, room

BED = Solid("bed", ((5.0, 5.0), (7.0, 5.0), (7.0, 7.0), (5.0, 7.0)))
SCENE = house(
    cart("A", "r1", 0, 2),
    cart("A", "r2", 3, 0),
    human("A", "anna", 1, 4, Stop(2.0, 4.5, 1.5), Stop(9.0, 1.5, 4.5), again_s=20.0),
    pot("A", "cup", 5, 4),
    pot("A", "chest", 0, 6, "(1,6)"),
    rooms=(room("A", BED),),
)


@pytest.fixture(scope="module")
def run() -> Recording:
    """Two robots whose ways cross that of a person, and one another's."""
    stage = House(SCENE)
    told = stage.act("A", go("r1", (0.5, 2.5), (7.4, 2.5), units=3), go("r2", (3.5, 0.5), (3.5, 7.5), units=3))
    assert told.felt == {}
    stage.advance(9.0)
    messages = [message for _, message in stage.sent]
    frames = tuple(message for message in messages if isinstance(message.body, Frame))
    return Recording(scene=SCENE, events=tuple(m for m in messages if isinstance(m.body, Event)), frames=frames)


def spoiled(run: Recording, name: str, change: Callable[[BodyFrame], BodyFrame], last: int = 20) -> Recording:
    """From the frame before the last few on, a body is elsewhere."""

    def other(frame: Envelope) -> Envelope:
        assert isinstance(frame.body, Frame)
        bodies = tuple(change(body) if body.id == name else body for body in frame.body.bodies)
        return replace(frame, body=replace(frame.body, bodies=bodies))

    frames = (*run.frames[:-last], *map(other, run.frames[-last:]))
    return Recording(scene=run.scene, events=run.events, frames=frames)


def violations(recording: Recording) -> list[str]:
    return [text.partition(" s: ")[2] for text in (*touching(recording, SCENE), *pushed(recording, SCENE))]


def test_the_world_keeps_to_it(run: Recording) -> None:
    assert len(run.frames) > 50
    assert violations(run) == []


@pytest.mark.parametrize(
    ("name", "x_m", "y_m", "expected"),
    [
        ("A.r1", 6.0, 6.0, ["A.r1 is inside bed"]),
        ("A.r1", 4.8, 6.0, ["A.r1 is inside bed"]),
        ("A.r1", 0.2, 1.0, ["A.r1 is inside a wall"]),
        ("A.r1", 3.5, 7.1, ["A.r1 is in the place of A.r2"]),
        ("A.cup", 1.6, 6.4, ["A.cup is in the place of A.chest"]),
        ("A.anna", 1.7, 4.5, ["A.anna is off its walk: somebody has pushed it"]),
    ],
)
def test_what_is_wrong_is_told_once(run: Recording, name: str, x_m: float, y_m: float, expected: list[str]) -> None:
    assert violations(spoiled(run, name, lambda body: replace(body, x_m=x_m, y_m=y_m))) == expected


def test_a_person_is_not_carried_along(run: Recording) -> None:
    (text,) = violations(spoiled(run, "A.anna", lambda body: replace(body, x_m=4.5, y_m=1.5), last=8))
    assert text == "A.anna was carried along, faster than people walk"


def test_who_was_moved_by_hand_and_lives_of_the_world_are_excused(run: Recording) -> None:
    moved = spoiled(run, "A.anna", lambda body: replace(body, x_m=6.5, y_m=1.5))
    fault = replace(run.events[0], body=Event("fault_injected", {"kind": "move", "target": "A.anna"}))
    assert violations(replace_events(moved, (*run.events, fault))) == []
    again = tuple(replace(frame, inc=2) for frame in run.frames[:10])
    assert violations(Recording(scene=SCENE, events=run.events, frames=(*run.frames, *again))) == []


def replace_events(recording: Recording, events: tuple[Envelope, ...]) -> Recording:
    return Recording(scene=recording.scene, events=events, frames=recording.frames)
