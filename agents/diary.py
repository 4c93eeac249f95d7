"""What the coordinator must not forget, as one value; the rest it asks the teams for."""

from __future__ import annotations

import msgspec

from bus import messages as m
from bus.journal import Journal

_KEY = "diary"


class Diary(msgspec.Struct, frozen=True):
    """`plans` counts the shared plans adopted so far. `lost` are the teams out of contact: of that the world tells
    once. `tried`: the given plan has had its chance. `over` is the last word, once it is said."""

    epoch: int = 0
    plans: int = 0
    over: m.RunOver | None = None
    lost: tuple[str, ...] = ()
    tried: bool = False

    @property
    def replans(self) -> int:
        return max(self.plans - 1, 0)


def load(journal: Journal) -> Diary:
    """The diary as of the last completed write; a fresh one if there is none."""
    kept = journal.get(_KEY)
    return Diary() if kept is None else msgspec.msgpack.decode(kept, type=Diary)


def save(journal: Journal, diary: Diary) -> None:
    journal.put(_KEY, msgspec.msgpack.encode(diary))
