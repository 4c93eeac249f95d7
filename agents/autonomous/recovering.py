"""What follows when a step is over: on with the plan, or the recovery that belongs to the cause of the difference.

| cause            | recovery                                                                                       |
|------------------|------------------------------------------------------------------------------------------------|
| unknown_object   | another way to the plan's next state, from where the robot stands; if there is none, to a safe |
|                  | cell, and plan with the object known                                                           |
| person_in_way    | wait a unit, then another way; after many units step aside, for the person may wait, too       |
| held_up          | wait a unit, then another way, one robot after the other, while those in between step aside;   |
|                  | after some such, plan anew without that way                                                    |
| object_not_found | look, plan anew                                                                                |
| heavy_object     | plan anew: with both robots of the room, or the heavy object last and with help                |
| robot_broken     | diagnose; plan anew without the robot, and without what it holds                               |
| object_appeared  | none: ways go round it, and the final look finds it                                            |
| deadline_at_risk | plan anew, with help if that is the only way                                                   |
| helper_gone      | plan anew without the guest that its own team has called home                                  |
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.autonomous.beliefs import problem_state
from agents.autonomous.causes import Cause, causes
from agents.autonomous.thinking import Course, Thought
from agents.autonomous.words import Words
from bus.messages import Executed, SkillCall, Value
from reasoning.diagnoser import broken_in, diagnose
from reasoning.geometry import Cell
from reasoning.motion.layout import Disc
from reasoning.solver import parse
from reasoning.values import Case, State
from reasoning.words import count

if TYPE_CHECKING:
    from agents.autonomous.memory import Begun, Memory
    from agents.autonomous.mind import Mind

DOING = {
    "drive_on": "going on by another way",
    "aside": "making way for another robot",
    "safe": "going to a safe cell",
    "door": "sending a robot to the door",
    "leave": "sending a robot to another room",
    "enter": "letting a robot in",
    "home": "sending a robot back to its place",
    "recall": "calling a robot home",
}
PATIENCE_UNITS = 40
"""So long is waited for a person who stands in the way."""
FACING_UNITS = 20
"""So long a robot stands in front of a person who does not go away, who may be waiting for it in turn; then it steps
aside."""
PASSING_UNITS = 6
"""So long it stays aside."""
MOST_GIVEN_WAY = 3
"""So often robots step aside for people."""
HELD_UP_TIMES = 4
"""So often another way is tried where nothing is known to be in the way."""
MOST_ASIDE = 12
"""So often robots step aside for one another."""
MOST_BARRED = 12
"""After so many ways that turned out impossible, what is left to do is left."""
PERSON_M = 0.35
"""How far ways keep off the middle of the cell in which a person stands, besides the robot's radius."""
STOPS = ("unknown_object", "person_in_way", "held_up")
WORDS = {
    "heavy_object": "finds {0} too heavy for one robot",
    "object_not_found": "does not find {0} where it should be",
    "person_in_way": "has a person in the way of {1}: {0}",
    "unknown_object": "has an unknown object in the way of {1}: {0}",
    "held_up": "has {1} held up by {0}",
    "robot_broken": "finds that {0} does not do what it should: it must be broken",
    "object_appeared": "sees {0}, which it did not know of",
}


def after_step(mind: Mind, begun: Begun, before: Memory, body: Executed) -> None:
    """A step of the plan is over. `before` is the memory when it was."""
    now = mind.memory
    found = causes(mind.words, before.state, begun.predicted, now.state, body.felt, begun.actions)
    for cause in found:
        _tell(mind, cause, body.step)
    if any(cause.name == "robot_broken" for cause in found):
        _do_without(mind, begun, before)
    goals = _goals(begun, mind.words)
    if any(cause.name not in (*STOPS, "object_appeared") for cause in found):
        mind.keep(course=None, need=None, stopped={}, looked=False)
    else:
        _stop(mind, {cause.robot: goals[cause.robot] for cause in found if cause.name in STOPS}, found)
    if not found:
        _watch_deadline(mind, body.step)


def after_driving(mind: Mind, begun: Begun, before: Memory, body: Executed) -> None:
    """Robots went on after they had stopped, or stepped aside. `begun` has their goals."""
    now = mind.memory
    goals = _goals(begun, mind.words)
    here = mind.words.robots(now.state)
    later = {robot: goal for robot, goal in before.stopped.items() if robot in here and robot not in goals}
    left = {
        r: g for r, g in goals.items() if r in here and (mind.words.cell(now.state, r) != g or _stands_off(mind, r))
    }
    predicted = {**now.state, **{f"{mind.words.place}({r})": written(goal) for r, goal in left.items()}}
    actions = [action for action in begun.actions if str(parse(action)[1][0]) in left]
    found = causes(mind.words, before.state, predicted, now.state, body.felt, actions)
    for cause in found:
        _tell(mind, cause, body.step)
    if begun.purpose == "safe" or any(cause.name not in (*STOPS, "object_appeared") for cause in found):
        astray = bool(left) and begun.purpose == "safe"
        mind.keep(course=None, stopped={}, looked=False, held=now.held + 1 if astray else 0)
        if astray:
            mind.wait(1)
    else:
        _stop(mind, later if begun.purpose == "aside" else {**left, **later}, found)


