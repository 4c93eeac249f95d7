"""A team's workspace as a drawing: the line with its objects along the north wall, the cells below, the dock column
shaded. Cells come ruled (with walls, for large screens) or compact."""

from __future__ import annotations

from dataclasses import dataclass, field

from rich.text import Text

from bus.messages import BodyFrame, Value
from bus.scene import Workspace
from ops.dashboard import words
from ops.dashboard.model import Model
from ops.dashboard.text import Block, clean, fit, joined

GUTTER = 2
WALL = "dim"
SHADE, BELT = "░", "═"


@dataclass
class Floor:
    """Who stands where in one workspace. Objects east of the line's end are still to come, those west are out."""

    space: Workspace
    cells: dict[tuple[int, int], list[BodyFrame]] = field(default_factory=dict)
    line: dict[int, list[BodyFrame]] = field(default_factory=dict)
    coming: list[BodyFrame] = field(default_factory=list)
    out: list[BodyFrame] = field(default_factory=list)


def bodies(model: Model) -> list[BodyFrame]:
    """All bodies: as the last frame shows them, or as the scene says that they start."""
    if model.frame is not None:
        return list(model.frame.bodies)
    if model.scene is None:
        return []
    rooms = {space.team for space in model.scene.workspaces if space.room}
    out = []
    for entity in model.scene.entities:
        x, y = _cell(entity.place)
        if entity.team in rooms:  # cells begin at their number, and bodies are in the middle
            x, y = x + 0.5, y + 0.5
        base = BodyFrame(entity.id, entity.name, entity.kind, entity.team, x, y, attributes=entity.attributes)
        out.append(base)
    return out


def _cell(place: Value) -> tuple[float, float]:
    numbers = str(place).strip("()").split(",")
    try:
        return float(numbers[0]), float(numbers[1]) if len(numbers) > 1 else 0.0
    except ValueError:
        return 0.0, 0.0


def floor(model: Model, team: str) -> Floor | None:
    scene = model.scene
    space = next((w for w in scene.workspaces if w.team == team), None) if scene else None
    if scene is None or space is None:
        return None
    out = Floor(space)
    for body in bodies(model):
        if body.place != team:
            continue
        kind = scene.kinds.get(body.kind)
        column = round(body.x_m)
        if kind is not None and kind.track == "line":
            if column > space.line_length:
                out.coming.append(body)
            elif column < 1:
                out.out.append(body)
            else:
                out.line.setdefault(column, []).append(body)
        else:
            cell = min(max(column, 1), space.width), min(max(round(body.y_m), 1), space.height)
            out.cells.setdefault(cell, []).append(body)
    return out


def draw(model: Model, ground: Floor, cell_width: int, ruled: bool) -> Block:
    """The drawing, `size(...)` large. North is up; the numbers at the left are the cells' y."""
    space = ground.space
    block: Block = []
    if space.line_length:
        block.append(_line(model, ground, cell_width, ruled))
    if ruled:
        block.append(_wall(space, cell_width, "┌┬┐", "─"))
    for y in range(space.height, 0, -1):
        row: list[Text | tuple[str, str]] = [(f"{y:<{GUTTER}}", WALL)]
        for x in range(1, space.width + 1):
            if ruled:
                row.append(("│", WALL))
            row.append(_inside(model, ground, x, y, cell_width))
        if ruled:
            row.append(("│", WALL))
        block.append(joined(*row))
        if ruled and y > 1:
            block.append(_wall(space, cell_width, "├┼┤", "─"))
    if ruled:
        block.append(_wall(space, cell_width, "└┴┘", "─"))
    return block


def size(space: Workspace, cell_width: int, ruled: bool) -> tuple[int, int]:
    """Width and height of the drawing."""
    line_row = 1 if space.line_length else 0
    if ruled:
        return GUTTER + space.width * (cell_width + 1) + 1, line_row + 2 * space.height + 1
    return GUTTER + space.width * cell_width, line_row + space.height


def _wall(space: Workspace, cell_width: int, corners: str, dash: str) -> Text:
    middle = corners[1].join(dash * cell_width for _ in range(space.width))
    return joined(" " * GUTTER, (corners[0] + middle + corners[2], WALL))


