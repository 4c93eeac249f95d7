"""What a watcher knows: a value folded from the messages it has seen. No bus, no clock, no terminal in here."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from bus.messages import Beat, Envelope, Event, Frame, Status
from bus.scene import Scene

KEPT_EVENTS = 300
# Too many to read; what they tell is drawn.
UNLISTED = frozenset({"step_started", "step_ended", "membership"})
# Of interest while nothing else happens: the last few are listed until something does.
PASSING, PASSING_SHOWN = frozenset({"question", "bound"}), 2
TONES = {
    "fault_injected": "fault", "discrepancy": "fault", "skill_failed": "fault", "no_plan": "fault", "refused": "fault",
    "needs_person": "fault", "deadline_missed": "fault", "nobody_helps": "fault", "set_aside": "fault",
    "diagnosis": "cause", "inspection": "cause", "contact": "cause", "order": "cause",
    "unknown_object": "cause", "person_in_way": "cause", "held_up": "cause", "object_not_found": "cause",
    "heavy_object": "cause", "robot_broken": "cause", "object_appeared": "cause", "deadline_at_risk": "cause",
    "repair": "recovery", "plan_adopted": "recovery", "search_started": "recovery", "process": "recovery",
    "new_way": "recovery", "waited": "recovery", "safe_state": "recovery", "plan_dropped": "recovery",
    "made_way": "recovery", "stays": "recovery",
    "help_wanted": "recovery", "help_offered": "recovery", "help_answered": "recovery", "help_confirmed": "recovery",
    "help_released": "recovery", "helper_left": "recovery", "helper_came": "recovery", "helper_sent_back": "recovery",
    "exchange": "success", "shared_plan": "success", "team_finished": "success", "run_over": "success",
    "helper_called": "recovery", "helper_gone": "cause", "waits_at_door": "recovery", "helper_returned": "success",
}  # fmt: skip


@dataclass(frozen=True)
class Note:
    """One line of the list of events."""

    at_s: float
    source: str
    kind: str
    text: str
    tone: str = ""


@dataclass(frozen=True)
class Pulse:
    """A process's counters and what became of them since the beat before, per second of the watcher's clock."""

    beat: Beat
    heard_s: float | None = None
    sent_per_s: float = 0.0
    received_per_s: float = 0.0


@dataclass(frozen=True)
class Model:
    """`contact`: names whose process is not just present. `suspects`: (team, robot) to ``suspected`` or
    ``broken`` as the team believes; `doubts`: what may be broken, by each explanation that a team has left.
    `trouble`: teams off their plan. `done`: when teams were done, until they plan again.
    `numbers`: incarnation and number of each status. `clock_s`: the watcher's clock.
    """

    run: str = ""
    scene: Scene | None = None
    now_s: float = 0.0
    clock_s: float | None = None
    step: int = -1
    frame: Frame | None = None
    statuses: Mapping[str, Status] = field(default_factory=dict)
    numbers: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    pulses: Mapping[str, Pulse] = field(default_factory=dict)
    events: tuple[Note, ...] = ()
    recorded: int = 0
    contact: Mapping[str, str] = field(default_factory=dict)
    suspects: Mapping[tuple[str, str], str] = field(default_factory=dict)
    doubts: Mapping[str, tuple[frozenset[str], ...]] = field(default_factory=dict)
    trouble: frozenset[str] = frozenset()
    done: Mapping[str, float] = field(default_factory=dict)
    over: Mapping[str, object] | None = None
    verdict: tuple[str, ...] = ()

    @property
    def teams(self) -> tuple[str, ...]:
        """The teams in the scene's order, or those that were heard of."""
        if self.scene is not None:
            return tuple(w.team for w in self.scene.workspaces)
        return tuple(sorted(n for n, s in self.statuses.items() if s.role == "team"))

    @property
    def coordinator(self) -> Status | None:
        return next((s for s in self.statuses.values() if s.role == "coordinator"), None)


def update(model: Model, message: Envelope | Scene, clock_s: float | None = None) -> Model:
    """The model after one more message. `clock_s` is the watcher's clock, for rates; left out in a replay."""
    if isinstance(message, Scene):
        return replace(model, scene=message)
    body = message.body
    if not isinstance(body, Event | Status | Frame | Beat):
        return model
    model = replace(
        model,
        run=message.run,
        now_s=max(model.now_s, message.at_s),
        clock_s=model.clock_s if clock_s is None else clock_s,
    )
    match body:
        case Frame():
            return replace(model, frame=body, step=max(model.step, body.step))
        case Status():
            # What is kept for late joiners may come after what is said just now.
            number = (message.inc, message.seq)
            if number < model.numbers.get(message.src, number):
                return model
            return replace(
                model,
                statuses={**model.statuses, message.src: body},
                numbers={**model.numbers, message.src: number},
            )
        case Beat():
            return _pulse(model, message.src, body, clock_s)
        case Event():
            return _event(model, message, body)


