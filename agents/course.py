"""Following a plan, as pure functions from a team's memory to what comes next."""

from __future__ import annotations

from collections.abc import Mapping

from msgspec.structs import replace

from agents.carrying import shortened
from agents.memory import Course, Memory
from agents.skills import guest_prefix, skill
from bus.messages import Adopted, Executed, Hand, Handover, Offer, Question, SkillCall, State, Step, StepResult
from reasoning.domain import Domain
from reasoning.monitor import differing
from reasoning.solver import parse
from reasoning.values import Promises


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
            detail["robot"] = next(hand.robot for hand in course.took if hand.name == args[0])
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
    plan = memory.course
    handed = {hand.name: hand for hand in (*plan.gave, *plan.took)} if plan is not None else {}
    gave, took, guests, broken = list(memory.gave), list(memory.took), dict(memory.guests), set(memory.broken)
    for action in memory.begun.actions if memory.begun else ():
        name, args = parse(action)
        kind, robot = skill(domain, name), str(args[0]) if args else ""
        here = any(robot in map(str, parse(fluent)[1][:1]) for fluent in executed.state)
        if kind == "depart" and not here:
            gave.append(Handover(built_name(team, guests, robot), executed.step, handed[robot].kind))
            guests.pop(robot, None)
        elif kind == "arrive" and here:
            guests[robot] = handed[robot].robot
            took.append(Handover(guests[robot], executed.step, handed[robot].kind))
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
    """The rest of a plan that is on course, as the answer to a question about now, with what its proof refuted."""
    course = memory.course
    if course is None or not memory.on_course:
        return None
    left = rest(course, memory.step - course.start)
    return Offer(question(left), left.refuted)


def question(course: Course) -> Question:
    """The question that a plan answers from its own start."""
    if course.role == "share":
        gives, takes = promises(course.gave), promises(course.took)
        return Question("share", course.makespan, 0, gives, takes)
    at = next((hand.step for hand in (*course.gave, *course.took)), 0)
    return Question(course.role, course.makespan, at)


def promises(hands: tuple[Hand, ...]) -> Promises:
    """Robots that are given or taken, without their names."""
    return tuple(sorted((hand.kind, hand.step) for hand in hands))


def rest(course: Course, gone: int) -> Course:
    """What remains of a plan after `gone` of its steps, as a plan of its own that starts now."""
    gave, took = (
        tuple(replace(hand, step=hand.step - gone) for hand in hands if hand.step >= gone)
        for hands in (course.gave, course.took)
    )
    return Course(
        course.start + gone,
        course.steps[gone:],
        course.states[gone:],
        {step - gone: detail for step, detail in course.details.items() if step >= gone},
        course.role if gave or took or course.role == "share" else "alone",
        gave,
        took,
        shortened(course, gone),
    )


def adopted(team: str, memory: Memory) -> Adopted:
    """What the coordinator is told of the plan that was journalled: its exchanges in global steps. Of a robot that is
    to be taken and then given, it may have to say itself which one that is."""
    plan = memory.course
    assert plan is not None
    coming = {hand.name: hand.robot for hand in plan.took}
    gives = (replace(h, robot=coming.get(h.name, built_name(team, memory.guests, h.name))) for h in plan.gave)
    gave, took = (tuple(replace(h, step=plan.start + h.step) for h in hands) for hands in (gives, plan.took))
    return Adopted(memory.epoch, team, True, plan.makespan, gave, took)


def exchanges(plan: Adopted) -> str:
    """What is exchanged, in words."""
    words = [f", lending {hand.name} in step {hand.step}" for hand in plan.gave]
    words += [f", borrowing {hand.robot or hand.name} in step {hand.step}" for hand in plan.took]
    return "".join(words)


def built_name(team: str, guests: Mapping[str, str], robot: str) -> str:
    """The name that a robot of the team was built with; `guests` are those that came from elsewhere."""
    return guests.get(robot, f"{team}.{robot}")


def fresh_name(domain: Domain, memory: Memory) -> str:
    """A name for a guest that no robot of the team has: the prefix of the kind that is exchanged, next number."""
    prefix = guest_prefix(domain)
    numbers = [
        int(name[len(prefix) :])
        for name in known_names(memory)
        if name.startswith(prefix) and name[len(prefix) :].isdigit()
    ]
    return f"{prefix}{max(numbers, default=0) + 1}"


def known_names(memory: Memory) -> set[str]:
    """The names of bodies that the team has, or has seen come."""
    fluents = (*memory.observed, *(f"at({robot})" for robot in memory.guests))
    return {name for fluent in fluents for name in map(str, parse(fluent)[1])}


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
