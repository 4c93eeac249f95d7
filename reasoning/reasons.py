"""What can be asked why: the domain's programs ``why*.lp`` with the facts of a question, loaded and grounded.

Each function gives a maker of fresh programs for `reasoning.why.explain`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Literal

from reasoning.checker import Break, Exchange, is_term, judged
from reasoning.diagnoser import BROKEN, facts_of
from reasoning.domain import core_program, load
from reasoning.solver import Program, quoted
from reasoning.values import Case, Problem, State, Step, Value

Make = Callable[[], Program]
Role = Literal["lend", "borrow"]
OPTIONS = ("--config=handy",)


def no_plan(problem: Problem, within: int, enough: int, exchange: tuple[Role, int] | None = None) -> Make:
    """Why is there no plan of at most `within` steps? `enough`, more than these, is the length that is tried when the
    number of steps is left out. `exchange` is what the team lends, by a step, or borrows, from a step on.

    Raises ValueError if `enough` is not more.
    """
    if enough <= within:
        raise ValueError(f"expected more than {within} steps, not {enough}")
    facts = [f"limit({within}).", f"length({within};{enough})."]
    facts += [f"{exchange[0]}({exchange[1]})."] if exchange else []
    return _planning(problem, "why", facts, enough)


def without_time(problem: Problem) -> Problem:
    """The same problem without a deadline."""
    names = load(problem.domain).data.costs
    key = f"{names['most']}({problem.state.get(names['room'])},{names['clock']})" if names else ""
    return replace(problem, static={name: value for name, value in problem.static.items() if name != key})


def never_in_time(problem: Problem, enough: int) -> Make:
    """Why is there no plan, however long, though there is one of `enough` steps if time does not matter? Where time is
    what bounds a plan: none that is in time has more than `enough` steps."""
    return _planning(problem, "why", [f"length({enough})."], enough)


def never(problem: Problem) -> Make:
    """Why is there no plan, however long? Only what cannot be even if nothing that was reached were ever lost."""
    return _planning(problem, "why_ever", [], 0)


def not_possible(problem: Problem, action: str, others: Step = ()) -> Make:
    """Why can this action not be done in the problem's state, together with the others of the same step?

    Raises ValueError for an action that is not written as a term.
    """
    for written in (action, *others):
        if not is_term(written):
            raise ValueError(f"not an action: {written!r}")
    facts = [f"wanted({action}).", *(f"commanded({other})." for other in others if other != action)]
    return _planning(problem, "why_action", facts, 1)


def contradicts(
    case: Case, *, broken: str = "", whole: str = "", most: int = 1, findings: Mapping[str, str] | None = None
) -> Make:
    """What contradicts the hypothesis that this robot is broken, or whole, when at most so many are broken?
    `findings[robot]` is what an inspection said: ``broken`` or ``sound``."""
    facts = [fact.replace("occurs(", "commanded(", 1) for fact in facts_of(case)]
    facts += (
        [f"most({most})."] + ([f"suspect({broken})."] if broken else []) + ([f"cleared({whole})."] if whole else [])
    )
    facts += [f"inspected({robot},{finding})." for robot, finding in (findings or {}).items()]
    file = load(case.domain).program("why_suspect")
    return lambda: _grounded(Program([file], facts, OPTIONS), 0)


def no_sharing(
    within: int,
    delay: int,
    teams: Iterable[str],
    *,
    alone: Iterable[str] = (),
    early: Mapping[str, int] | None = None,
    late: Mapping[str, int] | None = None,
    must: Mapping[str, Role] | None = None,
    may_not: Mapping[str, Role] | None = None,
) -> Make:
    """Why can teams that lend one another robots not all be done in time?

    Those of `alone` cannot finish by themselves; `early[team]` is the earliest step in which it can lend, `late[team]`
    the latest in which it can borrow; `must` and `may_not` are roles that are asked about.
    """
    facts = [f"steps({within}).", f"delay({delay}).", *(f"team({quoted(team)})." for team in teams)]
    facts += [f"alone({quoted(team)})." for team in alone]
    for name, steps in (("early", early), ("late", late), ("must", must), ("may_not", may_not)):
        facts += [f"{name}({quoted(team)},{step})." for team, step in (steps or {}).items()]
    return lambda: _grounded(Program([core_program("why_share")], facts), 0)


def follow(
    domain: str,
    static: Mapping[str, Value],
    states: Mapping[str, State],
    plan: Mapping[str, Sequence[Step]],
    exchanges: Iterable[Exchange] = (),
    breaks: Iterable[Break] = (),
) -> dict[str, list[dict[str, Value]]]:
    """The states of each team that a plan goes through, as the checker sees them: what was illegal or broken had no
    effect. One more than the plan has steps; with ``broken(R)`` for robots that are known to be broken then.

    Raises ValueError for an action that is not written as a term.
    """
    horizon = max(map(len, plan.values()), default=0)
    facts = [f"horizon({horizon}).", "told.", *(f"static({key},{value})." for key, value in static.items())]
    for team, state in states.items():
        facts += [f"team({quoted(team)}).", *(f"init({quoted(team)},{f},{v})." for f, v in state.items())]
        for step, actions in enumerate(plan.get(team, ())):
            if wrong := [action for action in actions if not is_term(action)]:
                raise ValueError(f"not an action: {wrong[0]!r}")
            facts += [f"occurs({quoted(team)},{action},{step})." for action in dict.fromkeys(actions)]
    for e in exchanges:
        ends = f"{quoted(e.giver)},{e.give_step},{quoted(e.taker)},{e.take_step}"
        facts.append(f"exchange({e.worker},{ends},{e.known_as}).")
    facts += [f"breaks({quoted(b.team)},{b.robot},{b.step})." for b in breaks]
    found: dict[str, list[dict[str, Value]]] = {team: [{} for _ in range(horizon + 1)] for team in states}
    for name, args in judged(load(domain), static, states, facts, ("check", "why_states")):
        match name, args:
            case "val", (of, fluent, value, int(step)):
                found[str(of)][step][str(fluent)] = value
            case "noticed", (of, robot, int(step)):
                found[str(of)][step][f"{BROKEN}({robot})"] = 1
    return found


def _planning(problem: Problem, entry: str, question: list[str], horizon: int) -> Make:
    """A question about what the problem's team can do."""
    domain = load(problem.domain)
    file = domain.program(entry)
    facts = [f"static({key},{value})." for key, value in problem.static.items()]
    facts += [f"init({fluent},{value})." for fluent, value in problem.state.items()]
    facts += [f"guest({problem.guest})."] if problem.guest else []
    if not domain.data.geometry:
        return lambda: _grounded(Program([file], [*facts, *question], domain.data.solver), horizon)
    from reasoning import pieces  # only now: slow to import, and most domains do without

    facts += pieces.facts(problem)

    def make() -> Program:
        program = Program([file], [*facts, *question], domain.data.solver)
        if horizon:
            pieces.interleave(problem, program)
        return _grounded(program, horizon)

    return make


def _grounded(program: Program, horizon: int) -> Program:
    program.ground(("base", ()), *(("step", (t,)) for t in range(1, horizon + 1)))
    return program
