"""What a search has learned about motions, kept outside of it.

A judge, who knows geometry, is asked whether a motion is possible among obstacles. What he says against it is a lesson:
it names only the obstacles that are needed, no step, and kinds of bodies instead of bodies.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import NamedTuple, Protocol

from reasoning.solver import Term

Key = tuple[Term, ...]
"""What tells an obstacle and where it is."""
Bodies = tuple[Term, ...]


class Motion(NamedTuple):
    """One body, or two that carry a thing: their kinds, and their places before and after."""

    kinds: tuple[Hashable, ...]
    starts: tuple[Term, ...]
    goals: tuple[Term, ...]


class Lesson(NamedTuple):
    """While all these obstacles are there, the motion is impossible, or `longer` than so many metres."""

    motion: Motion
    obstacles: frozenset[Key]
    longer: int | None = None


class Judge(Protocol):
    """Who knows geometry. Answers must be the same whatever was asked before."""

    def kind(self, body: Term) -> Hashable:
        """Bodies of one kind are alike to the judge."""

    def lessons(self, motion: Motion, obstacles: frozenset[Key], limits: tuple[int, ...]) -> Iterable[Lesson]:
        """What forbids the motion; or else, for each of the limits that it is longer than, why. Each lesson names only
        obstacles that are needed. Nothing, if nothing is to be said. Lessons about other motions may be added."""


REMEMBERED = 1 << 14
"""So many questions to the judge are remembered; then they are forgotten, and asked again when they come up."""


class Lessons:
    """What a judge has said, kept for all searches about one room."""

    def __init__(self, judge: Judge, limits: tuple[int, ...] = ()) -> None:
        self.judge, self.limits = judge, limits
        self.learned: list[Lesson] = []
        self.asked = 0
        """How many questions the judge has been asked."""
        self._of: dict[Motion, list[int]] = {}
        self._judged: set[tuple[Motion, frozenset[Key]]] = set()

    def about(self, motion: Motion, obstacles: frozenset[Key]) -> list[int]:
        """The numbers of the lessons that hold for this motion among these obstacles."""
        known = self._of.setdefault(motion, [])
        if (motion, obstacles) not in self._judged:
            forbidden = any(self.learned[n].longer is None and self.learned[n].obstacles <= obstacles for n in known)
            if not forbidden:
                self.asked += 1
                for lesson in self.judge.lessons(motion, obstacles, self.limits):
                    same = self._of.setdefault(lesson.motion, [])
                    if all(self.learned[n] != lesson for n in same):
                        same.append(len(self.learned))
                        self.learned.append(lesson)
            if len(self._judged) >= REMEMBERED:
                self._judged.clear()
            self._judged.add((motion, obstacles))
        return [n for n in known if self.learned[n].obstacles <= obstacles]
