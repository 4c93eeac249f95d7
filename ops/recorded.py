"""What a recorded run really did, held against the independent checker, step by step of the world. Where teams act for
themselves, see `ops.recorded_rooms`.

The actions that the world carried out are taken from the recording, robots that were made to break from its faults,
and loans from where robots were. A step in which a person put things elsewhere is left out, and checking goes on from
what was sensed after it. Nothing of the agents' plans or predictions is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from bus.messages import Event, State, Value
from bus.scene import Scene
from ops.recorded_rooms import Judged, check_rooms
from ops.recording import Recording
from reasoning.checker import Break, Exchange, examine
from reasoning.domain import Domain, load
from reasoning.prospects import prospects
from reasoning.values import Problem, Violation

PERSONS = ("move", "set", "order", "cancel")
BENCH = "bench"


class _TeamFile(msgspec.Struct):
    static: dict[str, Value]


@dataclass
class Story:
    """The world's story in its own order. `faults` are kept by the step that begins after them. `loans` have the name
    that the robot was built with."""

    actions: dict[int, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    states: dict[int, dict[str, State]] = field(default_factory=dict)
    persons: set[int] = field(default_factory=set)
    broken: list[tuple[str, str, int]] = field(default_factory=list)
    loans: list[tuple[str, Exchange]] = field(default_factory=list)
    kinds: dict[str, str] = field(default_factory=dict)
    goal: bool = False


def static_beside(path: Path) -> dict[str, Value] | None:
    """The domain's constants of a recorded run, from the files that its teams were given; None if there are none."""
    folder = path if path.is_dir() else path.parent
    for file in sorted(folder.glob("*.json")):
        try:
            return msgspec.json.decode(file.read_bytes(), type=_TeamFile).static
        except msgspec.DecodeError:
            continue
    return None


def check_run(recording: Recording, static: Mapping[str, Value]) -> Judged:
    """Every violation of the domain's rules in what was carried out; steps are global, or the teams' own where nobody
    conducts them."""
    scene = recording.scene
    if scene is None:
        return Judged([])
    domain = load(scene.domain)
    judged = _check_together if scene.conducted else check_rooms
    return judged(recording, scene, domain, static)


def _check_together(recording: Recording, scene: Scene, domain: Domain, static: Mapping[str, Value]) -> Judged:
    """Steps that were carried out together."""
    run = story(recording, scene)
    last = max(run.actions, default=-1)
    found: list[Violation] = []
    state = {workspace.team: initial(scene, workspace.team) for workspace in scene.workspaces}
    for team, start in state.items():
        run.kinds |= {f"{team}.{robot}": kind for robot, kind in _owned(domain, static, start).items()}
    first = 0
    for end in [*sorted(run.persons), last + 1]:
        if first < end:
            found += _segment(domain, static, run, state, first, end, over=end > last)
        for step in range(first, min(end, last) + 1):
            state |= run.states.get(step, {})
        first = max(first, end + 1)
    return Judged(found)


def _owned(domain: Domain, static: Mapping[str, Value], start: State) -> Mapping[str, str]:
    """A team's robots and their kinds, where robots change teams."""
    return prospects(Problem(domain.name, static, start)).owns if domain.data.exchanged else {}


def _segment(
    domain: Domain,
    static: Mapping[str, Value],
    run: Story,
    state: Mapping[str, State],
    first: int,
    end: int,
    *,
    over: bool,
) -> Iterator[Violation]:
    """The violations in the steps from `first` to before `end`; the goal counts where the run is over."""
    plan = {team: tuple(run.actions.get(step, {}).get(team, ()) for step in range(first, end)) for team in state}
    breaks, known = _broken(domain, run, plan, first, end)
    states = {team: {**values, **known.get(team, {})} for team, values in state.items()}
    came = [(robot, x) for robot, x in run.loans if first <= x.take_step < end]
    loans = [
        # A team may have its own robot back from the bench, when what it was given for is not so any more.
        x._replace(
            give_step=x.give_step - first, take_step=x.take_step - first, giver=robot if x.giver == x.taker else x.giver
        )
        for robot, x in came
    ]
    kinds: dict[str, dict[str, str]] = {team: {} for team in state}
    for robot, x in came:
        if robot in run.kinds:
            kinds[x.taker][x.known_as] = run.kinds[robot]
    verdict = examine(domain, static, states, plan, exchanges=loans, breaks=breaks, kinds=kinds)
    for violation in verdict.violations:
        if violation.step < end - first or (over and run.goal):
            yield Violation(violation.team, violation.step + first, violation.action, violation.rule, violation.text)


