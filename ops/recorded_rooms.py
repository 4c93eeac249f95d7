"""What teams that act for themselves really did in their rooms, held against the independent checker, step by step.

Every team has steps of its own. Each is judged by itself, from the truth that was shown right before it: who was in the
room, guests among them, where everything lay, what was held. So nothing has to be known of what people did in between,
nor of how robots came and left. What had no effect is no violation. The goal is judged once, at the end, if the run
says that it was reached. What cannot be judged is counted, with the reason.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from bus.messages import Event, Frame, Value
from bus.scene import Scene
from ops.recorded_truth import Step, Truth
from ops.recording import Recording
from reasoning.checker import examine
from reasoning.domain import Domain
from reasoning.values import Violation

DOORS = ("leave", "enter", "recall")
"""Skills that take a robot from room to room."""
AT_DOORS = "actions that lead from room to room, since the rules are about one room at a time"
BETWEEN = "ways past or from what is between two cells, since the rules know cells only"
DISTURBED = "what looks wrong, since somebody changed the room at that time"
UNSEEN = "actions in steps whose beginning was not recorded"
UNFINISHED = "actions that were under way when the recording ended"
LATE = "conditions on the last steps of a plan, since each step is judged by itself"


@dataclass(frozen=True)
class Judged:
    """`unjudged` says what could not be judged, and how much of it."""

    violations: list[Violation]
    unjudged: Mapping[str, int] = field(default_factory=dict)


def check_rooms(recording: Recording, scene: Scene, domain: Domain, static: Mapping[str, Value]) -> Judged:
    """Every violation of the domain's rules in what was carried out; steps are the teams' own."""
    truth, unjudged = Truth(recording, scene), Counter[str]()
    steps = truth.steps()
    found = [violation for step in steps for violation in _judged(truth, domain, static, step, unjudged)]
    last = {step.team: step for step in steps}
    for envelope in recording.events:
        if isinstance(envelope.body, Event) and envelope.body.kind == "run_over" and envelope.body.data.get("goal"):
            for team in truth.spaces:
                missed = [*_missed(truth, domain, static, team, last.get(team), envelope.at_s)]
                since_s = last[team].ended_s if team in last else 0.0
                if missed and truth.disturbed(team, since_s, envelope.at_s):
                    unjudged[DISTURBED] += len(missed)
                else:
                    found += missed
    unjudged[LATE] += sum(key.startswith(f"{domain.data.autonomy['late']}(") for key in static)
    return Judged(found, +unjudged)


def _judged(
    truth: Truth, domain: Domain, static: Mapping[str, Value], step: Step, unjudged: Counter[str]
) -> Iterator[Violation]:
    """The violations of a step."""
    doors = {action for action in step.actions if truth.parts(action)[0] in DOORS}
    done = {*step.actions} - doors - step.failed
    unjudged[AT_DOORS] += len(doors - step.failed)
    shown = truth.before(step)
    if step.after is None:
        unjudged[UNFINISHED] += len(done)
    elif shown is None:
        unjudged[UNSEEN] += len(done)
    elif done:
        at_s, frame = shown
        wrong = [violation for violation in _wrong(truth, domain, static, step, frame) if violation.action in done]
        robots, loose = truth.between(step.team, frame)
        ways = {action for action in done if truth.parts(action)[0] == "follow"}
        vague = {action for action in ways if truth.parts(action)[1] in robots}
        vague |= {violation.action for violation in wrong if loose} & ways
        unjudged[BETWEEN] += len(vague)
        wrong = [violation for violation in wrong if violation.action not in vague]
        if wrong and truth.disturbed(step.team, at_s, step.ended_s):
            unjudged[DISTURBED] += len({violation.action for violation in wrong})
        else:
            yield from wrong


def _wrong(truth: Truth, domain: Domain, static: Mapping[str, Value], step: Step, frame: Frame) -> Iterator[Violation]:
    """What the checker says of a step. What failed was to be done as well: others may have counted on it."""
    team, state = step.team, truth.state(step.team, frame, step.before, step.called)
    actions = tuple(action for action in step.actions if truth.parts(action)[0] not in DOORS)
    details = {(0, action): _gripped(truth, step, action) for action in actions}
    verdict = examine(domain, static, {team: state}, {team: [actions]}, details={team: details})
    yield from (replace(v, step=step.number) for v in verdict.violations if v.step == 0)


def _gripped(truth: Truth, step: Step, action: str) -> dict[str, Value]:
    """Which end of which thing a robot had taken by the end of the step, as the action's detail."""
    skill, robot, *_ = truth.parts(action)
    couples = next(kind.couples for kind in truth.scene.kinds.values() if kind.role == "robot")
    held = (step.after or {}).get(f"{couples}({robot})", "none")
    return {truth.scene.actions[action.partition("(")[0]].point: held} if skill == "grasp" and held != "none" else {}


def _missed(
    truth: Truth, domain: Domain, static: Mapping[str, Value], team: str, last: Step | None, over_s: float
) -> Iterator[Violation]:
    """What the checker misses in a room when the run is over. The time that counts is that of the last change of what
    lies there or is held: a team that is done may help others."""
    frames = [frame for _, at_s, frame in truth.frames if at_s <= over_s]
    tidy = truth.lying(team, frames[-1])
    since = frames[-1]
    for frame in reversed(frames):
        if truth.lying(team, frame) != tidy:
            break
        since = frame
    state = truth.state(team, frames[-1], last.after or {} if last is not None else {})
    state[truth.spaces[team].clock] = truth.units(since)
    verdict = examine(domain, _with_deadline(truth, domain, static, team, over_s), {team: state}, {team: []})
    yield from (replace(v, step=last.number + 1 if last is not None else 0) for v in verdict.violations)


def _with_deadline(
    truth: Truth, domain: Domain, static: Mapping[str, Value], team: str, over_s: float
) -> dict[str, Value]:
    """The constants, with a team's deadline as it was when the run was over."""
    space, now = truth.spaces[team], dict(static)
    key = f"{domain.data.costs['most']}({space.room},{space.clock})"
    for _, at_s, event in truth.told:
        if at_s <= over_s and event.kind == "order" and event.data["team"] == team and "deadline" in event.data:
            units = int(str(event.data["deadline"]))
            now = {**{name: value for name, value in now.items() if name != key}, **({key: units} if units else {})}
    return now
