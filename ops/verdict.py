"""What came out of a run, held against what its scenario says must come out. Pure: events in, report out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import msgspec

from bus.messages import Beat, Envelope, Event, RunOver
from ops.scenario import Verdict
from reasoning.words import count

NOT_OVER = "the run ended before the coordinator said that it was over"


class Condition(msgspec.Struct, frozen=True):
    """One condition of ``[verdict]`` and whether it holds; `found` is what decided it."""

    text: str
    ok: bool
    found: str = ""


class Messages(msgspec.Struct, frozen=True):
    """Sums over all processes and all their lives: mail as far as their last signs of life tell (the last 0.4 s of
    one that was killed are not in them), and the events recorded."""

    sent: int = 0
    received: int = 0
    repeated: int = 0
    refused: int = 0
    events: int = 0


class Report(msgspec.Struct, frozen=True):
    """The end of a run. `invariants` lists what was broken (None: not checked), `diagnoses` one entry an event."""

    goal: bool
    reason: str
    makespan: int
    replans: int
    diagnoses: tuple[dict[str, Any], ...]
    messages: Messages
    invariants: tuple[str, ...] | None
    conditions: tuple[Condition, ...]

    @property
    def exit_code(self) -> int:
        """0 goal reached, verdict and invariants held; 1 not; 3 an invariant broken."""
        if self.invariants:
            return 3
        return 0 if self.goal and all(condition.ok for condition in self.conditions) else 1


def judge(
    verdict: Verdict,
    events: Sequence[Envelope],
    over: RunOver | None,
    invariants: Sequence[str] | None = None,
    beats: Iterable[Envelope] = (),
    stopped: str = "",
) -> Report:
    """The report. `over` is the coordinator's last word, `stopped` why the run ended without one."""
    said = [(envelope.src, envelope.body) for envelope in events if isinstance(envelope.body, Event)]
    goal = over is not None and over.goal
    done = (int(str(event.data["step"])) + 1 for _, event in said if event.kind == "step_ended")
    makespan = over.makespan if over else max(done, default=0)
    replans = over.replans if over else max(sum(event.kind == "shared_plan" for _, event in said) - 1, 0)
    reason = over.reason if over else stopped or NOT_OVER
    conditions = [Condition(f"goal {'reached' if verdict.goal else 'not reached'}", goal == verdict.goal, reason)]
    if verdict.makespan_at_most is not None:
        conditions.append(_makespan(verdict.makespan_at_most, makespan, goal))
    if verdict.optimal is not None:
        conditions.append(_optimal(verdict.optimal, [event for _, event in said if _is_plan(event)]))
    for pattern in verdict.eventually:
        first = next((event for source, event in said if matches(pattern, source, event)), None)
        conditions.append(
            Condition(f"eventually {written(pattern)}", first is not None, _text(first) or "never happened")
        )
    for pattern in verdict.never:
        first = next((event for source, event in said if matches(pattern, source, event)), None)
        conditions.append(Condition(f"never {written(pattern)}", first is None, _text(first)))
    return Report(
        goal=goal,
        reason=reason,
        makespan=makespan,
        replans=replans,
        diagnoses=tuple(dict(event.data) for _, event in said if event.kind == "diagnosis"),
        messages=_messages(beats, len(said)),
        invariants=None if invariants is None else tuple(invariants),
        conditions=tuple(conditions),
    )


def matches(pattern: Mapping[str, Any], source: str, event: Event) -> bool:
    """Is the event of the pattern's kind, and does it have all its fields with the same values?"""
    fields = {"event": event.kind, "source": source, **event.data}
    return all(key in fields and _plain(fields[key]) == _plain(value) for key, value in pattern.items())


def written(pattern: Mapping[str, Any]) -> str:
    """A pattern for people: ``diagnosis (team T4, causes [["broken(c1)"]])``."""
    rest = ", ".join(f"{key} {_value(value)}" for key, value in pattern.items() if key != "event")
    return f"{pattern['event']}{f' ({rest})' if rest else ''}"


def _makespan(limit: int, makespan: int, goal: bool) -> Condition:
    return Condition(f"makespan at most {limit}", goal and makespan <= limit, count(makespan, "step"))


def _is_plan(event: Event) -> bool:
    """A shared plan, or the plan of a team that acts for itself."""
    return event.kind == "shared_plan" or (event.kind == "plan_adopted" and "status" in event.data)


def _optimal(wanted: bool, plans: Sequence[Event]) -> Condition:
    """All plans that muster found itself (a given one is not judged) are proved to be the shortest."""
    found = [str(event.data.get("status")) for event in plans if event.data.get("status") != "given"]
    proved = bool(found) and all(status == "optimal" for status in found)
    return Condition(
        f"plans {'' if wanted else 'not all '}proved optimal", proved == wanted, ", ".join(found) or "no plan"
    )


def _messages(beats: Iterable[Envelope], events: int) -> Messages:
    last: dict[tuple[str, int], Beat] = {}
    for envelope in beats:
        if isinstance(envelope.body, Beat):
            last[envelope.src, envelope.inc] = envelope.body
    return Messages(
        sent=sum(beat.sent for beat in last.values()),
        received=sum(beat.received for beat in last.values()),
        repeated=sum(beat.repeated for beat in last.values()),
        refused=sum(beat.refused for beat in last.values()),
        events=events,
    )


def _plain(value: Any) -> Any:
    """Lists and tuples are the same here."""
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return value


def _value(value: Any) -> str:
    return value if isinstance(value, str) else msgspec.json.encode(value).decode()


def _text(event: Event | None) -> str:
    return "" if event is None else str(event.data.get("text") or event.kind)
