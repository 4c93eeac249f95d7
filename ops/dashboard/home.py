"""The middle of the screen when a house is watched: the rooms as large as can be, and what their teams are at."""

from __future__ import annotations

from typing import NamedTuple

from rich.text import Text

from ops.dashboard.house import draw, room
from ops.dashboard.model import Model
from ops.dashboard.rooms import Arrangement, Room, arranged, extent
from ops.dashboard.teams import Style, at_work, clock, mark_of, team
from ops.dashboard.text import Block, beside, ends, fit, joined, line, sized

SIDE, BELOW, TALL = 44, 36, 7
"""Panels beside the rooms are at least so wide, panels below them so wide and so tall."""
LEAST_TALL = 4
TELLING, LEAST_SCALE = 1.5, 5.0
"""Plans are worth so much smaller a picture than a line for each team has, if it is not smaller than this."""
NO_FLOOR = Style(0)


class _Way(NamedTuple):
    """How to share the place: the rooms, panels `beside` them, `below` them, or else a line a team."""

    found: Arrangement
    worth: float
    kind: str


def home(model: Model, teams: list[str], width: int, height: int) -> Block:
    """At most `height` lines of `width` cells, but two in any case; without a picture if there is no place for one."""
    spaces = {w.team: w for w in model.scene.workspaces} if model.scene else {}
    rooms = tuple(room(spaces[name]) for name in teams if name in spaces)
    way = _best(rooms, width, height)
    if way is None:
        return lines(model, teams, width, max(height, 2))
    wide, tall = extent(way.found.views)
    picture = draw(model, way.found.views)
    if way.kind == "beside":
        used = min(max(tall, len(teams) * TALL), height)
        right = width - wide - 1
        heights = [used // len(teams) + (i < used % len(teams)) for i in range(len(teams))]
        panels = [
            text for n, h in zip(teams, heights, strict=True) for text in team(model, n, None, right, h, NO_FLOOR)
        ]
        return beside([sized(picture, wide, used), sized([], 1, used), panels])
    pad = (width - wide) // 2
    block = [line(width, " " * pad, text) for text in picture]
    if way.kind == "lines":
        return [*block, *lines(model, teams, width, len(teams))]
    used = min(height - tall, TALL + 6)
    widths = [width // len(teams) + (i < width % len(teams)) for i in range(len(teams))]
    row = [team(model, n, None, w, used, NO_FLOOR) for n, w in zip(teams, widths, strict=True)]
    return [*block, *beside(row)]


def _best(rooms: tuple[Room, ...], width: int, height: int) -> _Way | None:
    number = max(len(rooms), 1)
    ways = [_way("lines", 1.0, rooms, width, height - number)]
    if height // number >= LEAST_TALL:
        ways.append(_way("beside", TELLING, rooms, width - SIDE - 1, height))
    if width // number >= BELOW:
        ways.append(_way("below", TELLING, rooms, width, height - TALL))
    fit = [way for way in ways if way.found.views]
    telling = [way for way in fit if way.kind == "lines" or way.found.views[0].scale >= LEAST_SCALE]
    return max(telling, key=lambda way: way.worth, default=None)


def _way(kind: str, liking: float, rooms: tuple[Room, ...], columns: int, rows: int) -> _Way:
    found = arranged(rooms, columns, rows)
    return _Way(found, found.worth * liking, kind)


def lines(model: Model, teams: list[str], width: int, height: int) -> Block:
    """A line a team, and a count of those for which there is no line."""
    shown = teams if len(teams) <= height else teams[: height - 1]
    more = [line(width, (f"   and {len(teams) - len(shown)} more teams", "dim"))] if len(shown) < len(teams) else []
    return [*(team_line(model, name, width) for name in shown), *more]


def team_line(model: Model, name: str, width: int) -> Text:
    """A team in one line: how it is, its time, what it does, and the help that is under way."""
    mark, state, tone = mark_of(model, name)
    status = model.statuses.get(name)
    if status is None:
        return line(width, " ", (mark, tone), " ", (f"{name[:12]:<12}", "bold"), " ", (state, tone))
    trouble = "bold red" if name in model.trouble else "green" if status.finished else "bold"
    doing = (state, tone) if state else (status.doing or "finished" * status.finished, "")
    time = fit(clock(model, name, status, 6), 14)
    left = joined(" ", (mark, tone), " ", (f"{name[:12]:<12}", trouble), " ", time, doing, "  ",
                  (at_work(status), "bold"))  # fmt: skip
    return ends(width, left, joined("  ", (f"» {status.helping} ", "cyan")) if status.helping else joined(""))
