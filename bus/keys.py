"""Every key of the bus, one function each; see *Streams* in docs/architecture.md.

A `name` may be ``*`` to get the expression that matches all of them.
"""

from __future__ import annotations

import re

WORLD = "world"
NOBODY = "muster/nobody"
"""A key that nobody uses."""
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,31}")
"""What a run or a process may be called: nothing that has a meaning in a key expression."""


def mail(run: str, receiver: str, source: str) -> str:
    """Requests and replies for `receiver` from `source`."""
    return f"muster/{run}/mail/{receiver}/{source}"


def tick(run: str) -> str:
    """The world's `Tick`."""
    return f"muster/{run}/clock/tick"


def done(run: str, name: str) -> str:
    """`Done` of one participant."""
    return f"muster/{run}/clock/done/{name}"


def join(run: str, name: str) -> str:
    """`Join` of one participant."""
    return f"muster/{run}/clock/join/{name}"


def event(run: str, name: str) -> str:
    """`Event`s that `name` reports."""
    return f"muster/{run}/event/{name}"


def status(run: str, name: str) -> str:
    """The latest `Status` of `name`."""
    return f"muster/{run}/status/{name}"


def beat(run: str, name: str) -> str:
    """`Beat`s of `name`."""
    return f"muster/{run}/beat/{name}"


def truth_frame(run: str) -> str:
    """Ground truth, `Frame` by `Frame`: for recorder and dashboard alone."""
    return f"muster/{run}/truth/frame"


def truth_scene(run: str) -> str:
    """Ground truth at the start, a packed `bus.scene.Scene`: for recorder and dashboard alone."""
    return f"muster/{run}/truth/scene"


def live(run: str, name: str) -> str:
    """Presence token of `name`."""
    return f"muster/{run}/live/{name}"


def last(key: str) -> str:
    """The last part of a key: who speaks there."""
    return key.rpartition("/")[2]
