"""From a scenario to what each process is told: ``world.json``, ``coordinator.json``, ``T1.json`` ...

The world gets the truth, faults included. The coordinator gets the teams' names, the transport's delay and perhaps a
plan to begin with. A team gets its name and its domain's constants: where it stands it learns by observing.
The agents define what their files look like (`agents.coordinator`, `agents.team`); a test reads these files with them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from bus.scene import Action, Entity, Fault, Kind, Scene, Transport, Workspace
from ops import rooms, shares
from ops.faultwords import Names, problem
from ops.places import made
from ops.plans import GivenPlan
from ops.scenario import Scenario
from ops.tables import InputError
from reasoning.domain import Domain, load
from reasoning.setup import Refused, Setup, compile_setup


@dataclass(frozen=True)
class Compiled:
    """Everything that the processes of a run are told, by process name."""

    scenario: Scenario
    setup: Setup
    files: Mapping[str, msgspec.Struct | dict[str, Any]]

    @property
    def teams(self) -> tuple[str, ...]:
        return self.scenario.teams

    def write(self, folder: Path) -> None:
        """Write NAME.json for each process that needs one. Raises `InputError` if the folder cannot be written into."""
        made(folder)
        for name, content in self.files.items():
            (folder / f"{name}.json").write_bytes(msgspec.json.format(msgspec.json.encode(content), indent=1) + b"\n")


def compile_scenario(scenario: Scenario, plan: GivenPlan | None = None) -> Compiled:
    """What the processes are told. Raises `InputError` for a set-up or a fault that the domain does not allow, and for
    a domain that can only be planned."""
    setup = start(scenario)
    domain = load(scenario.domain)
    if not domain.can_run:
        raise InputError(
            f"{scenario.path}: scenarios of the domain {domain.name} cannot be run yet: the world does not know its "
            "skills. There are muster plan and muster check for them"
        )
    scene = _scene(scenario, domain, setup)
    _check_faults(scenario, scene)
    limit = scenario.limits.conflicts or None
    files: dict[str, dict[str, Any]] = {
        "coordinator": {
            "teams": scenario.teams,
            "delay": setup.static.get(shares.DELAY, 0),
            "plan": plan,
            "conducted": domain.data.conducted,
        },
    }
    for team in scenario.teams:
        files[team] = {"domain": scenario.domain, "team": team, "static": dict(setup.static), "conflicts": limit}
    if shares.general(setup) and len(scenario.teams) > 1:
        robots = shares.most(domain, setup)
        delays = [(giver, taker, steps) for (giver, taker), steps in shares.delays(setup).items()]
        files["coordinator"] |= {"delays": delays, "robots": robots}
        for team in scenario.teams:
            files[team] |= {"guests": robots}
    return Compiled(scenario, setup, {"world": scene, **files})


def start(scenario: Scenario) -> Setup:
    """The validated set-up. Raises `InputError` with the place of the first thing that is wrong, and the others."""
    setup = compile_setup(scenario.domain, scenario.setup)
    if isinstance(setup, Refused):
        first, *others = setup.errors
        more = "".join(f"\n  {wrong}" for wrong in others)
        expected = f"expected {first.expected}" + (f", found {first.found}" if first.found else "")
        raise scenario.complaint(re.findall(r"[^.\[\]]+", first.key), expected + more)
    return setup


def _scene(scenario: Scenario, domain: Domain, setup: Setup) -> Scene:
    data = domain.data
    kinds = {name: msgspec.convert(table | rooms.size(domain, setup, name), Kind) for name, table in data.kinds.items()}
    display: dict[str, Any] = data.display
    words = {str(a): {str(v): str(w) for v, w in values.items()} for a, values in display.get("values", {}).items()}
    places = {str(place): str(word) for place, word in display.get("places", {}).items()}
    return Scene(
        domain=scenario.domain,
        seed=scenario.seed,
        period_s=data.time["period_s"],
        dt_s=data.time["dt_s"],
        frame_hz=scenario.record.frame_hz,
        transport_delay_steps=int(setup.static.get(shares.DELAY, 0)),
        kinds=kinds,
        actions={name: msgspec.convert(table, Action) for name, table in data.actions.items()},
        workspaces=tuple(
            msgspec.convert({"team": team, **floor, **rooms.walls(domain, setup, team)}, Workspace)
            for team, floor in setup.workspaces.items()
        ),
        entities=tuple(_entity(team, name, kind, kinds[kind], setup, data.time) for team, name, kind in setup.entities),
        faults=scenario.faults,
        transports=_transports(setup),
        conducted=data.conducted,
        title=scenario.story,
        display={**words, "places": places} if places else words,
    )


def _transports(setup: Setup) -> tuple[Transport, ...]:
    """Those that take other than the usual steps."""
    usual = setup.static.get(shares.DELAY, 0)
    delays = shares.delays(setup) if usual else {}
    return tuple(Transport(*pair, steps) for pair, steps in delays.items() if steps != usual)


def _entity(team: str, name: str, kind: str, known: Kind, setup: Setup, time: Mapping[str, float]) -> Entity:
    """A body's start is what its team's sensed state says of it, and what is hidden from the team."""
    state = {**setup.states[team], **setup.hidden[team]}
    sensed = (*known.attributes, *filter(None, [known.couples]))
    return Entity(
        id=f"{team}.{name}",
        team=team,
        name=name,
        kind=kind,
        place=state[f"{known.place}({name})"],
        attributes={attribute: state[f"{attribute}({name})"] for attribute in sensed},
        end=str(state.get(f"{known.end}({name})", "")) if known.end else "",
        known=f"{known.end}({name})" not in setup.hidden[team],
        stops=rooms.stops(state, name, time["period_s"]),
        again_s=int(state.get(f"{rooms.AGAIN}({name})", 0)) * time["period_s"],
    )


def names(scene: Scene) -> Names:
    """What a disturbance of this scene can be aimed at."""
    robots, objects, persons = (
        tuple(entity.id for entity in scene.entities if scene.kinds[entity.kind].role == role)
        for role in ("robot", "object", "person")
    )
    return Names(
        teams=tuple(workspace.team for workspace in scene.workspaces),
        robots=robots,
        objects=objects,
        persons=persons,
        processes=("world", "coordinator", *(workspace.team for workspace in scene.workspaces)),
    )


def _check_faults(scenario: Scenario, scene: Scene) -> None:
    """Now that the bodies are known: does every fault have a target that exists and an attribute that is sensed?"""
    known = names(scene)
    growing = {fault.target for fault in scenario.faults if fault.kind == "order"}
    brought = {fault.target for fault in scenario.faults if fault.kind == "bring"}
    on_lines = {entity.id for entity in scene.entities if scene.kinds[entity.kind].track == "line"}
    for number, fault in enumerate(scenario.faults):
        team = fault.target.partition(".")[0]
        if team in growing and fault.target not in (*known.robots, *known.objects) and fault.kind in ("move", "set"):
            continue  # it may name an object that is yet to come
        if fault.target in brought and fault.kind in ("move", "take"):
            continue
        at = ["fault", str(number)]
        if wrong := problem(fault.kind, fault.target, fault.args, known):
            raise scenario.complaint([*at, wrong[0]], wrong[1])
        if fault.kind in ("stop", "deadline") and scene.conducted:
            raise scenario.complaint([*at, "kind"], f"{fault.kind} is for teams that act for themselves")
        if fault.kind == "move" and (("to" in fault.args) != (fault.target in on_lines)):
            raise scenario.complaint(
                [*at, "target"], "what is on a line is moved to a line position to; all else to a cell x, y"
            )
        if fault.kind in ("move", "bring") and (wrong := _off_floor(fault, scene)):
            raise scenario.complaint([*at, wrong[0]], wrong[1])
        if fault.kind == "set":
            kind = next(entity.kind for entity in scene.entities if entity.id == fault.target)
            if fault.args["attribute"] not in scene.kinds[kind].attributes:
                listed = ", ".join(scene.kinds[kind].attributes)
                raise scenario.complaint([*at, "attribute"], f"expected a sensed attribute of a {kind}: {listed}")


def _off_floor(fault: Fault, scene: Scene) -> tuple[str, str] | None:
    """Which argument of a move leads out of the team's workspace, and what was expected."""
    team = fault.target.partition(".")[0]
    space = next(workspace for workspace in scene.workspaces if workspace.team == team)
    first = 0 if space.room else 1
    lowest_and_highest = {
        "x": (first, space.width - 1 + first),
        "y": (first, space.height - 1 + first),
        "to": (0, None),
    }
    for key, (lowest, highest) in lowest_and_highest.items():
        number = fault.args.get(key, lowest)
        if isinstance(number, int) and (number < lowest or (highest is not None and number > highest)):
            limit = f"{lowest} to {highest}" if highest is not None else f"{lowest} or more"
            return key, f"expected a place in the workspace of {team}, {limit}; found {number}"
    return None
