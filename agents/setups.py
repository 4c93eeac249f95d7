"""The files that agents are given at their start: all that they are told beforehand."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TypeVar

import msgspec

from bus.messages import Exchange, Steps, Value
from bus.node import NodeConfig
from reasoning.loans import Market


class GivenPlan(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A plan to execute first; muster takes over where reality leaves it."""

    teams: dict[str, Steps]
    exchanges: tuple[Exchange, ...] = ()


class CoordinatorSetup(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``coordinator.json``: the teams' names. `delay` is the transport of a lent robot, in steps. Where sharing is
    general, `delays` are those from team to team, and `robots` says how many of each kind a team takes at most. Unless
    `conducted`, the teams act for themselves."""

    teams: tuple[str, ...]
    delay: int
    plan: GivenPlan | None = None
    conducted: bool = True
    delays: tuple[tuple[str, str, int], ...] = ()
    robots: dict[str, int] = {}

    def market(self) -> Market | None:
        """How robots come from team to team; None under the published limits."""
        if not self.robots:
            return None
        return Market({(giver, taker): n for giver, taker, n in self.delays}, most=self.robots, back=self.delay)


class TeamSetup(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``T1.json``: domain, own name and constants. `conflicts` bounds the search for one answer (None: no bound).
    `guests` are the robots of each kind that it may borrow at most where sharing is general."""

    domain: str
    team: str
    static: dict[str, Value]
    conflicts: int | None = None
    guests: dict[str, int] = {}


S = TypeVar("S", CoordinatorSetup, TeamSetup)


def read(config: NodeConfig, kind: type[S]) -> S:
    """The set-up that the command line names.

    Raises SystemExit 2 when it names none, OSError and msgspec.ValidationError when the file cannot be used.
    """
    if config.setup is None:
        print(f"{config.name}: --setup FILE is needed: {kind.__doc__}", file=sys.stderr)
        raise SystemExit(2)
    return msgspec.json.decode(Path(config.setup).read_bytes(), type=kind)
