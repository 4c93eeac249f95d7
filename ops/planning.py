"""Planning a whole scenario in this process: every team's planner, and the coordinator's search among them.

The same pure functions as the agents use (`reasoning.planner`, `reasoning.sharing`), or those of general sharing,
without processes. Every plan that
is found goes through the independent checker before anybody sees it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from bus.clock import wall_s
from ops import shares
from ops.compile import start
from ops.patience import Patience, begun
from ops.scenario import Scenario
from reasoning.checker import check
from reasoning.costs import cheapest
from reasoning.domain import load
from reasoning.horizons import Asking, Shared
from reasoning.ledger import Known, Ledger, learned
from reasoning.planner import Planner
from reasoning.prospects import prospects
from reasoning.setup import Setup
from reasoning.values import Answer, Plan, Problem, Question, Step, Violation

Status = Literal["optimal", "feasible", "infeasible", "unknown", "refused"]
Progress = Callable[[str], None]
LOOK_S = 0.05
"""So often is looked whether the time is over."""


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


@dataclass
class _Team:
    planner: Planner
    ledger: Ledger
    problem: Problem
    hopeless: str
    plans: dict[Known, Plan] = field(default_factory=dict)

    def learn(self, answer: Answer) -> None:
        known = learned(answer)
        if answer.plan is not None:
            self.plans[known] = answer.plan
        self.ledger = self.ledger.learn(known)


def solve(
    scenario: Scenario, progress: Progress, *, began: float | None = None, stop: Callable[[], bool] = lambda: False
) -> JointPlan:
    """The shortest shared plan with its proof, or as far as the scenario's limits allow. Raises `InputError`.

    `progress` hears what is being asked. Once `stop` is true, or ``limits.search_s`` seconds after `began`, the best
    plan so far is the result; a search that the solver cannot interrupt just then is left to itself, and ends soon.
    Raises AssertionError should the checker refuse what the planner found.
    """
    search = _Search(scenario, progress, wall_s() if began is None else began, stop)
    done = begun(search.run)
    while True:
        try:
            return done.result(timeout=LOOK_S)
        except TimeoutError:
            if search.bounded and search.patience.over():
                return search.so_far()


class _Search:
    """One scenario's search. `run` goes through with it; meanwhile `so_far` tells what it has found."""

    def __init__(self, scenario: Scenario, progress: Progress, began: float, stop: Callable[[], bool]) -> None:
        self._scenario, self._progress, self._began = scenario, progress, began
        self.patience = Patience(began, scenario.limits.search_s, stop)
        self._asking: Asking | None = None
        self._best: JointPlan | None = None
        self._questions = 0

    def run(self) -> JointPlan:
        scenario, patience = self._scenario, self.patience
        setup = start(scenario)
        domain = load(scenario.domain)
        teams = {team: _team(problem, patience) for team, problem in shares.problems(domain, setup).items()}
        if not domain.data.exchanged:
            alone, questions = _each_alone(teams, scenario, patience, self._progress)
            return _joint(alone, teams, scenario, setup, questions, self._seconds())
        roles: Mapping[str, Question] = {}
        while isinstance(result := _advance(teams, setup, self._asking), Asking):
            so_far = result.so_far
            if so_far.roles and so_far.roles != roles:  # checked at once: nothing is left to do when the time is over
                roles, self._best = so_far.roles, _joint(so_far, teams, scenario, setup, self._questions, 0.0)
            self._asking = result
            if patience.over():
                return self.so_far()
            for name, asked in sorted(result.questions.items()):
                self._progress(f"{result.within} steps: {name} {shares.words(asked)}{_so_far(result)}")
            self._questions += len(result.questions)
            answers = _ask(teams, result.questions, scenario.limits.conflicts or None, patience.left_s())
            for name, answer in answers.items():
                if answer.verdict != "unknown" or not patience.over():
                    teams[name].learn(answer)
        return _joint(result, teams, scenario, setup, self._questions, self._seconds())

    @property
    def bounded(self) -> bool:
        """Are the first bounds known? Before that there is nothing to tell, however short the budget."""
        return self._asking is not None

    def so_far(self) -> JointPlan:
        """The best plan until now, with what is proved."""
        known = self._asking.so_far if self._asking else Shared("unknown")
        proof = "; ".join(filter(None, [known.proof, self.patience.over()]))
        best = self._best or JointPlan("unknown", 0, 0, "", (), {}, 0, 0.0)
        return replace(
            best, lower_bound=known.lower_bound, proof=proof, questions=self._questions, seconds=self._seconds()
        )

    def _seconds(self) -> float:
        return wall_s() - self._began


def _ask(
    teams: Mapping[str, _Team], questions: Mapping[str, Question], conflicts: int | None, seconds: float | None
) -> dict[str, Answer]:
    """The answers, in the order of the teams' names. Each team has a solver of its own, and solving lets other threads
    run."""
    asked_of = {
        name: begun(teams[name].planner.answer, asked, conflicts=conflicts, seconds=seconds)
        for name, asked in sorted(questions.items())
    }
    return {name: future.result() for name, future in asked_of.items()}


def _team(problem: Problem, patience: Patience) -> _Team:
    planner = Planner(problem, cancelled=lambda: bool(patience.over()), clock=wall_s)
    alone = prospects(replace(problem, guest="", guests=()))
    several = bool(problem.guest or problem.guests)
    with_guest = planner.hopeless() if several else alone.hopeless
    ledger = Ledger(planner.lower_bound(), (), not alone.hopeless, several and not with_guest, alone.stock)
    return _Team(planner, ledger, problem, alone.hopeless)


def _each_alone(
    teams: Mapping[str, _Team], scenario: Scenario, patience: Patience, progress: Progress
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
    order: tuple[Literal["infeasible", "unknown", "feasible", "optimal"], ...]
    order = ("infeasible", "unknown", "feasible", "optimal")
    worst = next((status for status in order[:-1] if status in statuses), order[-1])
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
