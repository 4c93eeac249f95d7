"""What a team plans to do: alone, or as far as it can alone before help is needed, or what it has to leave as it is.

Pure: from what a team believes to a `Thought`. Every plan is checked by the independent checker before it is followed.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from agents.autonomous.beliefs import problem_state, without
from agents.autonomous.words import Words
from agents.course import to_details
from bus.messages import Steps, Value
from reasoning.checker import check
from reasoning.costs import cheapest
from reasoning.domain import Domain
from reasoning.geometry import Cell
from reasoning.planner import Planner
from reasoning.prospects import prospects
from reasoning.values import Plan, Problem, Question, State

MORE_STEPS = 6
"""So many steps more than are needed at least are looked at."""
LAST_STEPS = range(4, 13)
"""In how many steps before the end a helper may be needed, from few to many."""
DOOR_UNITS = 4
"""A robot gets to a door in so many units at most, wherever it is."""
CONFLICTS = 20_000
"""At most so many conflicts for all steps of a search: within a deadline that cannot be met it would go on for ever."""
GUEST = "guest"
OWN = 1000
"""Constants that a team adds are numbered from here, apart from those of the scenario."""


class Course(msgspec.Struct, frozen=True):
    """A plan that a team follows; `states[i]` is predicted before step i, `details[i]` holds by action what the written
    action leaves out."""

    steps: Steps
    states: tuple[dict[str, Value], ...]
    details: dict[int, dict[str, dict[str, Value]]] = {}


class Need(msgspec.Struct, frozen=True):
    """A robot of another team is needed for so many `units`; `strong` if to carry something heavy. `deadline`: not
    for the work, but to do it in time."""

    units: int
    about: str
    strong: bool = False
    deadline: bool = False


class Thought(msgspec.Struct, frozen=True):
    """`course` is what the team does by itself (None: nothing, before there is help), `need` the help that it needs
    then; `aside` says for each thing that is left as it is why; `late`: the deadline cannot be met. `status` is the
    claim about the plan's length, `proof` why."""

    course: Course | None
    need: Need | None = None
    aside: dict[str, str] = {}
    late: bool = False
    status: str = "optimal"
    proof: str = ""


