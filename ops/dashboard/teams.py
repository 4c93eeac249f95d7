"""A team's panel: its floor, its plan around the current step, and how its process is."""

from __future__ import annotations

from math import ceil
from typing import NamedTuple

from rich.text import Text

from bus.messages import Status
from ops.dashboard.floor import Floor, draw, progress
from ops.dashboard.model import Model
from ops.dashboard.text import Block, beside, boxed, joined, line, sized, wrapped

SILENT_S = 3.0
CLOSE = 0.8
"""Of the time to the deadline, when it is shown to run out."""
AWAY = {"lost_contact": ("○", "lost contact", "bold yellow"), "died": ("✗", "died", "bold red"),
        "gave_up": ("✗", "given up", "bold red"), "stopped": ("○", "stopped", "dim")}  # fmt: skip


def mark_of(model: Model, name: str) -> tuple[str, str, str]:
    """Mark, state in words (empty if all is well) and style of a process."""
    state = model.contact.get(name, "")
    pulse = model.pulses.get(name)
    if state in AWAY:
        return AWAY[state]
    if pulse is not None and pulse.heard_s is not None and model.clock_s is not None:
        silence = model.clock_s - pulse.heard_s
        if silence > SILENT_S:
            return "○", f"silent for {silence:.0f} s", "yellow"
    if pulse is None and name not in model.statuses:
        return "○", "", "dim"
    return "●", "", "green"


class Style(NamedTuple):
    """How a team is drawn: cells so wide (0: not at all), with walls or not, the plan beside the floor or below."""

    cell: int
    ruled: bool = False
    side: bool = False


def team(model: Model, name: str, ground: Floor | None, width: int, height: int, look: Style) -> Block:
    """One team: its workspace and, beside or below it, its plan around the current step."""
    status = model.statuses.get(name)
    title, right, style = _team_head(model, name, status, ground, width)
    inner, rows = width - 2, height - 1
    facts = told(model, name, status, inner)[:rows]
    rows -= len(facts)
    drawing = draw(model, ground, look.cell, look.ruled) if ground and look.cell else []
    broad = max((text.cell_len for text in drawing), default=0)
    if look.side and drawing:
        beyond = inner - broad - 1
        content = beside([sized(drawing, broad, rows), sized([], 1, rows), plan(status, beyond, rows)])
    else:
        drawing = drawing[:rows]
        pad = (inner - broad) // 2 if drawing else 0
        drawing = [line(inner, " " * pad, text) for text in drawing]
        content = drawing + plan(status, inner, rows - len(drawing))
    return boxed(facts + content, width, height, title, right, style)


def _team_head(
    model: Model, name: str, status: Status | None, ground: Floor | None, width: int
) -> tuple[Text, Text, str]:
    mark, state, tone = mark_of(model, name)
    doing = state or (status.doing if status else "")
    style = "dim"
    if name in model.trouble:
        style = "red"
    elif status is not None and status.finished:
        style, doing = "green", doing or "finished"
    title = joined((mark, tone), " ", (name, "bold"), " ", (doing, tone if state else ""))
    right = progress(model, ground, short=width < 70) if ground else Text("")
    if title.cell_len + right.cell_len + 7 > width:  # what it is doing matters more
        right = Text("")
    return title, right, tone if state and tone != "dim" else style


def told(model: Model, name: str, status: Status | None, width: int) -> Block:
    """A line for the time, if the team counts it, and one for the help that is under way, if there is any."""
    if status is None:
        return []
    out: Block = []
    if status.elapsed >= 0:
        late = " deadline missed" if 0 < status.deadline < elapsed(model, name, status) else ""
        bar = max(min(width - 17 - len(late), 40), 4)
        out.append(line(width, " time  ", clock(model, name, status, bar), (late, "bold red")))
    if status.helping:
        out.append(line(width, (" help  ", ""), (f"» {status.helping}", "cyan")))
    return out


def elapsed(model: Model, name: str, status: Status) -> int:
    """Units of time that the team has taken for its own work: it counts when it looks, and time goes on."""
    if model.scene is None or (status.finished and name not in model.done):
        return status.elapsed
    units = ceil(model.done.get(name, model.now_s) / model.scene.period_s - 1e-9)
    return units if name in model.done else max(status.elapsed, units)


def clock(model: Model, name: str, status: Status, bar: int) -> Text:
    """``14/25 ━━━━────`` units of time of the deadline, or ``14 units``; nothing if the team does not count."""
    if status.elapsed < 0:
        return joined("")
    units = elapsed(model, name, status)
    if not status.deadline:
        return joined(f"{units:>2} units")
    share = min(units / status.deadline, 1.0)
    style = "bold red" if units > status.deadline else "yellow" if share > CLOSE else "green"
    done = round(share * bar)
    return joined((f"{units:>2}/{status.deadline} ", style), ("━" * done, style), ("─" * (bar - done), "dim"))


def at_work(status: Status) -> str:
    """The actions of the plan's current step; nothing if there is none."""
    now = status.step - status.start
    return "  ".join(status.plan[now]) if 0 <= now < len(status.plan) and not status.finished else ""


def plan(status: Status | None, width: int, rows: int) -> Block:
    """The plan around the current step: as many steps before it as a quarter of the rows, then what comes."""
    if rows <= 0:
        return []
    if status is None or not status.plan:
        begun = status is not None and status.step > 0
        words = " nothing left to do" if status and status.finished else " no plan now" if begun else " no plan yet"
        return sized([line(width, (words, "dim"))], width, rows)
    now = min(max(status.step - status.start, 0), len(status.plan) - 1)
    done = status.finished or status.step - status.start >= len(status.plan)
    first = max(min(now - rows // 4, len(status.plan) - rows), 0)
    out: Block = []
    for i in range(first, min(first + rows, len(status.plan))):
        current = i == now and not done
        style = "bold" if current else "dim" if i < now or done else ""
        pointer = ("▶" if current else " ", "bold cyan")
        # The current step is told in full where there is room for it, the others in a line each.
        texts = wrapped("  ".join(status.plan[i]) or "-", max(width - 5, 1), 3 if current and rows > 3 else 1)
        out.append(line(width, pointer, (f"{status.start + i:>3} ", style or "dim"), (texts[0], style)))
        out += [line(width, " " * 5, (text, style)) for text in texts[1:]]
    return sized(out, width, rows)
