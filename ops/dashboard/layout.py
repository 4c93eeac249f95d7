"""Where everything goes. `render` is a pure function of the model and the size; every line fits exactly."""

from __future__ import annotations

from typing import NamedTuple

from rich.text import Text

from ops.dashboard import panels
from ops.dashboard.floor import Floor, floor, size
from ops.dashboard.header import header, legend
from ops.dashboard.home import home
from ops.dashboard.house import is_house
from ops.dashboard.model import Model
from ops.dashboard.teams import Style, team
from ops.dashboard.text import PLAIN, Block, beside, ends, line, sized

MIN_WIDTH, MIN_HEIGHT = 40, 12
WIDE, EVENTS_WIDE = 120, 88
"""From here on events and processes are side by side; beyond so much for the events, the processes get the rest."""
TALL, EVENTS_TALL, EVENTS_LOW = 36, 12, 6
"""From so many lines on a screen is tall; lines for what is below a house, on a tall screen and on a low one."""
KEYS = "tab team  q quit"


# Styles, best first, each with the plan's width (beside the floor) or number of lines (below it).
LOOKS = (
    (Style(9, ruled=True, side=True), 30, 0), (Style(7, ruled=True, side=True), 30, 0), (Style(7, ruled=True), 0, 3),
    (Style(9, side=True), 24, 0), (Style(7, side=True), 24, 0), (Style(9), 0, 2), (Style(7), 0, 2), (Style(7), 0, 1),
    (Style(5), 0, 1), (Style(4), 0, 1), (Style(4), 0, 0),
)  # fmt: skip


class Grid(NamedTuple):
    """Panels of one style in columns and rows; `plan` lines below the floor in each."""

    look: Style
    columns: int
    rows: int
    height: int


def render(model: Model, width: int, height: int, *, focus: str = "", note: str = "", keys: str = KEYS,
           ascii_only: bool = False) -> Text:  # fmt: skip
    """The whole screen as one text of exactly `height` lines of `width` cells.

    `focus`: show this team alone. `note`: what the watcher itself has to say (paused). `keys`: help for the last line.
    """
    if width < MIN_WIDTH or height < MIN_HEIGHT:
        screen = sized([line(width, "too small:"), line(width, f"{MIN_WIDTH}x{MIN_HEIGHT} at least")], width, height)
    else:
        screen = _screen(model, width, height, focus, note, keys)
    out = Text("\n", no_wrap=True, end="").join(screen)
    if ascii_only:
        return Text(out.plain.translate(PLAIN), no_wrap=True, end="")
    return out


def _screen(model: Model, width: int, height: int, focus: str, note: str, keys: str) -> Block:
    top = header(model, width, note)
    foot = legend(model, width, keys)
    teams = [focus] if focus in model.teams else list(model.teams)
    if is_house(model.scene):
        bench = panels.hallway(model, width)
        room = height - len(top) - len(foot)
        middle = home(model, teams, width, room - (EVENTS_TALL if height >= TALL else EVENTS_LOW))
        used = len(middle) + len(bench)  # the picture stays when the hallway's line comes and goes
    else:
        bench = [panels.bench(model, width)]
        room = height - len(top) - len(foot) - 1
        middle, used = _teams(model, teams, [floor(model, name) for name in teams], width, room)
    below = _below(model, width, room - used)
    return sized([*top, *middle, *bench, *below, *foot], width, height)


def _teams(model: Model, teams: list[str], floors: list[Floor | None], width: int, room: int) -> tuple[Block, int]:
    """The panels of all teams and how many lines they took."""
    if not teams:
        return [line(width, ("   no teams heard of yet", "dim"))], 1
    grid = choose(floors, width, room)
    if grid is None:
        return _summary(model, teams, width, max(room - 6, 2))
    block: Block = []
    for start in range(0, len(teams), grid.columns):
        row = list(zip(teams, floors, strict=True))[start : start + grid.columns]
        widths = [width // grid.columns + (i < width % grid.columns) for i in range(len(row))]
        blocks = [team(model, n, f, w, grid.height, grid.look) for (n, f), w in zip(row, widths, strict=True)]
        if len(row) < grid.columns:
            blocks.append(sized([], width - sum(widths), grid.height))
        block += beside(blocks)
    return block, len(block)


def choose(floors: list[Floor | None], width: int, room: int) -> Grid | None:
    """The most telling way to draw all teams that leaves lines for events; None if there is no way."""
    for generous in (True, False):
        for look, plan_width, plan_lines in LOOKS:
            spare = max(room * 2 // 5, 7) if generous else 5
            spaces = [size(f.space, look.cell, look.ruled) for f in floors if f] or [(28, 2)]
            floor_width, floor_height = max(w for w, _ in spaces), max(h for _, h in spaces)
            panel = 2 + floor_width + (1 + plan_width if look.side else 0)
            tall = 1 + floor_height + (0 if look.side else plan_lines)
            for columns in _balanced(len(floors), min(width // panel, len(floors))):
                rows = -(-len(floors) // columns)
                if rows * tall + spare <= room:
                    extra = (room - spare - rows * tall) // (2 * rows)
                    return Grid(look, columns, rows, tall + min(extra, 3 if look.side else 8))
    return None


def _balanced(number: int, most: int) -> list[int]:
    """Numbers of columns to try: fewest rows first, and without a gap where that is possible."""
    return sorted(range(1, most + 1), key=lambda c: (-(-number // c), -number % c))


def _summary(model: Model, teams: list[str], width: int, room: int) -> tuple[Block, int]:
    """Too many teams to draw: a line each, and a count of those that do not fit."""
    shown = teams if len(teams) <= room else teams[: room - 1]
    block: Block = [ends(width, *panels.team_line(model, name)) for name in shown]
    if len(shown) < len(teams):
        block.append(line(width, (f"   and {len(teams) - len(shown)} more teams", "dim")))
    return block, len(block)


def _below(model: Model, width: int, room: int) -> Block:
    """Events and processes: side by side if there is room, else the processes in one line."""
    if width >= WIDE:
        right = min(max(width * 2 // 5, width - EVENTS_WIDE), 78)
        left = width - right - 1
        return beside([panels.events(model, left, room), sized([], 1, room), panels.processes(model, right, room)])
    if room >= 18:
        tall = min(len(panels.names(model)) + 1, room // 2)
        return [*panels.events(model, width, room - tall), *panels.processes(model, width, tall)]
    return [panels.processes_line(model, width), *panels.events(model, width, room - 1)]