def _pulse(model: Model, source: str, beat: Beat, clock_s: float | None) -> Model:
    before = model.pulses.get(source)
    pulse = Pulse(beat, clock_s)
    if before is not None and before.heard_s is not None and clock_s is not None and before.beat.pid == beat.pid:
        passed = clock_s - before.heard_s
        if passed <= 0.05:  # too close together for a rate that means anything
            pulse = replace(before, beat=beat)
        else:
            sent, received = beat.sent - before.beat.sent, beat.received - before.beat.received
            pulse = Pulse(beat, clock_s, max(sent, 0) / passed, max(received, 0) / passed)
    return replace(model, pulses={**model.pulses, source: pulse})


def _event(model: Model, envelope: Envelope, event: Event) -> Model:
    data = event.data
    model = _effects(model, event.kind, data, envelope.src)
    expected = data.get("state") in ("present", "started") or (event.kind == "started" and not data.get("recovered"))
    if event.kind in UNLISTED or expected:
        return replace(model, recorded=model.recorded + 1)
    text = data.get("text") or ", ".join(f"{k} {v}" for k, v in data.items())
    note = Note(envelope.at_s, envelope.src, event.kind, str(text), _tone(event.kind, data))
    notes = model.events
    passing = next((i for i, n in enumerate(reversed(notes)) if n.kind not in PASSING), len(notes))
    keep = min(passing, PASSING_SHOWN - 1) if note.kind in PASSING else 0
    notes = (*notes[: len(notes) - passing], *notes[len(notes) - keep :])
    return replace(model, events=(*notes[1 - KEPT_EVENTS :], note), recorded=model.recorded + 1)


def _tone(kind: str, data: Mapping[str, object]) -> str:
    if kind == "run_over" and not data.get("goal"):
        return "fault"
    if (kind, data.get("state")) in {("contact", "lost_contact"), ("process", "died"), ("process", "gave_up")}:
        return "fault"
    return "recovery" if data.get("state") == "back" else TONES.get(kind, "")


def _effects(model: Model, kind: str, data: Mapping[str, object], source: str) -> Model:
    """What an event changes in the picture. Data of the wrong shape changes nothing."""
    team = str(data.get("team", source))
    match kind, data:
        case "contact" | "process", {"name": str(name), "state": str(state)}:
            return replace(model, contact={**model.contact, name: state})
        case "discrepancy" | "no_plan", _:
            return replace(model, trouble=model.trouble | {team})
        case "plan_adopted", _:
            # Whoever plans again has settled what was the matter: what is left are the robots known to be broken.
            settled = {k: v for k, v in model.suspects.items() if k[0] != team or v == "broken"}
            done = {name: at_s for name, at_s in model.done.items() if name != team}
            return replace(model, trouble=model.trouble - {team}, suspects=settled, done=done)
        case "team_finished", _:
            return replace(model, done={team: model.now_s, **model.done})
        case "diagnosis", {"causes": list(causes)}:
            alternatives = tuple(
                frozenset(robot for cause in one for robot in re.findall(r"^broken\((\w+)", str(cause)))
                for one in causes
                if isinstance(one, list | tuple)
            )
            return _doubting(model, team, alternatives)
        case "inspection", {"robot": str(robot)}:
            broken = str(data.get("finding")) == "broken"
            found = {**model.suspects, (team, robot): "broken"} if broken else _without(model.suspects, (team, robot))
            left = tuple(a for a in model.doubts.get(team, ()) if (robot in a) == broken)
            return _doubting(replace(model, suspects=found), team, left)
        case "robot_broken", {"robot": str(robot)}:
            return replace(model, suspects={**model.suspects, (team, robot): "broken"})
        case "repair", {"robot": str(robot)}:
            return replace(model, suspects=_without(model.suspects, (team, robot)))
        case "step_started", {"step": int(step)}:
            return replace(model, step=max(model.step, step))
        case "run_over", _:
            return replace(model, over=dict(data))
    return model


def _doubting(model: Model, team: str, alternatives: tuple[frozenset[str], ...]) -> Model:
    """What the team believes while only these explanations are left: what they all share is broken."""
    known = {k: v for k, v in model.suspects.items() if k[0] != team or v == "broken"}
    for robot in sorted(frozenset().union(*alternatives)):
        sure = all(robot in alternative for alternative in alternatives)
        known.setdefault((team, robot), "broken" if sure else "suspected")
    return replace(model, suspects=known, doubts={**model.doubts, team: alternatives})


def _without(suspects: Mapping[tuple[str, str], str], key: tuple[str, str]) -> dict[tuple[str, str], str]:
    return {k: v for k, v in suspects.items() if k != key}
