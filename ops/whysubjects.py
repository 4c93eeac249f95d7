"""What a question why can be about: a scenario, a plan file, a recorded run, a diagnosis case."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from bus.messages import Event
from bus.scene import Scene
from ops.cases import read_case, shipped_cases
from ops.checking import implied_breaks, repairs
from ops.compile import start
from ops.places import shipped
from ops.plans import read_plan
from ops.recorded import initial, static_beside, story
from ops.recording import Recording
from ops.recording import load as load_recording
from ops.scenario import Scenario
from ops.scenario import load as load_scenario
from ops.tables import InputError
from reasoning.checker import Exchange
from reasoning.diagnoser import BROKEN, broken_in
from reasoning.domain import Domain, domains
from reasoning.domain import load as load_domain
from reasoning.reasons import follow
from reasoning.setup import Refused, compile_setup
from reasoning.solver import parse
from reasoning.values import Case, Problem, State, Step, Value


@dataclass(frozen=True)
class Subject:
    """`states` are the teams' at the start, `guests` the names that borrowed robots would get, `teams` the steps of the
    plan or the run, empty if there is none, `exchanges` who lent to whom. `seen[step][team]` is what a recorded run
    sensed after a step; `odd` are the teams and steps of its discrepancies, `findings` what inspections said after
    each, `broken` teams, robots and the steps after which these were known to be broken."""

    name: str
    domain: Domain
    static: Mapping[str, Value]
    states: Mapping[str, State]
    teams: Mapping[str, tuple[Step, ...]] = field(default_factory=dict)
    exchanges: tuple[Exchange, ...] = ()
    scenario: Scenario | None = None
    seen: Mapping[int, Mapping[str, State]] = field(default_factory=dict)
    odd: tuple[tuple[str, int], ...] = ()
    findings: Mapping[tuple[str, int], Mapping[str, str]] = field(default_factory=dict)
    broken: tuple[tuple[str, str, int], ...] = ()
    case: Case | None = None

    @property
    def guests(self) -> dict[str, str]:
        """What a borrowed robot would be called in each team; none if there is nobody to borrow from."""
        if not self.domain.data.exchanged or len(self.states) < 2:
            return {}
        prefix = re.escape(str(self.domain.data.kinds[self.domain.data.exchanged]["prefix"]))
        named = {team: re.findall(rf"\({prefix}(\d+)\)", " ".join(state)) for team, state in self.states.items()}
        return {team: f"{prefix}{max(map(int, numbers), default=0) + 1}" for team, numbers in named.items()}

    @property
    def makespan(self) -> int:
        return max(map(len, self.teams.values()), default=0)

    def problem(self, team: str) -> Problem:
        """What the team wants to plan from the start."""
        return Problem(self.domain.name, self.static, self.states[team], self.guests.get(team, ""))

    def before(self, team: str, step: int) -> State:
        """The team's state before a step: as it was sensed, or as the plan predicts it."""
        if self.seen:
            seen = self.seen[step - 1][team] if step else self.states[team]
            return {**seen, **{f"{BROKEN}({robot})": 1 for robot in self._broken(team, step)}}
        breaks = implied_breaks(self.domain, self.teams)
        args = (self.domain.name, self.static, self.states, self.teams, self.exchanges, breaks)
        return follow(*args)[team][step]

    def _broken(self, team: str, step: int) -> Iterable[str]:
        """The robots that the team knows to be broken before a step of a recorded run."""
        for who, robot, since in self.broken:
            after = self.teams[team][since + 1 : step]
            repaired = {whole for actions in after for _, whole in repairs(self.domain, actions)}
            if who == team and since < step and robot not in repaired:
                yield robot


def subject_of(what: str, overrides: Sequence[str] = ()) -> Subject:
    """What a user means by a path or ``domain/name``; of several with that name, the scenario, with ``--set`` applied.
    Raises `InputError`."""
    path = Path(what)
    if path.is_dir() or path.suffix == ".mcap":
        return _recorded(path)
    plans = {f"{domain}/{name}": file for domain in domains() for name, file in load_domain(domain).plans.items()}
    if path.suffix == ".json" or (what in plans and what not in shipped()):
        return _planned(path if path.exists() else plans.get(what, path))
    if what in shipped_cases() and what not in shipped():
        case = read_case(what).case
        states = {"the team": case.before}
        return Subject(what, load_domain(case.domain), case.static, states, {"the team": case.actions}, case=case)
    scenario = load_scenario(what, overrides)
    setup = start(scenario)
    return Subject(scenario.name, load_domain(scenario.domain), setup.static, setup.states, scenario=scenario)


