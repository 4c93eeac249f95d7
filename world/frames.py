"""Ground truth for those who watch: a frame with every body as it is. Agents never see one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import chain, repeat
from operator import attrgetter, itemgetter, sub
from struct import Struct
from typing import Any

from msgspec import Raw, msgpack

from bus.messages import BodyFrame, Frame
from world.sensors import where
from world.things import Thing
from world.truth import Truth

_pack = msgpack.Encoder().encode
_look = attrgetter("id", "name", "kind", "place", "broken", "partner", "attributes")
_BETWEEN = b"\xa3y_m\xcb"
_NOWHERE = b"\xa3x_m\xcb" + bytes(8) + _BETWEEN + bytes(8)
"""A body at (0.0, 0.0), as MessagePack writes it; no text can look like this, since the first byte begins no letter."""


class Frames:
    """Packs frames of a truth, as `bus.codec.encode` would pack a `Frame`. From one to the next little changes but the
    positions, so all that lies between them is kept packed, and only bodies that look different are packed anew."""

    def __init__(self, truth: Truth) -> None:
        self._truth = truth
        self._looks: list[tuple[Any, ...]] = []
        self._headings: dict[str, float] = {}
        self._doing: Mapping[str, str] = {}
        self._packed: dict[str, tuple[tuple[Any, ...], bytes, bytes]] = {}
        """What is packed of a body up to its x, and from its y to what it does, by its id; and how it looked then."""
        self._parts: list[Any] = []
        """Text, x, text, y, text of this body and the next, x, ..."""
        self._form = Struct(">")
        self._order: list[str] | None = None
        self._lying: list[float] = []
        self._origins: list[float] = []
        self._sort: Callable[[list[float]], tuple[float, ...]] = lambda _: ()

    def frame(self, doing: Mapping[str, str], *, still: bool = False) -> Raw:
        """The world now, a packed `Frame`; `doing` says what each robot is at, by its id. `still`: nothing but physics
        has happened since the frame before.

        Positions are in metres in the coordinates of the body's place: cell (x,y) is at x, y, line position p at p,
        height + 1.
        """
        truth = self._truth
        faded = truth.fade()
        order, numbers = truth.floor.standing()
        if faded or self._headings or not still:
            self._look(doing, order)
        self._parts[1::2] = self._sort([*map(sub, numbers, self._origins), *self._lying])
        head = _pack(Frame(truth.tick * truth.scene.dt_s, truth.step, ()))[:-1]  # without the empty array at its end
        return Raw(b"%b\xdc%b%b" % (head, len(self._looks).to_bytes(2), self._form.pack(*self._parts)))

    def _look(self, doing: Mapping[str, str], order: list[str]) -> None:
        """Take account of whatever may have changed."""
        truth = self._truth
        things = [*chain.from_iterable(things for _, things in truth.places())]
        looks = [*map(_look, things)]
        headings = {thing.id: truth.floor.heading(thing.id) for thing in things if thing.heavy}
        anew = looks != self._looks or headings != self._headings
        if anew:
            self._looks = [(*look[:-1], {**look[-1]}) for look in looks]  # attributes change in place
            self._headings = headings
            self._pack_looks(things)
        if anew or order is not self._order:
            self._order = order
            self._arrange(things, order)
        if anew or doing != self._doing:
            self._doing = {**doing}
            self._pack_doing(things)

    def _pack_looks(self, things: Sequence[Thing]) -> None:
        for thing, look in zip(things, self._looks, strict=True):
            now = (*look, self._headings.get(thing.id, 0.0))
            known = self._packed.get(thing.id)
            if known is None or known[0] != now:
                self._packed[thing.id] = (now, *_halves(thing, now[-1]))

    def _arrange(self, things: Sequence[Thing], order: Sequence[str]) -> None:
        """Where in the floor's numbers, with those of what is lifted at their end, each body's are."""
        there = {thing.id for thing in things}.intersection(order)
        lifted = [thing for thing in things if thing.id not in there]
        self._lying = [*chain.from_iterable(map(self._truth.local, lifted))]
        spots = {name: 2 * n for n, name in enumerate([*order, *(thing.id for thing in lifted)])}
        picked = [spots[thing.id] + n for thing in things for n in (0, 1)]
        self._sort = itemgetter(*picked) if picked else lambda _: ()
        places = {thing.id: self._truth.layout.origin(thing.place) for thing in things}
        self._origins = [part for name in order for part in places.get(name, (0.0, 0.0))]

    def _pack_doing(self, things: Sequence[Thing]) -> None:
        ids = [thing.id for thing in things]
        packed = [self._packed[name] for name in ids]
        says = map(_pack, map(self._doing.get, ids, repeat("")))
        ends = [b"", *(after + said for (_, _, after), said in zip(packed, says, strict=True))]
        begins = [*(before for _, before, _ in packed), b""]
        texts = [_BETWEEN] * (2 * len(ids) + 1)
        texts[::2] = [end + begin for end, begin in zip(ends, begins, strict=True)]
        self._parts = [None] * (2 * len(texts) - 1)
        self._parts[::2] = texts
        self._form = Struct(f">{'sd'.join(map(str, map(len, texts)))}s")


def _halves(thing: Thing, heading_rad: float) -> tuple[bytes, bytes]:
    """What is packed of a body up to its x, and from its y to what it does."""
    body = BodyFrame(
        thing.id, thing.name, thing.kind, thing.place, 0.0, 0.0, heading_rad,
        thing.attributes, thing.broken, thing.partner,
    )  # fmt: skip
    before, _, after = _pack(body).partition(_NOWHERE)
    return before + _NOWHERE[:5], after[:-1]  # without the empty text at its end


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
