"""The recorded truth of a house whose teams act for themselves: their steps, and how every room was at any time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, ceil, cos, dist, sin

from bus.keys import WORLD
from bus.messages import BodyFrame, Event, Frame, State
from bus.scene import Entity, Scene
from ops.recording import Recording
from reasoning.geometry import cell

CENTRED_M = 0.02
"""Who is nearer to the middle of its cell is not between two."""
PERSONS = ("bring", "take", "move", "set")


@dataclass(frozen=True)
class Step:
    """A team's step. Times in simulated seconds; `life` is that of the world in which it began, `since_s` when the one
    before it had ended, `failed` what had no effect, `before` and `after` what the team was shown last before it and at
    its end (None: it has not ended), `called` the robots that obeyed nobody, since they were called home."""

    team: str
    number: int
    actions: tuple[str, ...]
    life: int
    begun_s: float
    since_s: float
    before: State
    called: frozenset[str]
    ended_s: float = 0.0
    after: State | None = None
    failed: frozenset[str] = frozenset()


class Truth:
    """`frames` with the life of the world that showed each, and the time at which it did; `told` the world's events in
    its own order, with the same."""

    def __init__(self, recording: Recording, scene: Scene) -> None:
        self.scene = scene
        self.spaces = {space.team: space for space in scene.workspaces}
        self._heavy = {entity.id for entity in scene.entities if entity.end}
        built = Frame(0.0, -1, tuple(map(_built, scene.entities)))
        shown = [(e.inc, e.at_s, e.body) for e in recording.frames if isinstance(e.body, Frame)]
        self.frames = [(1, 0.0, built), *shown]
        told = sorted((e for e in recording.events if e.src == WORLD), key=lambda e: (e.inc, e.seq))
        self.told = [(e.inc, e.at_s, e.body) for e in told if isinstance(e.body, Event)]

    # ------------------------------------------------------------ what was done
    def steps(self) -> list[Step]:
        """In the order in which they began. One that a world took up again after its death began once."""
        steps: dict[str, Step] = {}
        last: dict[str, Step] = {}
        called: set[str] = set()
        for life, at_s, event in self.told:
            data, team, command = event.data, str(event.data.get("team")), str(event.data.get("command"))
            if event.kind == "step_started" and command not in steps:
                actions = tuple(map(str, items(data["actions"])))
                called |= {f"{team}.{robot}" for skill, robot, *_ in map(self.parts, actions) if skill == "recall"}
                before = last.get(team)
                since_s, seen = (before.ended_s, before.after or {}) if before is not None else (0.0, {})
                obeys_not = frozenset(robot for robot in called if not robot.startswith(f"{team}."))
                steps[command] = Step(team, int(str(data["step"])), actions, life, at_s, since_s, seen, obeys_not)
            elif event.kind == "skill_failed":
                for own in [c for c, step in steps.items() if (step.team, step.number) == (team, data["step"])]:
                    steps[own] = replace(steps[own], failed=steps[own].failed | {str(data["action"])})
            elif event.kind == "step_ended" and command in steps and isinstance(data["state"], dict):
                steps[command] = last[team] = replace(steps[command], ended_s=at_s, after=data["state"])
            elif event.kind == "membership" and isinstance(data["robots"], dict):
                called -= {r for r, place in data["robots"].items() if r.partition(".")[0] == items(place)[0]}
        return list(steps.values())

    def parts(self, action: str) -> tuple[str, ...]:
        """The skill that carries out an action, and the action's arguments; two empty texts for what is no action."""
        name, _, rest = action.partition("(")
        known = self.scene.actions.get(name)
        return ("", "") if known is None else (known.skill, *rest.removesuffix(")").split(","))

    def disturbed(self, team: str, from_s: float, to_s: float) -> bool:
        """Did somebody put, take or change something in a team's room in this time?"""
        return any(
            event.kind == "fault_injected" and event.data["kind"] in PERSONS
            and str(event.data["target"]).partition(".")[0] == team
            for _, at_s, event in self.told if from_s <= at_s <= to_s
        )  # fmt: skip

    # ------------------------------------------------------------ how it was
    def before(self, step: Step) -> tuple[float, Frame] | None:
        """The last frame before a step, with its time; None if the end of the step before it was not shown."""
        for life, at_s, frame in reversed(self.frames):
            if life == step.life and at_s <= step.begun_s:
                return (at_s, frame) if at_s >= step.since_s else None
        return None

    def state(self, team: str, frame: Frame, seen: State, called: frozenset[str] = frozenset()) -> dict[str, int | str]:
        """All that is true of a room but for people, in the domain's words. `seen` is what its team was shown, for what
        a room shows besides bodies; the robots that are `called` are left out."""
        space = self.spaces[team]
        state = {fluent: seen.get(fluent, value) for fluent, value in space.fluents.items()}
        state[space.clock] = self.units(frame)
        for body in frame.bodies:
            kind = self.scene.kinds[body.kind]
            if body.place != team or kind.role == "person" or body.id in called:
                continue
            first, *other = self._ends(body)
            state[f"{kind.place}({body.name})"] = _cell(first)
            state |= {f"{kind.end}({body.name})": _cell(end) for end in other}
            state |= {f"{a}({body.name})": body.attributes[a] for a in kind.attributes if a in body.attributes}
            if kind.couples:
                state[f"{kind.couples}({body.name})"] = self._held(body, frame)
        return state

    def units(self, frame: Frame) -> int:
        """Units of time since the run began; one that has begun counts."""
        return ceil(frame.at_s / self.scene.period_s - 1e-6)

    def between(self, team: str, frame: Frame) -> tuple[set[str], bool]:
        """The robots of a room that are between two cells, and whether they or anything that nobody holds are."""
        here = [b for b in frame.bodies if b.place == team and self.scene.kinds[b.kind].role != "person"]
        held = {b.coupled_to for b in here}
        loose = [b for b in here if max(abs(b.x_m % 1 - 0.5), abs(b.y_m % 1 - 0.5)) > CENTRED_M and b.id not in held]
        return {b.name for b in loose if self.scene.kinds[b.kind].role == "robot"}, bool(loose)

    def lying(self, team: str, frame: Frame) -> set[tuple[str, str]]:
        """Where the things of a room are, and who holds what."""
        kinds = self.scene.kinds
        here = [body for body in frame.bodies if body.place == team]
        lying = {(b.id, _cell(end)) for b in here if kinds[b.kind].role == "object" for end in self._ends(b)}
        return lying | {(b.id, b.coupled_to) for b in here if b.coupled_to}

    def _ends(self, body: BodyFrame) -> list[tuple[float, float]]:
        """Where a body is: of what is heavy both ends, a metre apart."""
        at = body.x_m, body.y_m
        other = (body.x_m + cos(body.heading_rad), body.y_m + sin(body.heading_rad))
        return [at, other] if body.id in self._heavy else [at]

    def _held(self, robot: BodyFrame, frame: Frame) -> str:
        """What a robot is attached to, as a term."""
        thing = next((body for body in frame.bodies if body.id == robot.coupled_to), None)
        if thing is None:
            return "none"
        far_m = [dist((robot.x_m, robot.y_m), end) for end in self._ends(thing)]
        return f"{self.scene.kinds[thing.kind].grip}({thing.name},{far_m.index(min(far_m)) + 1})"


def items(value: object) -> list[object]:
    return list(value) if isinstance(value, list | tuple) else []


def _built(entity: Entity) -> BodyFrame:
    """A body at the run's beginning."""
    (x, y), (u, v) = cell(entity.place), cell(entity.end or entity.place)
    place, heading_rad = entity.team, atan2(v - y, u - x)
    return BodyFrame(entity.id, entity.name, entity.kind, place, x + 0.5, y + 0.5, heading_rad, entity.attributes)


def _cell(at: tuple[float, float]) -> str:
    return f"({int(at[0])},{int(at[1])})"