def _planned(path: Path) -> Subject:
    file = read_plan(path)
    if not file.domain or file.setup is None:
        raise InputError(f"{path}: the plan does not say from which set-up it starts (key scenario)")
    setup = compile_setup(file.domain, file.setup)
    if isinstance(setup, Refused):
        raise InputError(f"{path}: scenario.setup: {setup.errors[0]}")
    if unknown := sorted(file.teams.keys() - setup.states.keys()):
        raise InputError(f"{path}: teams.{unknown[0]}: there is no such team; there are {', '.join(setup.states)}")
    loans = tuple(Exchange(x.worker, x.from_, x.give_step, x.to, x.take_step, x.as_) for x in file.loans)
    return Subject(path.name, load_domain(file.domain), setup.static, setup.states, file.teams, loans)


def _recorded(path: Path) -> Subject:
    try:
        recording = load_recording(path)
    except FileNotFoundError as error:
        raise InputError(str(error)) from error
    scene, static = recording.scene, static_beside(path)
    if scene is None or static is None:
        raise InputError(f"{path}: expected a recording with its scene, and the files of its teams (T1.json) beside it")
    run = story(recording, scene)
    names = [workspace.team for workspace in scene.workspaces]
    steps = range(max(run.actions, default=-1) + 1)
    teams = {team: tuple(run.actions.get(step, {}).get(team, ()) for step in steps) for team in names}
    first = {team: _start(scene, team) for team in names}
    seen: dict[int, dict[str, State]] = {}
    for step in steps:
        seen[step] = {**seen.get(step - 1, first), **run.states.get(step, {})}
    odd, findings, broken = _surprises(recording)
    domain = load_domain(scene.domain)
    loans = tuple(exchange for _, exchange in run.loans)
    return Subject(path.name, domain, static, first, teams, loans, None, seen, odd, findings, broken)


def _start(scene: Scene, team: str) -> State:
    """What a team knows at the start: with what its room shows besides the bodies, and without people."""
    own = [entity for entity in scene.entities if entity.team == team]
    people = {entity.name for entity in own if scene.kinds[entity.kind].role == "person"}
    ends = {f"{scene.kinds[e.kind].end}({e.name})": e.end for e in own if e.end and e.known}
    shown = next(workspace.fluents for workspace in scene.workspaces if workspace.team == team)
    sensed = {fluent: value for fluent, value in initial(scene, team).items() if people.isdisjoint(parse(fluent)[1])}
    return {**shown, **sensed, **ends}


Findings = dict[tuple[str, int], dict[str, str]]


def _surprises(
    recording: Recording,
) -> tuple[tuple[tuple[str, int], ...], Findings, tuple[tuple[str, str, int], ...]]:
    """`odd`, `findings` and `broken` of `Subject`. Nothing of the world's own story is used: the answer must follow
    from what the team could know."""
    odd: list[tuple[str, int]] = []
    findings: Findings = {}
    broken: list[tuple[str, str, int]] = []
    for envelope in recording.events:
        event = envelope.body
        if not isinstance(event, Event):
            continue
        data, team = event.data, str(event.data.get("team"))
        last = next((one for one in reversed(odd) if one[0] == team), (team, 0))
        if event.kind == "discrepancy":
            odd.append((team, int(str(data["step"]))))
        elif event.kind == "diagnosis" and isinstance(data["causes"], list) and len(data["causes"]) == 1:
            broken += [(team, robot, last[1]) for robot in broken_in(Explained(tuple(data["causes"][0])))]
        elif event.kind == "inspection":
            findings.setdefault(last, {})[str(data["robot"])] = str(data["finding"])
            broken += [(team, str(data["robot"]), last[1])] if data["finding"] == BROKEN else []
    return tuple(odd), findings, tuple(broken)


class Explained(NamedTuple):
    """An explanation that was recorded."""

    causes: tuple[str, ...]
