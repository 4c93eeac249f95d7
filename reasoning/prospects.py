"""What can be said of a team before any search (``prospects.lp``): hope, bounds, and the robots that it has."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import NamedTuple

from reasoning.domain import load
from reasoning.reading import facts
from reasoning.solver import Atom, models, parse
from reasoning.values import Problem

ENDLESS = 1 << 30


class Prospects(NamedTuple):
    """`hopeless` says why the goal can never be reached, even with guests ("": nothing speaks against it). No plan has
    fewer than `bound` steps in any role, none needs more than `longest`, each for a reason. The shortest plan may well
    have `likely` steps, which is no more than a good place to begin a search. `owns` are the kinds of the team's own
    robots that can be lent without the published limits, by name."""

    hopeless: str
    bound: int
    why_bound: str
    longest: int
    why_longest: str
    likely: int
    owns: Mapping[str, str]

    @property
    def stock(self) -> Mapping[str, int]:
        """So many of them are there, by kind."""
        return Counter(self.owns.values())


def prospects(problem: Problem) -> Prospects:
    """Derived, not searched for."""
    (model,) = models([load(problem.domain).program("prospects")], facts(problem))
    reasons, bounds, longest = [], [(0, "no step is needed at least")], [(ENDLESS, "")]
    owns: dict[str, str] = {}
    likely = 0
    for atom in model.atoms:
        match atom:
            case Atom("hopeless", (text, args)):
                reasons.append(_worded(str(text), str(args)))
            case Atom("longest", (int(steps), text, args)):
                longest.append((steps, _worded(str(text), str(args))))
            case Atom("bound", (int(steps), text, args)):
                bounds.append((steps, f"{steps} steps are needed at least: {_worded(str(text), str(args))}"))
            case Atom("likely", (int(steps),)):
                likely = max(likely, steps)
            case Atom("owns", (robot, kind)):
                owns[str(robot)] = str(kind)
    return Prospects("; ".join(reasons), *max(bounds), *min(longest), max(likely, *max(bounds)[:1]), owns)


def _worded(text: str, args: str) -> str:
    return text.format(*parse(args)[1])
