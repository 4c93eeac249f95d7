"""What a team plans from, with names for the robots that it may borrow."""

from __future__ import annotations

from collections.abc import Mapping

from agents.course import fresh_name, known_names
from agents.memory import Course, Memory
from reasoning.domain import Domain
from reasoning.guests import guests
from reasoning.values import Problem, State, Value


def problem(
    domain: Domain, static: Mapping[str, Value], numbers: Mapping[str, int], memory: Memory, state: State
) -> Problem:
    """From `state` to the goal. `numbers` are the robots of each kind that the team may borrow at most where sharing is
    general; empty where it is not."""
    if numbers:
        return Problem(domain.name, static, state, guests=guests(domain, known_names(memory), numbers))
    return Problem(domain.name, static, state, fresh_name(domain, memory))


def following(fresh: Problem, course: Course) -> Problem:
    """The same for who follows a plan: the robots that it takes have their names already."""
    if course.role == "share":
        taken = tuple(sorted((hand.name, hand.kind) for hand in course.took))
        return Problem(fresh.domain, fresh.static, fresh.state, guests=taken or fresh.guests)
    return Problem(fresh.domain, fresh.static, fresh.state, next((hand.name for hand in course.took), ""))
