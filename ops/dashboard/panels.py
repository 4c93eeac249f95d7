"""The parts of the screen around the workspaces: each a pure function from the model to a block of lines."""

from __future__ import annotations

from rich.text import Text

from bus.messages import Exchange
from ops.dashboard import words
from ops.dashboard.floor import bodies, floor, progress, robot
from ops.dashboard.model import Model
from ops.dashboard.teams import AWAY, mark_of
from ops.dashboard.text import Block, ends, fit, joined, line, rule, sized, wrapped
from ops.processes import ROUTER
from reasoning.words import count


def bench(model: Model, width: int) -> Text:
    """Who is on the bench, and which robots are lent or will be."""
    everybody = bodies(model)
    loans: dict[str, Exchange] = {}  # of a robot that is passed on, the one that is next
    for loan in sorted((e for s in model.statuses.values() for e in s.exchanges), key=lambda e: e.take_step):
        if loan.robot not in loans or loans[loan.robot].take_step <= model.step:
            loans[loan.robot] = loan
    there: list[Text] = []
    for body in (b for b in everybody if b.place == "bench"):
        due = loans.pop(body.id) if body.id in loans else None
        where = f" under way {due.giver}→{due.taker}, there at step {due.take_step}" if due else " waits"
        there.append(joined(robot(model, body), (where, "cyan")))
    home = {b.id: b.place for b in everybody}
    lent: list[Text] = []
    for loan in loans.values():
        arrived = home.get(loan.robot) == loan.taker
        when = "arrived" if arrived else f"steps {loan.give_step}→{loan.take_step}"
        text = f"{loan.worker} {loan.giver}→{loan.taker} as {loan.known_as} ({when})"
        lent.append(joined((text, "dim" if arrived else "")))
    dot = Text(" · ", style="dim")
    parts = [joined((f" {words.place(model.scene, 'bench')} ", "dim"), dot.join(there) if there else ("empty", "dim"))]
    if lent:
        parts.append(joined(("  loans ", "dim"), dot.join(lent)))
    return line(width, *parts)


def hallway(model: Model, width: int) -> Block:
    """Who is on the way between two rooms; no line if nobody is."""
    away = [body.id.partition(".") for body in bodies(model) if body.place == "bench"]
    parts = [joined((name, "bold"), f" of {team}") for team, _, name in away]
    head = joined((f" {words.place(model.scene, 'bench')} ", "dim"))
    return [line(width, head, Text(" · ", style="dim").join(parts), (" under way", "cyan"))] if parts else []


def events(model: Model, width: int, height: int) -> Block:
    """The last events, most recent at the bottom, each in at most two lines."""
    signs = joined(*(joined("  ", (f"{sign} {tone}", style)) for tone, (sign, style) in words.TONES.items()))
    head = rule(width, joined(("events", "bold"), signs), joined((f"{model.recorded} so far", "dim")))
    room = height - 1
    rows: Block = []
    lead = 8 + 13 + 2
    for note in reversed(model.events):
        if len(rows) >= room:
            break
        sign, style = words.TONES.get(note.tone, (" ", ""))
        # What went well says so itself; what did not is easier to find under its name.
        said = f"{note.kind.replace('_', ' ')}: {note.text}" if note.tone in ("fault", "cause", "") else note.text
        texts = wrapped(said, max(width - lead, 8), 2)
        first = line(width, (f"{note.at_s:7.1f} ", "dim"), (f"{note.source[:12]:<13}", "bold"),
                     (f"{sign} {texts[0]}", style))  # fmt: skip
        rest = [line(width, " " * lead, (more, style)) for more in texts[1:]]
        rows = ([first, *rest] if len(rows) + 1 + len(rest) <= room else [first]) + rows
    return [head, *sized(rows, width, room)]


def names(model: Model) -> list[str]:
    """All processes heard of: the teams last, in their order. The router says nothing, so it is among them only when
    something is wrong with it."""
    known = {*model.pulses, *model.statuses, *model.contact}
    if model.contact.get(ROUTER) not in AWAY:
        known.discard(ROUTER)
    return sorted(known - set(model.teams)) + [t for t in model.teams if t in known]


def processes(model: Model, width: int, height: int) -> Block:
    """A line a process: what it does, messages out and in per second, round trip; dense if there are too many."""
    rates = any(pulse.heard_s is not None for pulse in model.pulses.values())
    units = "out/s   in/s  answer ms" if rates else "  out     in  answer ms"
    head = rule(width, joined(("processes", "bold")), joined((units, "dim")))
    rows: Block = []
    known = names(model)
    room = height - 1
    for name in known:
        mark, state, tone = mark_of(model, name)
        pulse, status = model.pulses.get(name), model.statuses.get(name)
        doing = state or (status.doing if status else "") or (pulse.beat.doing if pulse else "")
        left = joined(" ", (mark, tone), f" {name[:12]:<12} ", (doing, tone if state else ""))
        rows.append(ends(width, left, joined(figures(model, name), "  ")))
    if len(rows) > room > 0:
        rows = [*rows[: room - 1], fit(joined((f"   and {len(known) - room + 1} more", "dim")), width)]
    return [head, *sized(rows, width, room)]


def team_line(model: Model, name: str) -> tuple[Text, Text]:
    """A team in one line, for when there are too many to draw: how it is and where in its plan."""
    mark, state, tone = mark_of(model, name)
    status, ground = model.statuses.get(name), floor(model, name)
    doing = state or (status.doing if status else "")
    trouble = "bold red" if name in model.trouble else "green" if status and status.finished else "bold"
    left = joined(" ", (mark, tone), " ", (f"{name:<6}", trouble), " ", (doing, tone if state else ""))
    steps = f"  step {max(status.step, 0)}/{status.start + len(status.plan)} " if status and status.plan else " "
    return left, joined(progress(model, ground) if ground else "", steps)


def figures(model: Model, name: str) -> Text:
    pulse = model.pulses.get(name)
    if pulse is None:
        return joined(("     -      -          -", "dim"))
    beat = pulse.beat
    rates = (f"{pulse.sent_per_s:6.0f} {pulse.received_per_s:6.0f}" if pulse.heard_s is not None
             else f"{beat.sent:6d} {beat.received:6d}")  # fmt: skip
    refused = (f" {beat.refused} refused", "bold red") if beat.refused else ("", "")
    return joined(refused, (f" {rates} {beat.latency_ms:10.1f}", ""))


def processes_line(model: Model, width: int) -> Text:
    """All processes in one line: how many are well, and those that are not by name."""
    marks = {name: mark_of(model, name) for name in names(model)}
    well = sum(not state for _, state, _ in marks.values())
    parts: list[tuple[str, str]] = [(" processes ", "dim"), ("● ", "green" if well else "dim")]
    parts.append((f"{well} of {len(marks)} present", ""))
    parts += [(f"  {mark} {name} {state}", tone) for name, (mark, state, tone) in marks.items() if state]
    pulses = model.pulses.values()
    if any(p.heard_s is not None for p in pulses):
        parts.append((f" · {sum(p.sent_per_s for p in pulses):.0f} messages/s", ""))
    elif pulses:
        parts.append((f" · {count(sum(p.beat.sent for p in pulses), 'message')}", ""))
    if pulses:
        parts.append((f", slowest answer {max(p.beat.latency_ms for p in pulses):.1f} ms", ""))
    return line(width, *parts)
