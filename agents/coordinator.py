"""The coordinator: ``python -m agents.coordinator``. It makes the teams share their robots and conducts the steps.

It knows the teams' names and their answers, never their models. Whenever something changes - a discrepancy, an order,
a team lost or back, its own return - a new *epoch* begins: everybody says how it stands, the search for the shared
plan starts from what is known (`reasoning.sharing`), plans are adopted, and steps go on. Between two steps nothing is
ever half done.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Literal

import msgspec

from agents.search import Search
from bus import keys
from bus import messages as m
from bus.messages import Envelope
from bus.node import Node, arguments, open_node
from reasoning.sharing import Asking, Loan, Shared

Phase = Literal["enquiring", "asking", "adopting", "stepping", "recovering", "over"]
REFUSALS = 3
"""After so many plans in a row that a team could not adopt, the search would only find them again."""


class GivenPlan(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A plan to execute first; muster takes over where reality leaves it."""

    teams: dict[str, m.Steps]
    exchanges: tuple[m.Exchange, ...] = ()


class Setup(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``coordinator.json``. `delay` is the transport of a lent robot, in steps."""

    teams: tuple[str, ...]
    delay: int
    plan: GivenPlan | None = None


class Diary(msgspec.Struct, frozen=True):
    """What must survive a restart of the coordinator; the rest it asks the teams for. `lost` are the teams out of
    contact: of that the world tells once. `tried`: the given plan has had its chance."""

    epoch: int = 0
    plans: int = 0
    over: m.RunOver | None = None
    lost: tuple[str, ...] = ()
    tried: bool = False


class Coordinator:
    """Reacts to one message at a time. `_pending` maps teams to the request they have not answered yet."""

    def __init__(self, node: Node, setup: Setup) -> None:
        self.node, self.setup = node, setup
        kept = node.journal.get("diary")
        self.diary = msgspec.msgpack.decode(kept, type=Diary) if kept else Diary()
        self.live = set(setup.teams) - set(self.diary.lost)
        self.cause = ""
        self.exchanges: tuple[m.Exchange, ...] = ()
        self.phase: Phase = "enquiring"
        self.step = 0
        self.search = Search({}, setup.delay, 0)
        self._pending: dict[str, str] = {}
        self._standing: dict[str, m.Standing] = {}
        self._results: dict[str, m.StepResult] = {}
        self._finished: set[str] = set()
        self._adopted: dict[str, m.Adopted] = {}
        self._shared: Shared | None = None
        self._reason = ""
        self._refusals = 0
        self._up = False
        if self.diary.over is not None:
            self._last_word(self.diary.over)
        else:
            self._begin("the coordinator is back" if self.diary.epoch else "start")

    # ------------------------------------------------------------ turns
    def turn(self, mail: tuple[Envelope, ...]) -> None:
        if not self._up:  # not before: only now the time is known
            self._up, back = True, self.node.incarnation > 1
            text = f"{self.node.name} is {'back' if back else 'up'}"
            self.node.emit("started", text, incarnation=self.node.incarnation, role="coordinator", recovered=back)
        for envelope in mail:
            if envelope.re:
                if self._pending.get(envelope.src) == envelope.re:
                    del self._pending[envelope.src]
                    self._answered(envelope)
            elif envelope.src != keys.WORLD:
                self.node.refuse(envelope, "not_yours")
            else:
                self._told(envelope)

    def _told(self, envelope: Envelope) -> None:
        """News from the world: somebody was lost or is back, or an order changed. It is told once, so what must
        outlive this process is written down with the reply."""
        body, live = envelope.body, set(self.live)
        if isinstance(body, m.Contact) and body.name in self.setup.teams:
            self.live = live - {body.name} if body.state == "lost_contact" else live | {body.name}
        with self.node.journal.transaction():
            self.node.reply(envelope, m.Ok())
            if self.live != live:
                self._note(msgspec.structs.replace(self.diary, lost=tuple(sorted(set(self.setup.teams) - self.live))))
        if self.phase == "over":
            return
        if isinstance(body, m.Contact):
            if self.live < live:
                self.node.forget(self._pending.pop(body.name, ""))
                self._changed(f"contact with {body.name} is lost")
            elif self.live > live:
                self._changed(f"{body.name} is back")
        elif isinstance(body, m.Order):
            self._finished.discard(body.team)
            self._changed(f"the order of {body.team} changed")

    def _changed(self, reason: str) -> None:
        """Something is new: at the end of the step under way, or at once, a new epoch begins."""
        self._reason = self._reason or reason
        if self.phase in ("stepping", "recovering"):
            self._step_over()
        else:
            self._begin(reason)

    def _answered(self, envelope: Envelope) -> None:
        body, team = envelope.body, envelope.src
        match body:
            case m.Standing() | m.Answer() | m.Adopted() if body.epoch != self.diary.epoch:
                # One of us has lost its memory: begin where nobody has been.
                self._note(msgspec.structs.replace(self.diary, epoch=max(body.epoch, self.diary.epoch)))
                self._begin(f"{team} was in epoch {body.epoch}")
            case m.Standing() if self.phase == "enquiring":
                self._standing[team] = body
                if not self._pending:
                    self._take_stock()
            case m.Answer() if self.phase == "asking":
                self.search.learn(team, body)
                q = body.question
                self.node.emit(
                    "question",
                    f"{team} {_words(q)}: {body.verdict}",
                    epoch=body.epoch,
                    team=team,
                    role=q.kind,
                    within=q.within,
                    step=q.step,
                    verdict=body.verdict,
                )
                self._search_on()
            case m.Adopted() if self.phase == "adopting":
                self._adopted[team] = body
                if not body.ok:
                    self._refused(f"{team} cannot adopt its plan: {body.reason}")
                elif not self._pending:
                    self._adopt_more()
            case m.StepResult() if self.phase in ("stepping", "recovering"):
                self._results[team] = body
                if body.outcome == "finished":
                    self._finished.add(team)
                self._step_over()
            case _:
                pass

    # ------------------------------------------------------------ an epoch begins
    def _begin(self, reason: str) -> None:
        for request in self._pending.values():
            self.node.forget(request)
        self._pending, self._results, self._adopted = {}, {}, {}
        self._standing = {}
        self._reason, self._shared = "", None
        self._note(msgspec.structs.replace(self.diary, epoch=self.diary.epoch + 1))
        self.phase = "enquiring"
        self.cause = reason
        for team in sorted(self.live):
            self._request(team, m.Enquire(self.diary.epoch))
        self._show("asking how everybody stands")

    def _take_stock(self) -> None:
        self.step = max(s.step for s in self._standing.values())
        self._finished = {team for team, s in self._standing.items() if s.finished}
        if any(s.inspect for s in self._standing.values()):
            self._results = {}
            self._inspect({team for team, s in self._standing.items() if s.inspect})
            return
        if self.diary.plans and self._finished == set(self.setup.teams):
            self._next_step()
            return
        text = f"searching a shared plan from step {self.step} on: {self.cause}"
        self.node.emit("search_started", text, epoch=self.diary.epoch, step=self.step, reason=self.cause)
        if self.setup.plan is not None and not self.diary.tried:
            self._adopt_given(self.setup.plan)
            return
        self.search = Search(self._standing, self.setup.delay, self.step)
        self.phase = "asking"
        self._search_on()

    def _search_on(self) -> None:
        """Ask what the search wants to know next, at most one question a team at a time."""
        before = (self.search.bound, self.search.best)
        result = self.search.next()
        bound, best = self.search.bound, self.search.best
        if (bound, best) != before:
            text = f"no shared plan is shorter than {bound} steps" + (f"; one of {best} is known" if best > 0 else "")
            self.node.emit("bound", text, epoch=self.diary.epoch, lower=bound, best=best)
        if isinstance(result, Asking):
            for team, q in sorted(result.questions.items()):
                if team not in self._pending:
                    self.search.asked += 1
                    self._request(team, m.Ask(self.diary.epoch, m.Question(*q)))
            self._show(f"asking about {result.within} steps")
        elif result.status in ("optimal", "feasible"):
            self._adopt(result)
        elif self.live != set(self.setup.teams):  # whoever is lost may have what the others need
            self._show("no plan without those who are lost; waiting for " + self._missing())
        else:
            self._no_plan("; ".join(filter(None, [result.proof, *self.search.hopeless()])))

    def _no_plan(self, why: str) -> None:
        over = m.RunOver(False, f"no plan: {why}"[:2000], self.step, max(self.diary.plans - 1, 0))
        with self.node.journal.transaction():
            self.node.emit("no_plan", f"no plan: {why}", team="", reason=why)
            self._finish(over)

    # ------------------------------------------------------------ adopting
    def _refused(self, reason: str) -> None:
        """A plan cannot be adopted: search another one, unless that has led nowhere before."""
        if self._shared is None:  # it was the given one
            self._note(msgspec.structs.replace(self.diary, tried=True))
        else:
            self._refusals += 1
        if self._refusals < REFUSALS:
            self._begin(reason)
        else:
            self._no_plan(reason)

    def _adopt(self, shared: Shared) -> None:
        """Lenders first: they say which robot they give, which their borrowers must know."""
        for request in self._pending.values():  # questions whose answers are not needed any more
            self.node.forget(request)
        self._pending = {}
        self._shared, self.phase = shared, "adopting"
        self._adopt_more()

    def _adopt_more(self) -> None:
        shared = self._shared
        if shared is None:
            self._start()
            return
        givers = {loan.giver for loan in shared.loans}
        first = [team for team in shared.roles if team in givers]
        rest = [team for team in shared.roles if team not in givers]
        for group in (first, rest):
            missing = [team for team in sorted(group) if team not in self._adopted]
            if missing:
                for team in missing:
                    self._request(
                        team, m.Adopt(self.diary.epoch, self.step, m.Question(*shared.roles[team]), self._guest(team))
                    )
                return
        self._start()

    def _guest(self, team: str) -> str:
        """The built name of the robot that `team` will take; empty if it takes none."""
        loans = self._shared.loans if self._shared else ()
        giver = next((loan.giver for loan in loans if loan.taker == team), "")
        return self._adopted[giver].robot if giver in self._adopted else giver

    def _adopt_given(self, plan: GivenPlan) -> None:
        self._shared, self.phase = None, "adopting"
        for team in sorted(self.live):
            steps = plan.teams.get(team, ())
            took = next((x for x in plan.exchanges if x.taker == team), None)
            gave = any(x.giver == team for x in plan.exchanges)
            kind: Literal["alone", "lend", "borrow"] = "borrow" if took else "lend" if gave else "alone"
            guest = took.robot if took else ""
            self._request(team, m.Adopt(self.diary.epoch, self.step, m.Question(kind, len(steps)), guest, steps))

    def _start(self) -> None:
        shared = self._shared
        self._refusals = 0
        loans = shared.loans if shared else self._given_loans()
        self.exchanges = tuple(self._exchange(loan) for loan in loans)
        with self.node.journal.transaction():
            self._note(msgspec.structs.replace(self.diary, plans=self.diary.plans + 1, tried=True))
            self._tell_plan(shared.status if shared else "given", shared.proof if shared else "given, not searched")
        self.phase = "stepping"
        self._finished = {team for team, a in self._adopted.items() if not a.makespan and self._standing[team].finished}
        self._next_step()

    def _tell_plan(self, status: str, proof: str) -> None:
        makespan = max((a.makespan for a in self._adopted.values()), default=0)
        self.node.emit(
            "shared_plan",
            f"shared plan of {makespan} steps from step {self.step} on, {status}: {proof}",
            epoch=self.diary.epoch,
            start=self.step,
            makespan=makespan,
            status=status,
            proof=proof,
            questions=self.search.asked,
            exchanges=[msgspec.structs.asdict(x) for x in self.exchanges],
        )
        for x in self.exchanges:
            text = f"{x.giver} lends {x.robot} to {x.taker}: given in step {x.give_step}, taken in step {x.take_step}"
            self.node.emit("exchange", text, **msgspec.structs.asdict(x))

    def _given_loans(self) -> tuple[Loan, ...]:
        plan = self.setup.plan
        within_reach = {team for team, adopted in self._adopted.items() if adopted.at >= 0}
        return tuple(Loan(x.giver, x.taker) for x in plan.exchanges if x.taker in within_reach) if plan else ()

    def _exchange(self, loan: Loan) -> m.Exchange:
        """An exchange as it will happen. A robot from the bench was given before: its giver is part of its name."""
        taken = self._adopted[loan.taker]
        given = self._adopted.get(loan.giver)
        robot = given.robot if given else loan.giver
        giver, _, worker = robot.partition(".")
        return m.Exchange(
            given.worker if given else worker,
            robot,
            loan.giver if given else giver,
            given.at if given else self.search.given.get(robot, -1),
            loan.taker,
            taken.at,
            taken.worker,
        )

    # ------------------------------------------------------------ conducting
    def _next_step(self) -> None:
        self._results = {}
        going = sorted(self.live - self._finished)
        if not going:
            if self.live == set(self.setup.teams):
                replans = max(self.diary.plans - 1, 0)
                self._finish(m.RunOver(True, "every team has reached its goal", self.step, replans))
            else:
                self._show("waiting for " + self._missing())
            return
        for team in going:
            self._request(team, m.Go(self.diary.epoch, self.step))
        self._show("conducting")

    def _inspect(self, teams: set[str]) -> None:
        """One more step for those that must look at a suspect; the others wait."""
        self.phase, self._results = "recovering", {}
        for team in sorted(teams & self.live):
            self._request(team, m.Go(self.diary.epoch, self.step, recover=True))
        self._show("waiting for inspections of " + ", ".join(sorted(teams)))

    def _step_over(self) -> None:
        """When everybody has reported: on with the next step, inspections, or a new epoch."""
        if self._pending:
            return
        results = self._results
        if results:
            self.step += 1
        suspicious = {team for team, r in results.items() if r.inspect} & self.live
        odd = sorted(team for team, r in results.items() if r.outcome not in ("as_planned", "finished"))
        if suspicious:
            self._reason = self._reason or f"{', '.join(odd)} met a discrepancy"
            self._inspect(suspicious)
        elif self.phase == "recovering" or odd or self._reason:
            self._begin(self._reason or f"{', '.join(odd)} left its course")
        else:
            self._next_step()

    # ------------------------------------------------------------ plumbing
    def _finish(self, over: m.RunOver) -> None:
        with self.node.journal.transaction():
            self._note(msgspec.structs.replace(self.diary, over=over))
            self.node.emit("run_over", over.reason, **msgspec.structs.asdict(over))
            self.node.journal.afterwards(lambda: self._last_word(over))

    def _last_word(self, over: m.RunOver) -> None:
        self.phase = "over"
        self.node.request("supervisor", over)
        self._show("done" if over.goal else "no plan")

    def _missing(self) -> str:
        return ", ".join(sorted(set(self.setup.teams) - self.live))

    def _request(self, team: str, body: m.Body) -> None:
        self._pending[team] = self.node.request(team, body)

    def _note(self, diary: Diary) -> None:
        self.diary = diary
        self.node.journal.put("diary", msgspec.msgpack.encode(diary))

    def _show(self, doing: str) -> None:
        makespan = self._shared.makespan if self._shared else self.search.best
        self.node.status(
            m.Status(
                "coordinator",
                doing,
                self.step,
                bound=self.search.bound,
                best=makespan,
                epoch=self.diary.epoch,
                questions=self.search.asked,
                finished=self.phase == "over",
                exchanges=self.exchanges,
            )
        )


def _words(q: m.Question) -> str:
    how = {"alone": "alone", "lend": f"lending by step {q.step}", "borrow": f"borrowing from step {q.step} on"}[q.kind]
    return f"in {q.within} steps {how}"


def main() -> int:
    config = arguments(sys.argv[1:])
    if config.setup is None:
        print("agents.coordinator: --setup FILE is needed: the teams' names and the transport delay", file=sys.stderr)
        return 2
    setup = msgspec.json.decode(Path(config.setup).read_bytes(), type=Setup)
    with open_node(config) as node:
        coordinator = Coordinator(node, setup)
        for turn in node.turns():
            coordinator.turn(turn.mail)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
