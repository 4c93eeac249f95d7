"""Planning a whole scenario in this process: every team's planner, and the coordinator's search among them.

The same pure functions as the agents use (`reasoning.planner`, `reasoning.sharing`), or those of general sharing,
without processes. Every plan that
is found goes through the independent checker before anybody sees it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Literal

from bus.clock import wall_s
from ops import shares
from ops.compile import start
from ops.scenario import Scenario
from reasoning.checker import check
from reasoning.costs import cheapest
from reasoning.domain import load
from reasoning.horizons import Asking, Shared
from reasoning.ledger import Known, Ledger
from reasoning.planner import Planner
from reasoning.prospects import prospects
from reasoning.setup import Setup
from reasoning.values import Answer, Plan, Problem, Question, Step, Violation

Status = Literal["optimal", "feasible", "infeasible", "unknown", "refused"]
Progress = Callable[[str], None]


@dataclass(frozen=True)
class JointPlan:
    """The result, as ``muster plan`` prints it. Steps count from 0. With a plan, `gap` is how much shorter a better one
    might be; without one it is None. `refused` is what the checker has against a plan whose domain lets it be made
    without all of the geometry; its status is then ``refused``."""

    status: Status
    makespan: int
    lower_bound: int
    proof: str
    exchanges: tuple[dict[str, str | int], ...]
    teams: Mapping[str, tuple[Step, ...]]
    questions: int
    seconds: float
    refused: tuple[Violation, ...] = ()

    @property
    def gap(self) -> int | None:
        return self.makespan - self.lower_bound if self.status in ("optimal", "feasible") else None


class _Patience:
    """How long the search may go on: `search_s` wall seconds from `began` (0: for ever), or until `stop` says so."""

    def __init__(self, began: float, search_s: float, stop: Callable[[], bool]) -> None:
        self._stop, self._search_s = stop, search_s
        # A little early: a search that goes on looks up a few times a second only, and later still on a busy machine.
        self._end = began + 0.95 * search_s if search_s else math.inf

    @property
    def limited(self) -> bool:
        return self._end < math.inf

    def left_s(self) -> float | None:
        return self._end - wall_s() if self.limited else None

    def over(self) -> str:
        """Why the search is over, in words; "" if it is not."""
        if self._stop():
            return "the search was interrupted"
        late = wall_s() >= self._end
        return f"the search was stopped after {self._search_s:g} s, by --budget or limits.search_s" if late else ""


@dataclass
class _Team:
    planner: Planner
    ledger: Ledger
    problem: Problem
    hopeless: str
    plans: dict[Known, Plan] = field(default_factory=dict)

    def learn(self, answer: Answer) -> None:
        known = shares.learned(answer)
        if answer.plan is not None:
            self.plans[known] = answer.plan
        self.ledger = self.ledger.learn(known)


def solve(
    scenario: Scenario, progress: Progress, *, began: float | None = None, stop: Callable[[], bool] = lambda: False
) -> JointPlan:
    """The shortest shared plan with its proof, or as far as the scenario's limits allow. Raises `InputError`.

    `progress` hears what is being asked. Once `stop` is true, or ``limits.search_s`` seconds after `began`, the best
    plan so far is the result. Raises AssertionError should the checker refuse what the planner found.
    """
    began = wall_s() if began is None else began
    setup = start(scenario)
    domain = load(scenario.domain)
    patience = _Patience(began, scenario.limits.search_s, stop)
    problems = shares.problems(domain, setup)
    teams = {team: _team(problem, patience) for team, problem in problems.items()}
    if not domain.data.exchanged:
        alone, questions = _each_alone(teams, scenario, patience, progress)
        return _joint(alone, teams, scenario, setup, questions, wall_s() - began)
    questions = 0
    best: tuple[Shared, JointPlan] | None = None
    asking: Asking | None = None
    while isinstance(result := _advance(teams, setup, asking), Asking):
        asking = result
        so_far = result.so_far
        if patience.limited and so_far.roles and (best is None or best[0].roles != so_far.roles):
            # Checked as soon as it is found, so that nothing is left to do when the time is over.
            best = so_far, _joint(so_far, teams, scenario, setup, questions, 0.0)
        if why := patience.over():
            proof = "; ".join(filter(None, [so_far.proof, why]))
            if best is not None:
                seconds = wall_s() - began
                bound = so_far.lower_bound
                return replace(best[1], lower_bound=bound, proof=proof, questions=questions, seconds=seconds)
            result = replace(so_far, proof=proof)
            break
        for name, asked in sorted(result.questions.items()):
            progress(f"{result.within} steps: {name} {shares.words(asked)}{_so_far(result)}")
        questions += len(result.questions)
        answers = _ask(teams, result.questions, scenario.limits.conflicts or None, patience.left_s())
        for name, answer in answers.items():
            if answer.verdict != "unknown" or not patience.over():
                teams[name].learn(answer)
    return _joint(result, teams, scenario, setup, questions, wall_s() - began)


def _ask(
    teams: Mapping[str, _Team], questions: Mapping[str, Question], conflicts: int | None, seconds: float | None
) -> dict[str, Answer]:
    """The answers, in the order of the teams' names. Each team has a solver of its own, and solving lets other threads
    run."""
    with ThreadPoolExecutor() as pool:
        futures = {
            name: pool.submit(teams[name].planner.answer, asked, conflicts=conflicts, seconds=seconds)
            for name, asked in sorted(questions.items())
        }
    return {name: future.result() for name, future in futures.items()}


def _team(problem: Problem, patience: _Patience) -> _Team:
    planner = Planner(problem, cancelled=lambda: bool(patience.over()), clock=wall_s)
    alone = prospects(replace(problem, guest="", guests=()))
    several = bool(problem.guest or problem.guests)
    with_guest = planner.hopeless() if several else alone.hopeless
    ledger = Ledger(planner.lower_bound(), (), not alone.hopeless, several and not with_guest, alone.stock)
    return _Team(planner, ledger, problem, alone.hopeless)


def _each_alone(
    teams: Mapping[str, _Team], scenario: Scenario, patience: _Patience, progress: Progress
) -> tuple[Shared, int]:
    """Where nobody is lent: every team's own shortest plan, of these one that costs least; and how many questions that
    took."""
    asked: list[Answer] = []
    roles: dict[str, Question] = {}
    bounds: list[int] = [0]
    proofs: list[str] = []
    statuses: set[Status] = set()
    over = lambda: bool(patience.over())  # noqa: E731
    for name, team in teams.items():

        def told(answer: Answer, name: str = name) -> None:
            progress(f"{name}: {answer.question.within} steps: {answer.verdict}")
            asked.append(answer)

        limit = scenario.limits.conflicts or None
        found = team.planner.shortest(conflicts=limit, seconds=patience.left_s(), on_progress=told)
        statuses.add(found.status)
        bounds.append(found.lower_bound)
        team.hopeless = team.planner.hopeless()  # an answer may have shown that the goal is out of reach for good
        proofs += [] if team.hopeless else [f"{name}: {found.proof}"]
        if found.plan is None:
            continue
        within = found.plan.makespan
        plan, why = cheapest(team.problem, found.plan, within, seconds=patience.left_s, cancelled=over, clock=wall_s)
        proofs += [f"{name}: {why}"] if why else []
        roles[name] = Question("alone", within)
        team.learn(Answer(roles[name], "yes", plan))
    worst: Literal["optimal", "infeasible", "unknown"] = "optimal"
    worst = "infeasible" if "infeasible" in statuses else "unknown" if "unknown" in statuses else worst
    makespan = max((question.within for question in roles.values()), default=0)
    return Shared(worst, makespan, max(bounds), roles, (), "; ".join(proofs)), len(asked)


def _advance(teams: Mapping[str, _Team], setup: Setup, before: Asking | None) -> Asking | Shared:
    return shares.advance({name: team.ledger for name, team in teams.items()}, setup, before)


def _joint(
    shared: Shared, teams: Mapping[str, _Team], scenario: Scenario, setup: Setup, questions: int, seconds: float
) -> JointPlan:
    if shared.status not in ("optimal", "feasible"):
        why = [f"{name}: {team.hopeless}" for name, team in teams.items() if team.hopeless]
        proof = "; ".join(filter(None, [shared.proof, *why]))
        return JointPlan(shared.status, 0, shared.lower_bound, proof, (), {}, questions, seconds)
    plans: dict[str, Plan] = {}
    for name, question in shared.roles.items():
        known = teams[name].ledger.witness(question)
        if known is None:
            raise AssertionError(f"{name}: no plan answers {question}")
        plans[name] = teams[name].plans[known]
    exchanges = tuple(shares.exchanged(loan, plans) for loan in shared.loans)
    steps = {name: plan.steps for name, plan in plans.items()}
    details = {name: plan.details for name, plan in plans.items()}
    violations = check(scenario.domain, setup.static, setup.states, steps, exchanges=exchanges, details=details)
    if violations and not load(scenario.domain).data.geometry:
        raise AssertionError(f"the checker refuses the plan: {violations[0]}")
    told: tuple[dict[str, str | int], ...] = tuple(
        {
            "worker": x.worker,
            "from": x.giver,
            "give_step": x.give_step,
            "to": x.taker,
            "take_step": x.take_step,
            "as": x.known_as,
        }
        for x in exchanges
    )
    makespan = max(plan.makespan for plan in plans.values())
    status: Status = "refused" if violations else shared.status
    refused = tuple(violations)
    return JointPlan(status, makespan, shared.lower_bound, shared.proof, told, steps, questions, seconds, refused)


def _so_far(asking: Asking) -> str:
    return f" (at least {asking.low} are needed; {f'{asking.high} are known' if asking.high else 'no plan yet'})"
