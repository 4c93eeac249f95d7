"""Is this disturbance possible? One answer for scenario files and for ``muster inject``, before anything is sent.

The vocabulary is `bus.faults`; what is not in it is refused with the list of what is.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from re import fullmatch

from bus.faults import KINDS, FaultKind

EVERYBODY = "*"
ARROW = ">"
_WORD = r"[a-z]\w{0,30}"

_TARGETS = {
    "robot": "a robot, TEAM.ROBOT",
    "body": "a robot or an object, TEAM.NAME",
    "object": "an object, TEAM.NAME",
    "new": "a new thing of a team, TEAM.NAME",
    "team": "a team",
    "process": "a process",
    "link": f"a process (all that it sends), FROM{ARROW}TO, or {EVERYBODY}",
}


@dataclass(frozen=True)
class Names:
    """What can be a target: teams, robots, objects and persons as TEAM.NAME, processes. Empty: not known, any name is
    taken."""

    teams: Collection[str] = ()
    robots: Collection[str] = ()
    objects: Collection[str] = ()
    persons: Collection[str] = ()
    processes: Collection[str] = ()


ANY = Names()


def problem(kind: str, target: str, args: Mapping[str, object], names: Names = ANY) -> tuple[str, str] | None:
    """The key that is wrong (``kind``, ``target`` or an argument) and what was expected; None if all is well."""
    known = KINDS.get(kind)
    if known is None:
        return "kind", f"unknown kind {kind!r}. Supported: {supported()}"
    for missing in [name for name in known.required if name not in args]:
        return missing, f"{kind} needs it. Supported: {usage(kind, known)}"
    for extra in [name for name in args if name not in (*known.required, *known.optional)]:
        return extra, f"{kind} does not take it. Supported: {usage(kind, known)}"
    for name, value in args.items():
        if wrong := _argument(name, value):
            return name, wrong
    if kind == "move" and set(args) not in ({"x", "y"}, {"to"}):
        return "move", "expected either x and y (a cell) or to (an object's line position)"
    return _target(kind, known, target, names)


def supported() -> str:
    """The whole vocabulary on one line."""
    return "; ".join(usage(kind, known) for kind, known in KINDS.items())


def usage(kind: str, known: FaultKind) -> str:
    """``pause PROCESS for_s=...``."""
    arguments = [f"{name}=..." for name in known.required] + [f"[{name}=...]" for name in known.optional]
    return " ".join([kind, known.on.upper(), *arguments])


def _argument(name: str, value: object) -> str:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if name == "share":
        return "" if number and 0 <= float(value) <= 1 else "expected a number from 0 to 1"  # type: ignore[arg-type]
    if name == "for_s":
        return "" if number and float(value) > 0 else "expected seconds, more than 0"  # type: ignore[arg-type]
    if name in ("add", "objects"):
        return "" if isinstance(value, int) and number and value >= 1 else "expected a whole number, at least 1"
    if name == "units":
        return "" if isinstance(value, int) and number and value >= 0 else "expected units of time, 0 for no deadline"
    if name in ("x", "y", "to"):
        return "" if isinstance(value, int) and number else "expected a whole number"
    if name == "attribute":
        return "" if isinstance(value, str) else "expected the name of an attribute"
    if name == "what":
        named = isinstance(value, str) and fullmatch(_WORD, value)
        return "" if named else "expected what it is: a small letter, then letters, digits or _"
    return "" if isinstance(value, int | str) and not isinstance(value, bool) else "expected a number or a word"


def _target(kind: str, known: FaultKind, target: str, names: Names) -> tuple[str, str] | None:
    choices = {
        "robot": [*names.robots],
        "body": [*names.robots, *names.objects, *names.persons],
        "object": [*names.objects],
        "new": [],
        "team": [*names.teams],
        "process": [*names.processes],
        "link": [*names.processes],
    }[known.on]
    if known.on == "new":
        team, _, name = target.partition(".")
        fits = fullmatch(_WORD, name) and (not names.teams or team in names.teams)
        return None if fits else ("target", f"expected {_TARGETS['new']}")
    ends = target.split(ARROW) if known.on == "link" else [target]
    if len(ends) > 2 or not all(ends):
        return "target", f"expected {_TARGETS[known.on]}"
    for end in ends:
        if choices and end not in choices and not (known.on == "link" and end == EVERYBODY):
            listed = ", ".join(choices[:20]) + (", ..." if len(choices) > 20 else "")
            return "target", f"{kind} needs {_TARGETS[known.on]}; {end!r} is none. There are: {listed}"
    return None
