"""Plans that are spoiled in one rule: what is left out, what is added, and where that is found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from reasoning.checker import Break, Exchange
from reasoning.values import Step


class Spoiled(NamedTuple):
    rule: str
    team: str
    step: int
    remove: tuple[str, ...] = ()
    add: tuple[str, ...] = ()
    found_at: tuple[str, int] | None = None
    exchanges: Sequence[Exchange] | None = None
    also: tuple[str, int, str] | None = None  # one more action that is left out
    fixed: str = ""  # the team's worker whose end effector is
    breaks: Sequence[Break] = ()

    def of(self, steps: Mapping[str, Sequence[Step]]) -> dict[str, list[Step]]:
        """A copy of a right plan, spoiled."""
        plan = {team: list(some) for team, some in steps.items()}
        step = plan[self.team][self.step]
        assert set(self.remove) <= set(step)
        plan[self.team][self.step] = (*(a for a in step if a not in self.remove), *self.add)
        if self.also is not None:
            team, at, action = self.also
            plan[team][at] = tuple(a for a in plan[team][at] if a != action)
        return plan
