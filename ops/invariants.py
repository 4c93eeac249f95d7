"""What must have been true all through a run, checked on its recording. Shares nothing with the code that runs.

1. Every robot is in exactly one team or on the bench, and changes teams by way of the bench, where it is as long as
   transport takes.
2. No work is done twice, skipped, undone or lost: an object's stage rises by one at a time, by an action of its team
   (or a person changed it), and no object appears or vanishes but by an order.
3. No command takes effect twice.
4. Every event that was sent was received and recorded.
5. In rooms no body is in another, and nobody is pushed (`ops.touching`).

`check` returns a sentence for each violation; none if all hold.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from typing import Any

from bus.keys import WORLD
from bus.messages import Beat, Envelope, Event, Frame
from bus.scene import Scene
from ops.recording import Recording
from ops.touching import pushed, touching
from reasoning.words import count

BENCH = "bench"


def check(recording: Recording) -> list[str]:
    """All violations, in plain sentences."""
    if not recording.events:
        return ["the recording has no events"]
    if recording.scene is None:
        return ["the recording has no scene, so that robots and work cannot be checked", *counts(recording)]
    return [*robots(recording, recording.scene), *work(recording, recording.scene), *commands(recording),
            *touching(recording, recording.scene), *pushed(recording, recording.scene), *counts(recording)]  # fmt: skip


def robots(recording: Recording, scene: Scene) -> Iterator[str]:
    """Every robot in exactly one place, at every step's end and in every frame."""
    known = {e.id for e in scene.entities if scene.kinds[e.kind].role == "robot"}
    places = {w.team for w in scene.workspaces} | {BENCH}
    before: dict[str, str] = {}
    left: dict[str, tuple[str, int]] = {}
    delays = {(t.giver, t.taker): t.steps for t in scene.transports}
    for data in _world(recording, "membership"):
        step, now = data.get("step"), _pairs(data.get("robots"))
        for robot in sorted(known - now.keys()):
            yield f"step {step}: robot {robot} is in no team and not on the bench"
        for robot in sorted(now.keys() - known):
            yield f"step {step}: robot {robot} came from nowhere"
        named = Counter(pair for pair in now.values() if pair[0] != BENCH)
        for (place, name), number in named.items():
            if number > 1:
                yield f"step {step}: {number} robots are called {name} in {place}"
        for robot, (place, _) in now.items():
            was = before.get(robot, place)
            if place not in places:
                yield f"step {step}: robot {robot} is in {place!r}, which is neither a team nor the bench"
            elif place != was and BENCH not in (place, was):
                yield f"step {step}: robot {robot} went from {was} to {place} without having been on the bench"
            elif place != was and isinstance(step, int) and scene.conducted:  # else every team counts its own steps
                if place == BENCH:
                    left[robot] = was, step
                elif robot in left:
                    giver, since = left[robot]
                    least = delays.get((giver, place), scene.transport_delay_steps)
                    if step - since < least:
                        early = f"{count(step - since, 'step')} after {giver} gave it, not {least}"
                        yield f"step {step}: robot {robot} came to {place} {early}"
            before[robot] = place
    for envelope in recording.frames:
        if isinstance(envelope.body, Frame):
            ids = Counter(body.id for body in envelope.body.bodies)
            for body, number in ids.items():
                if number > 1:
                    yield f"{envelope.at_s:.2f} s: {body} is in {number} places at once"
            for robot in sorted(known - ids.keys()):
                yield f"{envelope.at_s:.2f} s: robot {robot} is nowhere"


def work(recording: Recording, scene: Scene) -> Iterator[str]:
    """Stages rise by one at a time, by work that was commanded; objects come and go by orders alone."""
    stage = next((a.attribute for a in scene.actions.values() if a.skill == "operate"), "")
    before: dict[str, Any] | None = None
    worked: set[str] = set()
    excused: set[str] = set()
    ordered: set[str] = {e.id for e in scene.entities if scene.kinds[e.kind].role == "object"}
    cancelled: set[str] = set()
    for event in _world_events(recording):
        data = event.data
        if event.kind == "step_started":
            worked |= _worked(scene, data)
        elif event.kind == "fault_injected":
            target = str(data.get("target"))
            excused.add(target)
            ordered |= {target} if data.get("kind") == "bring" else set()
            cancelled |= {target} if data.get("kind") == "take" else set()
        elif event.kind == "order":
            ordered |= {f"{data.get('team')}.{name}" for name in _list(data.get("added"))}
            cancelled |= {f"{data.get('team')}.{name}" for name in _list(data.get("cancelled"))}
        elif event.kind == "membership":
            now = {i: v.get(stage) for i, v in _mapping(data.get("objects")).items() if isinstance(v, Mapping)}
            step = data.get("step")
            expected = before if before is not None else dict.fromkeys(ordered)
            for thing in sorted(expected.keys() - now.keys() - cancelled):
                yield f"step {step}: object {thing} vanished without having been cancelled"
            for thing in sorted(now.keys() - ordered):
                yield f"step {step}: object {thing} appeared without having been ordered"
            if before is not None:
                for thing in sorted(now.keys() & before.keys() - excused):
                    yield from _change(step, thing, before[thing], now[thing], thing in worked)
            before, worked, excused = now, set(), set()


