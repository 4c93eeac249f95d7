"""Ground truth for those who watch: a frame with every body as it is. Agents never see one."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain
from operator import attrgetter, sub
from struct import Struct
from typing import Any

from msgspec import Raw, msgpack

from bus.messages import BodyFrame, Frame
from world.sensors import where
from world.things import Thing
from world.truth import Truth

_pack = msgpack.Encoder().encode
_look = attrgetter("name", "kind", "place", "broken", "partner", "attributes")
_BETWEEN = b"\xa3y_m\xcb"
_NOWHERE = b"\xa3x_m\xcb" + bytes(8) + _BETWEEN + bytes(8)
"""A body at (0.0, 0.0), as MessagePack writes it; no text can look like this, since the first byte begins no letter."""


class Frames:
    """Packs frames of a truth, as `bus.codec.encode` would pack a `Frame`. From one to the next little changes but the
    positions, so all that lies between them is kept packed, and only bodies that look different are packed anew."""

    def __init__(self, truth: Truth) -> None:
        self._truth = truth
        self._looks: list[tuple[Any, ...]] = []
        self._doing: Mapping[str, str] = {}
        self._headings: dict[str, float] = {}
        self._ids: list[str] = []
        self._origins: list[float] = []
        self._packed: dict[str, tuple[tuple[Any, ...], bytes, bytes]] = {}
        self._parts: list[Any] = []
        self._form = Struct(">")

    def frame(self, doing: Mapping[str, str]) -> Raw:
        """The world now, a packed `Frame`; `doing` says what each robot is at, by its id.

        Positions are in metres in the coordinates of the body's place: cell (x,y) is at x, y, line position p at p,
        height + 1.
        """
        truth = self._truth
        truth.fade()
        things = [*chain.from_iterable(things for _, things in truth.places())]
        looks = [*map(_look, things)]
        headings = {thing.id: truth.floor.heading(thing.id) for thing in things if thing.heavy}
        if looks != self._looks or doing != self._doing or headings != self._headings:
            self._headings = headings
            self._change(things, looks, doing)
        at = truth.floor.positions()
        self._parts[1::2] = map(sub, chain.from_iterable(map(at.__getitem__, self._ids)), self._origins)
        head = _pack(Frame(truth.tick * truth.scene.dt_s, truth.step, ()))[:-1]  # without the empty array at its end
        return Raw(b"%b\xdc%b%b" % (head, len(things).to_bytes(2), self._form.pack(*self._parts)))

    def _change(self, things: list[Thing], looks: list[tuple[Any, ...]], doing: Mapping[str, str]) -> None:
        """Pack what has changed, and put the pieces in order: text, x, text, y, text of this body and the next, ..."""
        self._looks = [(*look[:-1], {**look[-1]}) for look in looks]  # attributes change in place
        self._doing = {**doing}
        self._ids = [thing.id for thing in things]
        self._origins = [part for thing in things for part in self._truth.layout.origin(thing.place)]
        texts = [b""]
        for thing, look in zip(things, self._looks, strict=True):
            now = (*look, self._headings.get(thing.id, 0.0), doing.get(thing.id, ""))
            known = self._packed.get(thing.id)
            if known is None or known[0] != now:
                known = self._packed[thing.id] = (now, *_halves(thing, *now[-2:]))
            texts[-1] += known[1]
            texts += (_BETWEEN, known[2])
        self._form = Struct(f">{'sd'.join(str(len(text)) for text in texts)}s")
        self._parts = [None] * (2 * len(texts) - 1)
        self._parts[::2] = texts


def _halves(thing: Thing, heading_rad: float, doing: str) -> tuple[bytes, bytes]:
    """What is packed of a body up to its x, and after its y."""
    body = BodyFrame(
        thing.id, thing.name, thing.kind, thing.place, 0.0, 0.0, heading_rad,
        thing.attributes, thing.broken, thing.partner, doing,
    )  # fmt: skip
    before, _, after = _pack(body).partition(_NOWHERE)
    return before + _NOWHERE[:5], after


def membership(truth: Truth, step: int) -> dict[str, object]:
    """Who belongs where, and how far each object is, after a step: data of the event of that name."""
    robots: dict[str, list[str]] = {}
    objects: dict[str, dict[str, object]] = {}
    for thing in truth.things.values():
        kind = truth.kind(thing)
        if kind.role == "robot":
            robots[thing.id] = [thing.place, thing.name]
        elif kind.role == "object" and thing.place in truth.layout.spaces:
            objects[thing.id] = {kind.place: where(truth, thing), **thing.attributes}
    return {"step": step, "robots": robots, "objects": objects}
