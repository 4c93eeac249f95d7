"""What a team does when the world is not as planned, as pure functions: explain, inspect, settle, and see whether the
rest of the plan still leads to its goal.

| cause                        | recovery                                                              |
|------------------------------|-----------------------------------------------------------------------|
| broken(R), the only explanation | R is known to be broken; the next plan has it repaired or does without |
| broken, several explanations | inspect suspects, one a step, until one explanation is left           |
| moved, set_back, changed     | plan on from what is seen                                             |
| order changed                | plan on with the objects that are there now                           |
| unexplained                  | plan on from what is seen                                             |
"""

from __future__ import annotations

from collections.abc import Mapping

from msgspec.structs import replace

from agents.carrying import waited
from agents.course import beliefs, rest
from agents.guests import following, problem
from agents.memory import Begun, Memory
from agents.skills import actions_of
from bus import messages as m
from reasoning.diagnoser import broken_in, diagnose, inspection_order
from reasoning.domain import Domain
from reasoning.monitor import appeared, differing, vanished
from reasoning.planner import predict
from reasoning.solver import parse
from reasoning.values import Case, Problem, State, Value

BOUND = 3
"""At most so many robots of one team are suspected at once."""
LONGEST_WAIT = 8
"""A team that has waited for more steps forgets what its plan's proof refuted."""


def only_order(before: State, predicted: State, observed: State, differing_fluents: tuple[str, ...]) -> bool:
    """Is all that differs about objects that were not there before the step, or are there no more?"""
    news = set(appeared(predicted, observed, before)) | set(vanished(predicted, observed, before))
    return bool(news) and set(differing_fluents) <= news


def explain(
    domain: str, static: Mapping[str, Value], memory: Memory, details: Mapping[tuple[int, str], Mapping[str, Value]]
) -> tuple[m.Diagnosis, ...]:
    """All minimal explanations of what is observed after the epoch's history. `since` is in global steps."""
    first = memory.step - len(memory.history)
    came = tuple((hand.name, hand.kind) for hand in memory.course.took) if memory.course is not None else ()
    result = diagnose(Case(domain, static, memory.since, memory.history, memory.observed, BOUND, details, came))
    return tuple(
        m.Diagnosis(
            d.causes,
            {cause: tuple(first + step for step in steps) for cause, steps in d.since.items()},
            d.happened,
        )
        for d in result.diagnoses
    )


def settle(memory: Memory, diagnoses: tuple[m.Diagnosis, ...]) -> Memory:
    """Take in what is certain: one explanation left means that its robots are known to be broken."""
    if len(diagnoses) > 1 and suspects(diagnoses):
        return replace(memory, open=diagnoses)
    broken = {robot for d in diagnoses[:1] for robot in broken_in(d)}
    return replace(memory, open=(), broken=tuple(sorted({*memory.broken, *broken})))


def suspects(diagnoses: tuple[m.Diagnosis, ...]) -> tuple[str, ...]:
    """Robots worth an inspection, best first: those that some explanations blame and others do not."""
    return inspection_order(map(broken_in, diagnoses)) if len(diagnoses) > 1 else ()


def next_inspection(domain: Domain, memory: Memory) -> tuple[str, ...] | None:
    """The inspection of the best suspect, as this step's only action; None when nobody is suspected."""
    order = suspects(memory.open)
    return (f"{actions_of(domain, 'inspect')[0]}({order[0]})",) if order else None


def calls(begun: Begun) -> tuple[m.SkillCall, ...]:
    """An inspection step as the world is asked to carry it out."""
    return tuple(m.SkillCall(*parse(action)) for action in begun.actions)


def narrowed(memory: Memory, findings: Mapping[str, str]) -> Memory:
    """Memory after inspections: explanations that they contradict are dropped, what is certain is taken in. Without
    any finding (the suspect is gone, say) there is nothing more to be learned."""
    if not findings:
        return replace(memory, open=())
    broken = {robot for robot, finding in findings.items() if finding == "broken"}
    sound = set(findings) - broken
    left = tuple(d for d in memory.open if broken <= set(broken_in(d)) and not sound & set(broken_in(d)))
    known = tuple(sorted({*memory.broken, *broken}))
    return settle(replace(memory, broken=known), left)


def still_on_course(domain: Domain, static: Mapping[str, Value], numbers: Mapping[str, int], memory: Memory) -> Memory:
    """Does the rest of the plan still reach its goal from what is seen now? If so, the plan is kept, with its
    predictions made anew where waiting has changed a detail (paint dries), which also weakens its proof. `numbers` as
    in `agents.guests`."""
    course = memory.course
    if course is None or not memory.on_course:
        return memory
    gone = max(memory.step - course.start, 0)
    if gone >= course.makespan:
        same = not differing(course.states[-1], memory.observed)
        return replace(memory, on_course=same)
    if not memory.broken and not differing(course.states[gone], memory.observed):
        return memory
    left = rest(course, gone)
    details = {(k, a): d for k, by in left.details.items() for a, d in by.items()}
    now = following(problem(domain, static, numbers, memory, beliefs(memory)), left)
    plan, possible = predict(now, left.steps, details)
    if possible < left.makespan or differing(course.states[-1], plan.states[-1]):
        return replace(memory, on_course=False)
    states = (*course.states[:gone], *(dict(s) for s in plan.states))
    refuted = waited(course, gone, _steps_waited(domain, static, course.states[gone], memory))
    return replace(memory, course=replace(course, states=states, refuted=refuted))


def _steps_waited(domain: Domain, static: Mapping[str, Value], before: State, memory: Memory) -> int | None:
    """How many steps without an action lead from the state `before` to what is seen; None: no such number does."""
    start = Problem(domain.name, static, beliefs(replace(memory, observed=dict(before))))
    idle, _ = predict(start, ((),) * LONGEST_WAIT)
    return next((n for n, state in enumerate(idle.states) if not differing(state, memory.observed)), None)
