"""Frames: packed piece by piece, they say what packing all bodies anew would say."""

from __future__ import annotations

import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus import keys
from bus.messages import BodyFrame, Execute, Frame
from tests.world.stage import PERIOD_S, Stage, call, hand, piece, scene, tug

ENTITIES = (
    *(hand("A", f"h{x}", x, 1) for x in range(1, 4)),
    tug("A", "t1", 1, 1),
    *(piece("A", number, 2 + number) for number in range(1, 4)),
    hand("B", "h1", 1, 1, tool=2),
    piece("B", 1, 3),
)
ACTIONS = [
    *(f"go(h{n},{way})" for n in range(1, 4) for way in ("up", "down", "left", "right")),
    *(f"work(h{n},{number})" for n in range(1, 4) for number in range(1, 4)),
    "join(t1,h1)", "part(t1)", "push(t1)", "fit(h1,3)", "shift", "give(h1)", "mend(h2)",
]  # fmt: skip


def plain(stage: Stage) -> Frame:
    """The frame of now, with no short cuts."""
    world = stage.world
    truth, doing = world.truth, world.windows.doing
    bodies = []
    for place, things in truth.places():
        east_m, north_m = truth.layout.origin(place)
        for it in things:
            x_m, y_m = truth.floor.where(it.id)
            at, now = (x_m - east_m, y_m - north_m), doing.get(it.id, "")
            angle = truth.floor.heading(it.id) if it.heavy else 0.0
            bodies.append(
                BodyFrame(it.id, it.name, it.kind, place, *at, angle, it.attributes, it.broken, it.partner, now)
            )
    return Frame(truth.tick * truth.scene.dt_s, truth.step, tuple(bodies))


def watched(stage: Stage) -> Stage:
    """Every frame is compared as it is shown."""
    publish = stage.node.publish

    def compare(key: str, body: Any) -> None:
        publish(key, body)
        assert key == keys.truth_frame("test")
        assert stage.sent[-1][1].body == plain(stage)

    stage.node.publish = compare  # type: ignore[method-assign]
    return stage


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32))
def test_frames_are_what_packing_everything_would_give(seed: int) -> None:
    draw = random.Random(seed)
    stage = watched(Stage(scene(*ENTITIES, teams=2, frame_hz=10.0)))
    for number in range(6):
        calls = [call(text) for text in draw.sample(ACTIONS, 3)]
        stage.deliver(stage.mail("A", Execute("A", number, tuple(calls))), stage.mail("B", Execute("B", number, ())))
        seen = len(stage.sent)
        stage.advance(PERIOD_S)
        assert len(stage.sent) - seen >= 20
        thing = draw.choice([*stage.world.truth.things.values()])
        thing.broken = not thing.broken
        thing.attributes["tool"] = draw.randint(0, 3)
