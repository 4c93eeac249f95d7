"""The lines at the top and at the bottom of the screen: what is watched, how it stands, what the signs mean."""

from __future__ import annotations

from collections.abc import Mapping

from rich.text import Text

from ops.dashboard import floor, house, words
from ops.dashboard.model import Model
from ops.dashboard.text import Block, clean, ends, fit, joined
from reasoning.words import count

LEGEND_LINES = 2


def header(model: Model, width: int, note: str = "") -> Block:
    """Two lines: what is being watched and when; how the search for the shared plan stands, or the verdict."""
    scene = model.scene
    title = (scene.title or scene.domain) if scene else "waiting for a run"
    left = joined((" muster ", "bold reverse"), " ", (model.run, "bold"), "  " if model.run else "", (title, "dim"))
    conducted = scene is None or scene.conducted  # else every team counts steps of its own
    last = max((s.start + len(s.plan) for s in model.statuses.values() if s.plan), default=0)
    step = f"  step {model.step}" + (f"/{last}" if last >= model.step else "") if model.step >= 0 and conducted else ""
    clock = f"{model.now_s:.1f} s{step}"
    right = joined("  ", (note + "  " if note else "", "yellow"), (clock + " ", "bold"))
    return [ends(width, left, right), fit(verdict(model) if model.over else search(model), width)]


def verdict(model: Model) -> Text:
    over = model.over or {}
    good = bool(over.get("goal"))
    head = (" GOAL REACHED " if good else " GOAL NOT REACHED ", "bold white on green" if good else "bold white on red")
    facts = f" {_number(over, 'makespan', 'step')}, {_number(over, 'replans', 'replan')}"
    return joined(" ", head, facts, *(f" · {part}" for part in (over.get("reason"), *model.verdict) if part))


def _number(over: Mapping[str, object], field: str, noun: str) -> str:
    value = over.get(field)
    return count(value, noun) if isinstance(value, int) else f"? {noun}s"


def search(model: Model) -> Text:
    status = model.coordinator
    if status is None:
        return joined((" no coordinator heard of yet", "dim"))
    parts: list[tuple[str, str]] = [(" coordinator ", "dim"), (clean(status.doing) or "idle", "bold")]
    least = max(status.bound, 0)
    start = max((s.start for s in model.statuses.values() if s.plan), default=0)
    since = f" from step {start}" if start else ""
    if 0 <= status.best <= least:
        parts.append((f" · {count(status.best, 'step')}{since}, proved shortest", "green"))
    elif status.best >= 0:
        parts.append((f" · best {status.best}, at least {least}, gap {status.best - least}", "yellow"))
    elif status.bound >= 0:
        parts.append((f" · no plan yet, at least {least}", "yellow"))
    if status.questions:
        parts.append((f" · {count(status.questions, 'question')}", ""))
    return joined(*parts)


def legend(model: Model, width: int, keys: str) -> Block:
    """What the signs mean, in the scene's own words: one line if it is long enough, otherwise two."""
    right = joined((keys + " ", "dim"))
    full, short = (_packed([*_signs(model), *_letters(model, less)], width, right.cell_len) for less in (False, True))
    lines = full if len(full) <= LEGEND_LINES else short[:LEGEND_LINES]
    return [*(fit(text, width) for text in lines[:-1]), ends(width, lines[-1], right)]


def _packed(entries: list[Text], width: int, reserved: int) -> Block:
    """As many entries in each line as it holds, with so many cells left free at the end of the last."""
    lines = [Text("")]
    for entry in entries:
        if lines[-1].cell_len + 1 + entry.cell_len > width:
            lines.append(Text(""))
        lines[-1] = joined(lines[-1], " ", entry)
    return lines if lines[-1].cell_len + 2 + reserved <= width else [*lines, Text("")]


def _signs(model: Model) -> list[Text]:
    """Those of the kinds of bodies that there are, and of places and states."""
    scene = model.scene
    if scene is None:
        return []
    states = [joined((words.BROKEN, "bold red"), " broken"), joined((words.SUSPECT, "bold yellow"), " suspected")]
    if house.is_house(scene):
        return [*house.signs(scene), *states]
    out: list[Text] = []
    settling = next(iter(words.marks(scene)), "")
    there = {entity.kind for entity in scene.entities}
    for name, kind in scene.kinds.items():
        if name not in there:
            continue
        if kind.role == "object":
            sign, meaning = (words.MARKED, f", {settling}") if settling else ("", "")
            out.append(joined(f"[{kind.prefix}1{sign}] {name}{meaning}"))
        else:
            out.append(joined(f"{kind.prefix}1 {name}"))
            if kind.couples:
                out.append(joined(f"{kind.prefix}1= {kind.couples}"))
    return [*out, *states, joined((floor.SHADE, "dim"), " " + words.place(scene, "dock"))]


def _letters(model: Model, short: bool) -> list[Text]:
    """The letters of values; a tool and what it makes share one where they share letter and colour. Short: only
    what is made."""
    scene = model.scene
    if scene is None or house.is_house(scene):
        return []
    shared: dict[tuple[str, str], list[str]] = {}
    attributes = dict.fromkeys(words.shown(scene, kind) for kind in scene.kinds)
    for attribute in attributes if not short else [words.worked(scene)]:
        for value in scene.display.get(attribute, {}):
            number = int(value) if value.lstrip("-").isdigit() else value
            sign = words.letter(scene, attribute, number), words.colour(scene, attribute, number)
            shared.setdefault(sign, []).append(words.word(scene, attribute, number))
    order = sorted(shared.items(), key=lambda item: words.COLOURS.index(item[0][1]))
    return [joined((letter, f"bold {style}"), (f" {'/'.join(meanings)}", style)) for (letter, style), meanings in order]
