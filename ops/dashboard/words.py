"""Words, letters and colours for what a scene shows. All of it comes from the scene: this file knows no domain."""

from __future__ import annotations

from functools import lru_cache

from bus.messages import Value
from bus.scene import Scene

# By the place of a value among its attribute's words, so that a tool has the colour of what it makes.
COLOURS = ("white", "green", "yellow", "bright_cyan", "magenta", "blue")
# What an event means: its sign and its style.
TONES = {"fault": ("!", "bold red"), "cause": ("?", "yellow"), "recovery": ("»", "cyan"), "success": ("✓", "green")}
BROKEN, SUSPECT, MARKED = "✗", "?", "~"


def shown(scene: Scene | None, kind: str) -> str:
    """The attribute of a kind that a drawing shows: the first that has words."""
    if scene is None or kind not in scene.kinds:
        return ""
    return next((a for a in scene.kinds[kind].attributes if a in scene.display), "")


def marks(scene: Scene | None) -> frozenset[str]:
    """The attributes that say that work is still settling (wet paint): drawn as a mark while they hold."""
    return frozenset(a.marks for a in scene.actions.values() if a.marks) if scene else frozenset()


def worked(scene: Scene | None) -> str:
    """The attribute that work advances, from the first value to the last."""
    return next((a.attribute for a in scene.actions.values() if a.skill == "operate"), "") if scene else ""


def word(scene: Scene | None, attribute: str, value: Value) -> str:
    return (scene.display if scene else {}).get(attribute, {}).get(str(value), str(value))


def letter(scene: Scene | None, attribute: str, value: Value) -> str:
    return word(scene, attribute, value)[:1]


def colour(scene: Scene | None, attribute: str, value: Value) -> str:
    """A colour that is the same for a value of a tool and for the value of the work that it makes."""
    if isinstance(value, int):
        return COLOURS[value % len(COLOURS)]
    known = list((scene.display if scene else {}).get(attribute, {}))
    return COLOURS[known.index(value) % len(COLOURS)] if value in known else "white"


def place(scene: Scene | None, name: str) -> str:
    """What people call the ``dock``, the ``line`` or the ``bench`` here."""
    return (scene.display if scene else {}).get("places", {}).get(name, name)


@lru_cache(maxsize=64)
def _holding(value: Value) -> bool:
    return value not in (0, "0", "", "no", "none", "false")


def holds(value: Value | None) -> bool:
    """Whether a mark's value says yes."""
    return value is not None and _holding(value)