class Thinking:
    """The planner of one team."""

    def __init__(self, domain: Domain, team: str, words: Words, static: Mapping[str, Value]) -> None:
        self._domain, self._team, self._words = domain, team, words
        self._names = domain.data.autonomy
        self._static = dict(static)
        self.never: tuple[str, ...] = ()
        """Ways (robot, from, to) that were found impossible."""
        self._delay = int(static.get("delay", 0))

    def consider(self, state: State, aside: Mapping[str, str], *, helped: bool, late: bool) -> Thought:
        """What to do now. `aside` are things that are left already; `helped`: nobody else can be asked, since a helper
        is here or nobody has one to spare; `late`: the deadline does not count any more."""
        words, left = self._words, dict(aside)
        now = problem_state(words, state)
        past = 0 < words.deadline(self._static, now) < words.now(now)
        if past and not late:  # it is missed only if there is something left to do
            thought = self.consider(state, aside, helped=helped, late=True)
            undone = thought.need is not None or thought.course is None or bool(thought.course.steps)
            return msgspec.structs.replace(thought, late=undone)
        static = self._static if not late else self._loose(now)
        guest = {} if helped else self._guest(now)
        left |= self._impossible(now, guest, left)
        alone = self._attempt(static, now, left)
        if alone is not None:
            return self._thought(alone, left, late)
        heavy = [n for n in words.heavy(now) if n not in left and self._single(self._loose(now), now, left, n)]
        if heavy and guest:
            return self._with_help_at_the_end(static, now, guest, left, heavy, late)
        if heavy:
            left |= dict.fromkeys(heavy, "it needs two robots, and nobody can help")
            return self.consider(state, left, helped=helped, late=late)
        if not late and guest and words.deadline(self._static, now):
            arrival = words.now(now) + self._delay + DOOR_UNITS
            there = {**static, f"{self._names['away']}({words.here(now)},0)": f"({GUEST},{arrival})"}
            found = self._attempt(there, {**now, **guest}, left)
            if found is not None:
                units = max(words.now(found[0].states[-1]) - arrival, 1)
                return Thought(None, Need(units, "to be done in time", deadline=True), left, proof=found[1])
        if not late:
            return msgspec.structs.replace(self.consider(state, left, helped=helped, late=True), late=True)
        misplaced = {n: "no plan was found" for n in words.things(now) if n not in left}
        return Thought(Course((), (now,)), None, {**left, **misplaced}, late, "unknown")

    def with_helper(self, state: State, aside: Mapping[str, str], at: Cell, arrival: int) -> Course | None:
        """The plan with a guest that does nothing before `arrival`, in units since the run began; within the deadline
        if that is possible."""
        now = problem_state(self._words, state)
        away: dict[str, Value] = {f"{self._names['away']}({self._words.here(now)},0)": f"({GUEST},{arrival})"}
        for static in (self._static, self._loose(now)):
            found = self._attempt({**static, **away}, {**now, **self._stands(GUEST, at)}, aside)
            if found is not None:
                return _course(found[0])
        return None

    # ------------------------------------------------------------ with help at the end
    def _with_help_at_the_end(
        self, static: dict[str, Value], now: State, guest: State, left: dict[str, str], heavy: list[str], late: bool
    ) -> Thought:
        """Heavy things in the last steps alone, and the helper idle before: what comes first is done alone."""
        here, singles = self._words.here(now), len(self.misplaced(now, left)) - len(heavy)
        first = 4 * -(-singles // max(len(self._words.robots(now)), 1))
        for last in LAST_STEPS:
            names = enumerate([*heavy, GUEST], OWN)
            limits = {f"{self._names['late']}({here},{n})": f"({b},{last})" for n, b in names}
            found = self._attempt({**static, **limits}, {**now, **guest}, left, first + last)
            if found is None:
                continue
            plan = found[0]
            alone = max(plan.makespan - last, 0)
            while alone < plan.makespan and not self._helped(plan, alone, heavy):
                alone += 1
            units = self._words.now(plan.states[-1]) - self._words.now(plan.states[alone])
            course = _course(plan)
            states = tuple(without(state, {GUEST}) for state in course.states[: alone + 1])
            cut = Course(course.steps[:alone], states, {t: d for t, d in course.details.items() if t < alone})
            return Thought(cut, Need(units, "to carry " + " and ".join(heavy), True), left, late, "feasible", found[1])
        if not late:
            return msgspec.structs.replace(
                self._with_help_at_the_end(self._loose(now), now, guest, left, heavy, True), late=True
            )
        return Thought(None, None, {**left, **dict.fromkeys(heavy, "no plan was found, not even with help")}, late)

    def _helped(self, plan: Plan, step: int, heavy: list[str]) -> bool:
        """Does the helper act in a step, or is something heavy handled?"""
        ends = {f"{self._words.grip}({n},{end})" for n in heavy for end in (1, 2)}
        for action in plan.steps[step]:
            points = {str(value) for value in plan.details.get((step, action), {}).values()}
            if f"({GUEST}" in action or points & ends:
                return True
        return False

    def _guest(self, now: State) -> State:
        """A robot that might come, at some door; nothing where no door leads to another room."""
        taken = {self._words.cell(now, robot) for robot in self._words.robots(now)}
        for _, cells in sorted(self._words.doors(self._static, now).items()):
            for at in cells:
                if at not in taken:
                    return self._stands(GUEST, at)
        return {}

    def _stands(self, robot: str, at: Cell) -> State:
        return {f"{self._words.place}({robot})": f"({at[0]},{at[1]})", f"{self._words.holds}({robot})": "none"}

    # ------------------------------------------------------------ what is possible at all
    def _loose(self, now: State) -> dict[str, Value]:
        """The constants without a deadline."""
        key = self._words.deadline_key(now)
        return {name: value for name, value in self._static.items() if name != key}

    def _impossible(self, now: State, guest: State, left: Mapping[str, str]) -> dict[str, str]:
        """The things that no plan can bring where they belong, not even with a guest, each with the reason."""
        loose = self._loose(now)
        if not self._hopeless(loose, {**now, **guest}, left):
            return {}
        asked = [n for n in self._words.things(now) if n not in left]
        return {n: self._single(loose, now, left, n) for n in asked if self._single(loose, {**now, **guest}, left, n)}

    def _single(self, static: dict[str, Value], now: State, left: Mapping[str, str], thing: str) -> str:
        """Why this thing, were it the only one, could not be brought where it belongs."""
        others = {n: "" for n in self._words.things(now) if n != thing}
        return self._hopeless(static, now, {**left, **others})

    def misplaced(self, state: State, left: Mapping[str, str]) -> list[str]:
        """Things that are not where they belong, in the order of their names, but for those that are left."""
        now = problem_state(self._words, state)
        bounds = {
            n: self._bound(now, {**left, **{o: "" for o in self._words.things(now) if o != n}})
            for n in self._words.things(now)
        }
        return [n for n, bound in bounds.items() if n not in left and bound]

    def _bound(self, now: State, left: Mapping[str, str]) -> bool:
        found = prospects(self._problem(self._loose(now), now, left))
        return bool(found.hopeless) or found.bound > 0

    def _hopeless(self, static: dict[str, Value], now: State, left: Mapping[str, str]) -> str:
        return prospects(self._problem(static, now, left)).hopeless

    # ------------------------------------------------------------ searching
    def _problem(self, static: Mapping[str, Value], now: State, left: Mapping[str, str]) -> Problem:
        here = self._words.here(now)
        leave, never = self._names["leave"], self._names["never"]
        asides = {f"{leave}({here},{number})": thing for number, thing in enumerate(sorted(left))}
        barred = {f"{never}({here},{number})": way for number, way in enumerate(self.never, OWN)}
        return Problem(self._domain.name, {**static, **asides, **barred}, now)

    def _attempt(
        self, static: Mapping[str, Value], now: State, left: Mapping[str, str], least: int = 0
    ) -> tuple[Plan, str] | None:
        """A plan of the fewest steps, `least` at least, and of these one that costs least, with the proof in words."""
        problem = self._problem(static, now, left)
        planner = Planner(problem)
        if planner.hopeless():
            return None
        bound, left_over = max(planner.lower_bound(), least), CONFLICTS
        for within in range(bound, bound + MORE_STEPS + 1):
            answer = planner.answer(Question("alone", within), conflicts=left_over)
            left_over -= answer.conflicts
            if answer.plan is not None:
                plan, why = cheapest(problem, answer.plan, within) if within else (answer.plan, "")
                said = f"{within} steps; no fewer are possible" if not least else f"{within} steps"
                return (plan, "; ".join(filter(None, [said, why]))) if not self._wrong(problem, plan) else None
            if answer.verdict == "unknown" or planner.hopeless() or left_over <= 0:
                break
        return None

    def _wrong(self, problem: Problem, plan: Plan) -> bool:
        """Does the independent checker refuse it?"""
        states, steps = {self._team: problem.state}, {self._team: plan.steps}
        return bool(check(self._domain, problem.static, states, steps, details={self._team: plan.details}))

    def _thought(self, found: tuple[Plan, str], left: dict[str, str], late: bool) -> Thought:
        return Thought(_course(found[0]), None, left, late, "optimal", found[1])


def _course(plan: Plan) -> Course:
    return Course(plan.steps, tuple(dict(s) for s in plan.states), to_details(plan.details))
