"""Problems as facts for the domain's programs, and plans from their models."""

from __future__ import annotations

from dataclasses import replace

from reasoning.domain import load
from reasoning.solver import Atom, Model
from reasoning.values import Handed, Plan, Problem, State, Value


def facts(problem: Problem) -> list[str]:
    """What the planner's programs are told of a problem."""
    told = [f"static({key},{value})." for key, value in problem.static.items()]
    told += [f"init({fluent},{value})." for fluent, value in problem.state.items()]
    if load(problem.domain).data.geometry:
        from reasoning import geometry  # only now: slow to import, and most domains do without

        told += geometry.facts(problem)
    told += [f"guest({problem.guest})."] if problem.guest else []
    return told + [f"guest({name},{kind})." for name, kind in problem.guests]


def plan_in(model: Model, within: int) -> Plan:
    """The plan in a model, without the idle steps at its end."""
    idle_from = 1 + max((int(a.args[1]) for a in model.atoms if a.name == "occurs"), default=-1)
    reached = [int(a.args[0]) for a in model.atoms if a.name == "goal"]
    return read(model, min(t for t in (*reached, within) if t >= idle_from))


def read(model: Model, makespan: int) -> Plan:
    """The first `makespan` steps of a model."""
    steps: list[list[str]] = [[] for _ in range(makespan)]
    states: list[dict[str, Value]] = [{} for _ in range(makespan + 1)]
    details: dict[tuple[int, str], dict[str, Value]] = {}
    exchange = None
    handed: dict[str, list[Handed]] = {"gives": [], "takes": []}
    for atom in model.atoms:
        match atom:
            case Atom("occurs", (action, int(t))) if t < makespan:
                steps[t].append(str(action))
            case Atom("holds", (fluent, value, int(t))) if t <= makespan:
                states[t][str(fluent)] = value
            case Atom("detail", (action, key, value, int(t))) if t < makespan:
                details.setdefault((t, str(action)), {})[str(key)] = value
            case Atom("exchanged", (robot, int(t))) if t < makespan:
                exchange = (str(robot), t)
            case Atom("handed", (way, robot, kind, int(t))) if t < makespan:
                handed[str(way)].append(Handed(str(kind), t, str(robot)))
    states_: tuple[State, ...] = tuple(states)
    gave, took = tuple(sorted(handed["gives"])), tuple(sorted(handed["takes"]))
    return Plan(tuple(map(tuple, steps)), states_, details, exchange, gave, took)


def rest(plan: Plan, done: int) -> Plan:
    """The remainder of a plan after `done` of its steps; an exchange is forgotten once it has happened."""
    exchange = plan.exchange
    if exchange is not None:
        exchange = (exchange[0], exchange[1] - done) if exchange[1] >= done else None
    details = {(t - done, action): detail for (t, action), detail in plan.details.items() if t >= done}
    gave, took = (
        tuple(one._replace(step=one.step - done) for one in handed if one.step >= done)
        for handed in (plan.gave, plan.took)
    )
    return replace(
        plan,
        steps=plan.steps[done:],
        states=plan.states[done:],
        details=details,
        exchange=exchange,
        gave=gave,
        took=took,
    )
