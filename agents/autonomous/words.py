"""How a domain of rooms writes what a team must read in its states: where bodies are, what robots hold, the time.

The names stand in ``domain.toml``: of fluents under the kinds of bodies, of constants under ``[geometry]``, ``[costs]``
and ``[autonomy]``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import msgspec

from agents.skills import actions_of
from reasoning.domain import Domain, load
from reasoning.geometry import Cell, cell
from reasoning.solver import parse
from reasoning.values import State, Value


class Words(msgspec.Struct, frozen=True):
    """Names of fluents and actions. `place` tells the cell of a body, `pose` where a robot between cells is in
    millimetres, `holds` what a robot is attached to, as the term `grip` of a thing and the number of its end, `end`
    where the second end of a heavy thing is, `kind` what a body is, `clock` the units of time since the run began."""

    place: str
    pose: str
    holds: str
    end: str
    grip: str
    kind: str
    person: str
    clock: str
    room: str
    area: str
    most: str
    go: str
    free: str
    leave: str
    enter: str
    recall: str
    weak: str

    # ------------------------------------------------------------ who and what
    def robots(self, state: State) -> list[str]:
        """The team's robots, guests among them."""
        return sorted(self._named(state, self.holds))

    def things(self, state: State) -> list[str]:
        return sorted(n for n in self._named(state, self.kind) if state[f"{self.kind}({n})"] != self.person)

    def persons(self, state: State) -> list[str]:
        return sorted(n for n in self._named(state, self.kind) if state[f"{self.kind}({n})"] == self.person)

    def heavy(self, state: State) -> list[str]:
        """Things that are known to need two robots."""
        return sorted(self._named(state, self.end))

    def _named(self, state: State, fluent: str) -> Iterator[str]:
        """The bodies that have a fluent of this name."""
        return (key[len(fluent) + 1 : -1] for key in state if key.startswith(f"{fluent}("))

    # ------------------------------------------------------------ where
    def cell(self, state: State, body: str) -> Cell | None:
        """The cell of a body, None where it is not known."""
        value = state.get(f"{self.place}({body})")
        return None if value is None else cell(value)

    def point(self, state: State, robot: str) -> tuple[float, float]:
        """Where a robot is, metres from the room's south-west corner."""
        exact = state.get(f"{self.pose}({robot})")
        if exact is not None:
            x_mm, y_mm = cell(exact)
            return x_mm / 1000, y_mm / 1000
        x, y = cell(state[f"{self.place}({robot})"])
        return x + 0.5, y + 0.5

    def between_cells(self, state: State, robot: str) -> bool:
        return f"{self.pose}({robot})" in state

    def ends(self, state: State, thing: str) -> list[Cell]:
        """The cells in which a thing lies: one, or two of a heavy one."""
        keys = (f"{self.place}({thing})", f"{self.end}({thing})")
        return [cell(state[key]) for key in keys if key in state]

    # ------------------------------------------------------------ holding
    def held(self, state: State, robot: str) -> tuple[str, int] | None:
        """The thing that a robot holds, and the number of its end."""
        match parse(str(state.get(f"{self.holds}({robot})", "none"))):
            case name, (str(thing), int(number)) if name == self.grip:
                return thing, number
        return None

    def holders(self, state: State, thing: str) -> dict[int, str]:
        """By the number of its end, who holds a thing."""
        found = {robot: self.held(state, robot) for robot in self.robots(state)}
        return {end[1]: robot for robot, end in found.items() if end is not None and end[0] == thing}

    def strong(self, state: State, robot: str) -> bool:
        """Can it carry heavy things, together with another one?"""
        return state.get(f"{self.weak}({robot})", 0) != 1

    # ------------------------------------------------------------ time and the house
    def now(self, state: State) -> int:
        return int(state.get(self.clock, 0))

    def here(self, state: State) -> str:
        """The room's name."""
        return str(state.get(self.room, ""))

    def deadline(self, static: Mapping[str, Value], state: State) -> int:
        """In units since the run began; 0 if there is none."""
        return int(static.get(self.deadline_key(state), 0))

    def deadline_key(self, state: State) -> str:
        """The constant that says it."""
        return f"{self.most}({self.here(state)},{self.clock})"

    def doors(self, static: Mapping[str, Value], state: State) -> dict[str, list[Cell]]:
        """By the name of the room next door, the cells by which robots go there."""
        return self.doors_of(static, self.here(state))

    def doors_of(self, static: Mapping[str, Value], room: str) -> dict[str, list[Cell]]:
        """The same of any room of the house."""
        found = {}
        for key, value in static.items():
            match parse(key):
                case name, (here, there) if name == self.area and here == room and there != here:
                    west, east, south, north = (int(v) for v in parse(str(value))[1])
                    found[str(there)] = [(x, y) for x in range(west, east + 1) for y in range(south, north + 1)]
        return found


def words(domain: str | Domain) -> Words:
    """The words of a domain whose teams act for themselves."""
    known = load(domain)
    data = known.data
    robot = next(kind for kind in data.kinds.values() if kind["role"] == "robot")
    thing = next(kind for kind in data.kinds.values() if kind["role"] == "object")

    def action(skill: str) -> str:
        return actions_of(known, skill)[0]

    return Words(
        place=robot["place"],
        pose=robot["pose"],
        holds=robot["couples"],
        end=thing["end"],
        grip=thing["grip"],
        kind=data.autonomy["kind"],
        person=next(name for name, kind in data.kinds.items() if kind["role"] == "person"),
        clock=data.costs["clock"],
        room=data.geometry["room"],
        area=data.geometry["area"],
        most=data.costs["most"],
        go=action("follow"),
        free=action("release"),
        leave=action("leave"),
        enter=action("enter"),
        recall=action("recall"),
        weak=str(data.actions[action("grasp")].get("weak", "")),
    )
