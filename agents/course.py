"""Following a plan, as pure functions from a team's memory to what comes next."""

from __future__ import annotations

from collections.abc import Mapping

from msgspec.structs import replace

from agents.memory import Course, Memory
from agents.skills import guest_prefix, skill
from bus.messages import Executed, Handover, Offer, Question, SkillCall, State, Step, StepResult
from reasoning.domain import Domain
from reasoning.monitor import differing
from reasoning.solver import parse


def actions(memory: Memory, step: int) -> tuple[str, ...] | None:
    """The plan's actions in global step `step`; None when there is no plan, or it is over or has not begun."""
    course = memory.course
    if course is None or not course.start <= step < course.start + course.makespan:
        return None
    return course.steps[step - course.start]


def calls(domain: Domain, memory: Memory, step: int) -> tuple[SkillCall, ...]:
    """The plan's actions in global step `step` as the world is asked to carry them out."""
    course = memory.course
    details = {} if course is None else course.details.get(step - course.start, {})
    made = []
    for action in actions(memory, step) or ():
        name, args = parse(action)
        detail = dict(details.get(action, {}))
        if skill(domain, name) == "arrive" and course is not None:
            detail["robot"] = course.robot
        made.append(SkillCall(name, args, detail))
    return tuple(made)


def surprises(memory: Memory, observed: State) -> tuple[str, ...]:
    """Fluents in which the sensed state differs from the one that the plan predicts after the step begun."""
    course, begun = memory.course, memory.begun
    if course is None or begun is None or begun.recover:
        return ()
    return differing(course.states[begun.step - course.start + 1], observed)


def completed(domain: Domain, team: str, memory: Memory, executed: Executed) -> Memory:
    """Memory after a step: exchanges noted as the sensors show them, repaired robots taken to be whole again."""
    course = memory.course
    gave, took, guests, broken = list(memory.gave), list(memory.took), dict(memory.guests), set(memory.broken)
    for action in memory.begun.actions if memory.begun else ():
        name, args = parse(action)
        kind, robot = skill(domain, name), str(args[0]) if args else ""
        here = any(robot in map(str, parse(fluent)[1][:1]) for fluent in executed.state)
        if kind == "depart" and not here:
            gave.append(Handover(guests.pop(robot, f"{team}.{robot}"), executed.step))
        elif kind == "arrive" and here and course is not None:
            guests[robot] = course.robot
            took.append(Handover(course.robot, executed.step))
        elif kind == "repair":
            broken.discard(robot)
    return replace(
        advanced(memory, executed), gave=tuple(gave), took=tuple(took), guests=guests, broken=tuple(sorted(broken))
    )


def advanced(memory: Memory, executed: Executed) -> Memory:
    """Memory after any step: the clock, the sensed state and the history move on."""
    done = memory.begun.actions if memory.begun else ()
    return replace(memory, step=executed.step + 1, observed=executed.state, begun=None, history=(*memory.history, done))


def beliefs(memory: Memory) -> State:
    """The sensed state and, besides, which robots are known to be broken: what planning and diagnosis start from."""
    return {**memory.observed, **{f"broken({robot})": 1 for robot in memory.broken}}


def offer(memory: Memory) -> Offer | None:
    """The rest of a plan that is on course, as the answer to a question about now, with what its proof refuted.

    A question refuted where the plan began is refuted, shortened by the steps gone, wherever the plan has led since: a
    faster way on from here would have been a faster way from there. An exchange that has happened turns questions
    about that role into questions about finishing alone.
    """
    course = memory.course
    if course is None or not memory.on_course:
        return None
    gone = memory.step - course.start
    left = max(course.makespan - gone, 0)
    if gone <= course.at:
        return Offer(Question(course.role, left, course.at - gone), _shortened(course, gone))
    return Offer(Question("alone", left), _shortened(course, gone))


def rest(course: Course, gone: int) -> Course:
    """What remains of a plan after `gone` of its steps, as a plan of its own that starts now."""
    return Course(
        course.start + gone,
        course.steps[gone:],
        course.states[gone:],
        {step - gone: detail for step, detail in course.details.items() if step >= gone},
        course.role if gone <= course.at else "alone",
        course.worker if gone <= course.at else "",
        course.at - gone if gone <= course.at else -1,
        course.robot if gone <= course.at else "",
        _shortened(course, gone),
    )


def _shortened(course: Course, gone: int) -> tuple[Question, ...]:
    exchanged = 0 <= course.at < gone
    kept = []
    for q in course.refuted:
        if q.within < gone:
            continue
        if not exchanged and (q.kind != "lend" or q.step >= gone):
            kept.append(Question(q.kind, q.within - gone, max(q.step - gone, 0)))
        elif exchanged and q.kind == course.role and _covers(q, course.at):
            kept.append(Question("alone", q.within - gone))
    return tuple(dict.fromkeys(kept))


def waited(course: Course, gone: int, steps: int | None) -> tuple[Question, ...]:
    """What is still refuted when, after `gone` steps of the plan, other steps passed without an action and something
    changed by itself: the time that they took was given for nothing. None: nothing is known any more."""
    if steps is None:
        return ()
    exchanged = 0 <= course.at < gone  # then the steps of questions are about the past
    return tuple(
        Question(q.kind, q.within - steps, q.step if exchanged else max(q.step - steps, 0))
        for q in course.refuted
        if q.within >= steps and (exchanged or q.kind != "lend" or q.step >= steps)
    )


def _covers(refuted: Question, at: int) -> bool:
    """Was the exchange that took place in step `at` one of those that the question asked about?"""
    return at <= refuted.step if refuted.kind == "lend" else at >= refuted.step


def fresh_name(domain: Domain, memory: Memory) -> str:
    """A name for a guest that no robot of the team has: the prefix of the kind that is exchanged, next number."""
    prefix = guest_prefix(domain)
    numbers = [
        int(arg[len(prefix) :])
        for fluent in (*memory.observed, *(f"at({w})" for w in memory.guests))
        for arg in map(str, parse(fluent)[1])
        if arg.startswith(prefix) and arg[len(prefix) :].isdigit()
    ]
    return f"{prefix}{max(numbers, default=0) + 1}"


def results_again(memory: Memory, step: Step) -> StepResult | None:
    """The report of a step that is already done, for a coordinator that asks again."""
    return memory.last if memory.last is not None and memory.last.step == step else None


def to_details(
    details: Mapping[tuple[int, str], Mapping[str, int | str]],
) -> dict[int, dict[str, dict[str, int | str]]]:
    """Details of a plan in the form that a journal keeps."""
    kept: dict[int, dict[str, dict[str, int | str]]] = {}
    for (step, action), detail in details.items():
        kept.setdefault(step, {})[action] = dict(detail)
    return kept