def _line(model: Model, ground: Floor, cell_width: int, ruled: bool) -> Text:
    columns = max(ground.space.line_length, ground.space.width)
    row: list[Text | tuple[str, str]] = [(BELT * GUTTER, WALL)]
    for x in range(1, columns + 1):
        riders = ground.line.get(x, [])
        if ruled:
            row.append((BELT, WALL))
        row.append(_centred(joined(*(thing(model, body) for body in riders[:2])), cell_width, BELT))
    return joined(*row, (BELT if ruled else "", WALL))


def _inside(model: Model, ground: Floor, x: int, y: int, width: int) -> Text:
    here = ground.cells.get((x, y), [])
    docked = x == ground.space.dock_column
    if not here:
        return Text(SHADE * width, style=WALL) if docked else _centred(Text("·", style=WALL), width)
    for letters in (True, False):
        text = _label(model, here, letters)
        if text.cell_len <= width:
            break
    else:
        text = joined(*(_glyph(model, body) for body in here))
    return _centred(text, width, SHADE if docked else " ")


def _label(model: Model, here: list[BodyFrame], letters: bool) -> Text:
    """Everybody in a cell: whoever is coupled to somebody first, and ``=`` between the two."""
    order = sorted(here, key=lambda b: (not b.coupled_to, b.name))
    parts: list[Text | str] = []
    for i, body in enumerate(order):
        before = order[i - 1] if i else None
        if before is not None:
            parts.append("=" if before.coupled_to in (body.id, body.name) else " ")
        parts.append(robot(model, body, letters))
    return joined(*parts)


def robot(model: Model, body: BodyFrame, letters: bool = True) -> Text:
    """``w1p``: name, letter of the tool, and a mark when it is broken or suspected of it."""
    attribute = words.shown(model.scene, body.kind)
    value = body.attributes.get(attribute, "")
    style = words.colour(model.scene, attribute, value)
    text = joined((body.name, f"bold {style}"))
    if attribute and letters:
        text.append(clean(words.letter(model.scene, attribute, value)), style=style)
    belief = model.suspects.get((body.place, body.name), "")
    if body.broken:
        text.append(words.BROKEN, style="bold reverse red" if belief else "bold red")
    elif belief:
        text.append(words.SUSPECT, style="bold yellow")
    return text


def thing(model: Model, body: BodyFrame) -> Text:
    """``[1p~]``: an object with the letter of its stage, and a mark while that settles."""
    attribute = words.shown(model.scene, body.kind)
    value = body.attributes.get(attribute, "")
    style = words.colour(model.scene, attribute, value)
    settling = any(words.holds(body.attributes.get(mark)) for mark in words.marks(model.scene))
    inner = body.name + words.letter(model.scene, attribute, value) + (words.MARKED if settling else "")
    return joined(("[", WALL), (inner, style), ("]", WALL))


def _glyph(model: Model, body: BodyFrame) -> Text:
    kind = model.scene.kinds.get(body.kind) if model.scene else None
    return joined((kind.glyph if kind else "?", "bold red" if body.broken else "bold"))


def _centred(text: Text, width: int, fill: str = " ") -> Text:
    if text.cell_len >= width:
        return fit(text, width)
    left = (width - text.cell_len) // 2
    return joined((fill * left, WALL), text, (fill * (width - left - text.cell_len), WALL))


def progress(model: Model, ground: Floor, short: bool = False) -> Text:
    """How far the objects are: ``2 raw  1 painted  1 out``, or short ``2r 1p 1 out``."""
    scene = model.scene
    attribute = words.worked(scene)
    everything = [*ground.coming, *ground.out, *(b for riders in ground.line.values() for b in riders)]
    parts: list[Text | tuple[str, str]] = []
    for value in sorted({b.attributes[attribute] for b in everything if attribute in b.attributes}, key=str):
        number = sum(b.attributes.get(attribute) == value for b in everything)
        name = words.letter(scene, attribute, value) if short else f" {words.word(scene, attribute, value)} "
        parts.append((f"{number}{name} ", words.colour(scene, attribute, value)))
    if ground.coming and not short:
        parts.append((f"{len(ground.coming)} to come ", ""))
    if ground.out:
        parts.append((f"{len(ground.out)} out", ""))
    text = joined(*parts)
    text.rstrip()
    return text