def _do_without(mind: Mind, begun: Begun, before: Memory) -> None:
    """Diagnose what happened: robots that are broken are done without, and so is what they hold."""
    words, now = mind.words, mind.memory
    details = {(0, action): detail for action, detail in _details(begun).items()}
    case = Case(
        mind.domain.name,
        mind.static,
        problem_state(words, before.state),
        (begun.actions,),
        problem_state(words, now.state),
        details=details,
    )
    found = mind.patiently(lambda: diagnose(case)).diagnoses
    causes_ = [list(d.causes) for d in found]
    said = " or ".join("{" + ", ".join(c) + "}" for c in causes_) or "nothing that it knows of"
    mind.emit("diagnosis", f"explains it by {said}", step=begun.step, causes=causes_)
    broken = {robot for d in found[:1] for robot in broken_in(d)}
    _leave_be(mind, broken)


def _leave_be(mind: Mind, broken: set[str]) -> None:
    """Broken robots stay where they are, and so does what they hold."""
    now = mind.memory
    held = {end[0]: robot for robot in broken if (end := mind.words.held(now.state, robot)) is not None}
    aside = {thing: f"{robot}, which is broken, holds it" for thing, robot in sorted(held.items())}
    mind.keep(aside={**now.aside, **aside})
    mind.do_without(broken)


def broken_outside_plan(mind: Mind, robot: str, step: int) -> None:
    """A robot that was to go to another room, or back, did not."""
    _tell(mind, Cause("robot_broken", robot, robot), step)
    _leave_be(mind, {robot})
    mind.keep(course=None, need=None, looked=False, resting=False)


def _details(begun: Begun) -> dict[str, dict[str, Value]]:
    """What the written actions leave out, as far as it is about the state."""
    return {
        term(call): {key: value for key, value in call.detail.items() if key not in ("way", "units")}
        for call in begun.calls
    }


def _stop(mind: Mind, stopped: dict[str, Cell], found: list[Cause]) -> None:
    """Robots that stopped go on in the next step; where a person or another robot was in the way, after a while."""
    now, names = mind.memory, {cause.name for cause in found}
    waited, held = now.waited + ("person_in_way" in names), now.held + ("held_up" in names)
    mind.keep(stopped=stopped, waited=waited if stopped else 0, held=held if stopped else 0)
    if names & {"person_in_way", "held_up"}:
        mind.emit("waited", "waits for a unit of time", step=mind.memory.step)
        mind.wait(1)


def _watch_deadline(mind: Mind, step: int) -> None:
    """Will the rest of the plan still end in time?"""
    now, words = mind.memory, mind.words
    deadline = words.deadline(mind.static, now.state)
    if now.course is None or not deadline or now.late:
        return
    end = words.now(now.state) + words.now(now.course.states[-1]) - words.now(now.course.states[now.at])
    if end > deadline and not now.left and now.need is None:
        mind.emit("deadline_missed", f"was done after {end} units, and the deadline was at {deadline}", step=step)
        mind.keep(late=True)
    elif end > deadline:
        text = f"would be done after {end} units, and the deadline is at {deadline}"
        mind.emit("deadline_at_risk", text, step=step, end=end, deadline=deadline)
        mind.keep(course=None, looked=False)


def tell_plan(mind: Mind, thought: Thought, course: Course) -> None:
    """A plan is adopted."""
    makespan = len(course.steps)
    then = f", then help {thought.need.about}" if thought.need is not None else ""
    mind.emit(
        "plan_adopted",
        f"adopts a plan of {count(makespan, 'step')}{then}: {thought.proof}",
        epoch=mind.memory.plans + 1,
        start=mind.memory.step,
        makespan=makespan,
        role="alone" if thought.need is None else "with_help",
        status=thought.status,
        proof=thought.proof,
    )


def _tell(mind: Mind, cause: Cause, step: int) -> None:
    """Causes are events of their own names."""
    text = WORDS[cause.name].format(cause.about, cause.robot)
    mind.emit(cause.name, text, step=step, about=cause.about, robot=cause.robot)


def _goals(begun: Begun, words: Words) -> dict[str, Cell]:
    """Where robots were to go in a step."""
    terms = [parse(action) for action in begun.actions]
    return {str(args[0]): (int(args[1]), int(args[2])) for name, args in terms if name == words.go}


def _stands_off(mind: Mind, robot: str) -> bool:
    return mind.words.between_cells(mind.memory.state, robot)


def people(words: Words, state: State) -> tuple[Disc, ...]:
    """People, as obstacles."""
    return tuple((*words.point(state, person), PERSON_M) for person in words.persons(state))


def nothing(state: dict[str, int | str]) -> Course:
    """The plan that does nothing."""
    return Course((), (state,))


def term(call: SkillCall) -> str:
    return f"{call.name}({','.join(map(str, call.args))})"


def written(at: Cell) -> str:
    return f"({at[0]},{at[1]})"