def _broken(
    domain: Domain, run: Story, plan: Mapping[str, tuple[tuple[str, ...], ...]], first: int, end: int
) -> tuple[list[Break], dict[str, dict[str, Value]]]:
    """Robots that break in these steps, unseen, and those that are known to be broken when they begin."""
    breaks: list[Break] = []
    known: dict[str, dict[str, Value]] = {}
    for team, robot, step in run.broken:
        if step >= end or _repaired(domain, run, team, robot, step, first):
            continue
        acts = next((a for actions in plan[team] for a in actions if _concerns(a, robot)), "")
        if step < first and _is_repair(domain, acts):
            known.setdefault(team, {})[f"broken({robot})"] = 1
        else:
            breaks.append(Break(team, robot, max(step - first, 0)))
    return breaks, known


def _repaired(domain: Domain, run: Story, team: str, robot: str, since: int, before: int) -> bool:
    steps = (run.actions.get(step, {}).get(team, ()) for step in range(since, before))
    return any(_is_repair(domain, action) and _concerns(action, robot) for actions in steps for action in actions)


def _is_repair(domain: Domain, action: str) -> bool:
    return domain.data.actions.get(action.partition("(")[0], {}).get("skill") == "repair"


def _concerns(action: str, robot: str) -> bool:
    return robot in action.partition("(")[2].rstrip(")").split(",")


def initial(scene: Scene, team: str) -> State:
    """What a team senses at the start, as the scene says."""
    state: State = {}
    for entity in scene.entities:
        if entity.team == team:
            kind = scene.kinds[entity.kind]
            state[f"{kind.place}({entity.name})"] = entity.place
            if kind.couples:
                state[f"{kind.couples}({entity.name})"] = "none"
            state |= {f"{attribute}({entity.name})": value for attribute, value in entity.attributes.items()}
    return state


def story(recording: Recording, scene: Scene) -> Story:
    """The world's events in the order in which it said them; a step that was begun twice counts as begun again."""
    run = Story()
    told = [(e.inc, e.seq, e.body) for e in recording.events if e.src == "world" and isinstance(e.body, Event)]
    places = {e.id: (e.team, e.name) for e in scene.entities if scene.kinds[e.kind].role == "robot"}
    given: dict[str, tuple[str, str, int]] = {}
    waiting: list[Event] = []
    under_way = -1
    for _, _, event in sorted(told, key=lambda item: item[:2]):
        data = event.data
        if event.kind == "fault_injected":
            if under_way < 0:
                waiting.append(event)
            else:
                _note_fault(run, event, under_way, places)
        elif event.kind == "step_started":
            step, team = int(str(data["step"])), str(data["team"])
            for fault in waiting:
                _note_fault(run, fault, step, places)
            waiting, under_way = [], step
            run.actions.setdefault(step, {})[team] = tuple(map(str, _items(data["actions"])))
        elif event.kind == "step_ended":
            state = data["state"]
            if isinstance(state, dict):
                run.states.setdefault(int(str(data["step"])), {})[str(data["team"])] = state
        elif event.kind == "membership" and isinstance(data["robots"], dict):
            step, under_way = int(str(data["step"])), -1
            for robot, entry in data["robots"].items():
                place, name = map(str, _items(entry))
                was, known_as = places.get(robot, (place, name))
                if place == BENCH and was != BENCH:
                    given[robot] = (was, known_as, step)
                elif was == BENCH and place != BENCH and robot in given:
                    giver, worker, give_step = given.pop(robot)
                    run.loans.append((robot, Exchange(worker, giver, give_step, place, step, name)))
                places[robot] = (place, name)
    run.goal = any(
        isinstance(e.body, Event) and e.body.kind == "run_over" and e.body.data.get("goal") is True
        for e in recording.events
    )
    return run


def _note_fault(run: Story, fault: Event, step: int, places: Mapping[str, tuple[str, str]]) -> None:
    kind, target = str(fault.data["kind"]), str(fault.data["target"])
    if kind in PERSONS:
        run.persons.add(step)
    elif kind == "break":
        team, _, name = target.partition(".")
        place, known_as = (team, name) if (team, name) in places.values() else places.get(target, (team, name))
        run.broken.append((place, known_as, step))


def _items(value: object) -> list[object]:
    return list(value) if isinstance(value, list | tuple) else []