def _change(step: object, thing: str, was: object, now: object, worked: bool) -> Iterator[str]:
    if was == now:
        return
    if not isinstance(was, int) or not isinstance(now, int):
        yield f"step {step}: the stage of {thing} went from {was!r} to {now!r}"
    elif now < was:
        yield f"step {step}: work on {thing} was lost, its stage fell from {was} to {now}"
    elif now > was + 1:
        yield f"step {step}: work on {thing} was done twice, its stage rose from {was} to {now}"
    elif not worked:
        yield f"step {step}: the stage of {thing} rose from {was} to {now}, but nobody was to work on it"


def _worked(scene: Scene, data: Mapping[str, object]) -> set[str]:
    """The objects that a step's actions work on."""
    out = set()
    for action in _list(data.get("actions")):
        name, _, rest = str(action).partition("(")
        known = scene.actions.get(name)
        if known is not None and known.skill == "operate":
            arguments = [part.strip() for part in rest.rstrip(")").split(",")]
            roles = dict(zip(known.args, arguments, strict=False))
            out.add(f"{data.get('team')}.{roles.get('object')}")
    return out


def commands(recording: Recording) -> Iterator[str]:
    """No command takes effect twice, no step of a team is carried out by two commands.

    A step that was under way when the world died may begin again in the world's next life: it had not taken effect.
    """
    begun: Counter[tuple[str, int]] = Counter()
    ended: Counter[str] = Counter()
    of_step: dict[tuple[str, object], set[str]] = defaultdict(set)
    teams: dict[str, str] = {}
    for envelope in _world_history(recording):
        event = envelope.body
        if not isinstance(event, Event) or event.kind not in ("step_started", "step_ended"):
            continue
        command, team, step = str(event.data.get("command")), str(event.data.get("team")), event.data.get("step")
        teams[command] = f"command {command} of {team} (step {step})"
        if event.kind == "step_started":
            begun[command, envelope.inc] += 1
            if ended[command]:
                yield f"{teams[command]} was begun again after it had ended"
        else:
            ended[command] += 1
            of_step[team, step].add(command)
            if not begun[command, envelope.inc]:
                yield f"{teams[command]} ended without having begun"
    for (command, _), number in begun.items():
        if number > 1:
            yield f"{teams[command]} was begun {count(number, 'time')}"
    for command, number in ended.items():
        if number > 1:
            yield f"{teams[command]} took effect {count(number, 'time')}"
    for (team, step), several in of_step.items():
        if len(several) > 1:
            named = ", ".join(sorted(several))
            yield f"step {step} of {team} was carried out {count(len(several), 'time')}, by the commands {named}"


def counts(recording: Recording) -> Iterator[str]:
    """Sent, received and recorded events agree, by the recorder's summary, by our own count, and by signs of life."""
    in_file: dict[tuple[str, int], set[int]] = defaultdict(set)
    for envelope in recording.events:
        in_file[envelope.src, envelope.inc].add(envelope.seq)
    for (source, life), numbers in sorted(in_file.items()):
        gaps = sorted(set(range(1, max(numbers) + 1)) - numbers)
        if gaps:
            yield f"{source} (life {life}): {count(len(gaps), 'event')} missing, the first is number {gaps[0]}"
    claimed: Counter[tuple[str, int]] = Counter()
    for envelope in recording.beats:
        if isinstance(envelope.body, Beat):
            key = (envelope.src, envelope.inc)
            claimed[key] = max(claimed[key], envelope.body.events)
    for key, number in sorted(claimed.items()):
        if number > max(in_file.get(key, {0})):
            yield f"{key[0]} (life {key[1]}): emitted {count(number, 'event')}, recorded {len(in_file.get(key, ()))}"
    if recording.summary is None:
        yield "the recording has no summary: it was cut off"
        return
    for said in recording.summary.sources:
        who = f"{said.source} (life {said.incarnation})"
        numbers = in_file.get((said.source, said.incarnation), set())
        if said.recorded != len(numbers):
            yield f"{who}: events recorded: {said.recorded}, in the file: {len(numbers)}"
        if said.sent >= 0 and said.sent != len(numbers):
            yield f"{who}: events sent: {said.sent}, in the file: {len(numbers)}"
        if said.received < said.recorded:
            yield f"{who}: events recorded: {said.recorded}, received only: {said.received}"


def _world_history(recording: Recording) -> list[Envelope]:
    """The events of the world as it lived them: life by life, in the order of their numbers."""
    return sorted((e for e in recording.events if e.src == WORLD), key=lambda e: (e.inc, e.seq))


def _world_events(recording: Recording) -> list[Event]:
    return [e.body for e in _world_history(recording) if isinstance(e.body, Event)]


def _world(recording: Recording, kind: str) -> list[dict[str, object]]:
    return [event.data for event in _world_events(recording) if event.kind == kind]


def _list(value: object) -> list[object]:
    return list(value) if isinstance(value, list | tuple) else []


def _mapping(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _pairs(value: object) -> dict[str, tuple[str, str]]:
    pairs = _mapping(value).items()
    return {k: (str(v[0]), str(v[1])) for k, v in pairs if isinstance(v, list | tuple) and len(v) == 2}
