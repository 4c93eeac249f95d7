"""One good recording, and for each invariant recordings that break it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import msgspec
import pytest

from bus.messages import Beat, Envelope, Event, Frame
from bus.scene import Transport
from ops.invariants import check
from ops.recording import Recording, SourceCount
from tests.ops.synthetic import recording, summary_of

GOOD = recording(4)


def spoiled(kind: str, change: Callable[[dict[str, Any]], None], which: int = 5) -> Recording:
    """The good recording with the data of the `which`-th event of a kind changed."""
    events = list(GOOD.events)
    at = [i for i, e in enumerate(events) if isinstance(e.body, Event) and e.body.kind == kind][which]
    body = events[at].body
    assert isinstance(body, Event)
    data = msgspec.json.decode(msgspec.json.encode(body.data))
    change(data)
    events[at] = msgspec.structs.replace(events[at], body=Event(body.kind, data))
    return replace(GOOD, events=tuple(events))


def with_extra(name: str, which: int, /, **changes: Any) -> Recording:
    """The good recording with one more event of the world, like the `which`-th of a kind but later."""
    worlds = [e for e in GOOD.events if e.src == "world"]
    twin = [e for e in worlds if isinstance(e.body, Event) and e.body.kind == name][which]
    assert isinstance(twin.body, Event)
    number = max(e.seq for e in worlds) + 1
    extra = msgspec.structs.replace(
        twin, seq=number, at_s=worlds[-1].at_s, body=Event(name, {**twin.body.data, **changes})
    )
    events = (*GOOD.events, extra)
    return replace(GOOD, events=events, summary=summary_of(events))


def test_a_good_recording_has_no_violations() -> None:
    assert check(GOOD) == []


def set_to(*path: str, value: Any) -> Callable[[dict[str, Any]], None]:
    def change(data: dict[str, Any]) -> None:
        for key in path[:-1]:
            data = data[key]
        data[path[-1]] = value

    return change


def drop(*path: str) -> Callable[[dict[str, Any]], None]:
    def change(data: dict[str, Any]) -> None:
        for key in path[:-1]:
            data = data[key]
        del data[path[-1]]

    return change


BROKEN = [
    ("robot in no team", spoiled("membership", drop("robots", "T2.w3")), "robot T2.w3 is in no team"),
    ("robot from nowhere", spoiled("membership", set_to("robots", "T9.w9", value=["T1", "w9"])), "came from nowhere"),
    ("robot gone", spoiled("membership", set_to("robots", "T2.w3", value=["gone", "w3"])), "neither a team nor"),
    ("two of one name", spoiled("membership", set_to("robots", "T2.w3", value=["T2", "w2"])), "are called w2 in T2"),
    ("no bench", spoiled("membership", set_to("robots", "T2.w3", value=["T1", "w9"])), "from T2 to T1 without"),
    ("done twice", spoiled("membership", set_to("objects", "T1.1", "stage", value=3), 6), "rose from 1 to 3"),
    ("work lost", spoiled("membership", set_to("objects", "T1.1", "stage", value=0), 6), "fell from 1 to 0"),
    ("work from nowhere", spoiled("membership", set_to("objects", "T1.4", "stage", value=1), 4), "nobody was to work"),
    ("box vanished", spoiled("membership", drop("objects", "T1.4")), "T1.4 vanished"),
    ("box appeared", spoiled("membership", set_to("objects", "T1.9", value={"stage": 0})), "T1.9 appeared"),
    ("command twice", with_extra("step_ended", 5), "took effect 2 times"),
    ("begun after its end", with_extra("step_started", 5), "was begun again after it had ended"),
    ("step twice", with_extra("step_ended", 5, command="other"), "was carried out 2 times"),
    ("end without beginning", with_extra("step_ended", 5, command="other", step=99), "ended without having begun"),
]


@pytest.mark.parametrize(("run", "sentence"), [c[1:] for c in BROKEN], ids=[c[0] for c in BROKEN])
def test_a_violation_is_found(run: Recording, sentence: str) -> None:
    assert any(sentence in found for found in check(run)), check(run)


def test_a_robot_in_two_places_of_a_frame_is_found() -> None:
    frame = GOOD.frames[3]
    assert isinstance(frame.body, Frame)
    twice = msgspec.structs.replace(frame, body=Frame(1.0, 1, (*frame.body.bodies, frame.body.bodies[0])))
    assert any("in 2 places at once" in s for s in check(replace(GOOD, frames=(twice,))))


def test_what_a_person_does_is_no_violation() -> None:
    """A box set back, a box cancelled and a box added: faults and orders explain them."""
    fault = with_extra("fault_injected", 0, target="T1.1", kind="set")
    changed = Event("order", {"team": "T1", "added": ["5"], "cancelled": ["4"]})
    order = msgspec.structs.replace(fault.events[-1], seq=fault.events[-1].seq + 1, body=changed)
    last = [e for e in GOOD.events if isinstance(e.body, Event) and e.body.kind == "membership"][-1]
    assert isinstance(last.body, Event)
    objects = {**last.body.data["objects"], "T1.1": {"stage": 1}, "T1.5": {"stage": 0}}  # type: ignore[dict-item]
    del objects["T1.4"]
    after = msgspec.structs.replace(
        last, seq=order.seq + 1, at_s=order.at_s, body=Event("membership", {**last.body.data, "objects": objects})
    )
    events = (*fault.events, order, after)
    assert check(replace(GOOD, events=events, summary=summary_of(events))) == []


def test_a_step_that_was_under_way_when_the_world_died_may_begin_again() -> None:
    begun = next(e for e in GOOD.events if isinstance(e.body, Event) and e.body.kind == "step_started")
    earlier = next(e for e in GOOD.events if e.src == "world" and e.seq == 1)
    first_life = (earlier, msgspec.structs.replace(begun, seq=2))
    second = tuple(msgspec.structs.replace(e, inc=2) if e.src == "world" else e for e in GOOD.events)
    events = (*first_life, *second)
    beats = tuple(msgspec.structs.replace(e, inc=2) if e.src == "world" else e for e in GOOD.beats)
    assert check(replace(GOOD, events=events, beats=beats, summary=summary_of(events))) == []


def test_counts_that_do_not_agree_are_found() -> None:
    without = tuple(e for e in GOOD.events if (e.src, e.seq) != ("T1", 2))
    found = check(replace(GOOD, events=without))
    assert any("T1 (life 1): 1 event missing, the first is number 2" in sentence for sentence in found)
    assert check(replace(GOOD, summary=None)) == ["the recording has no summary: it was cut off"]
    assert GOOD.summary is not None
    said = msgspec.structs.replace(GOOD.summary, sources=(SourceCount("T1", 1, 9, 3, 3), *GOOD.summary.sources[1:]))
    assert any("T1 (life 1): events sent: 9" in s for s in check(replace(GOOD, summary=said)))


def test_a_sign_of_life_that_tells_of_more_events_is_believed() -> None:
    beat = Envelope(1, "made-up", "T1", 1, 999, "b", 60.0, Beat(1, events=77))
    assert any("emitted 77 events" in s for s in check(replace(GOOD, beats=(*GOOD.beats, beat))))


def test_an_empty_recording_is_not_called_good() -> None:
    assert check(Recording()) == ["the recording has no events"]
    assert any("no scene" in s for s in check(replace(GOOD, scene=None)))


def test_a_robot_that_comes_before_its_transport_can_be_over() -> None:
    """In the good recording T2's robot is on its way to T1 for two steps."""
    scene = GOOD.scene
    assert scene is not None
    slow = replace(GOOD, scene=msgspec.structs.replace(scene, transports=(Transport("T2", "T1", 3),)))
    assert check(slow) == ["step 13: robot T2.w3 came to T1 2 steps after T2 gave it, not 3"]
