"""A team's mind: ``python -m agents.team``. A thin loop that joins the pure core to the bus.

It observes, answers the coordinator's questions, adopts plans, executes them step by step, compares what it senses with
what the plan predicts, and finds out why they differ. Whatever it must not forget is in `agents.memory`, written
before it is told to anybody. It knows its domain's encodings, its own sensors, and messages; nothing else.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

from msgspec.structs import replace

from agents import course, memory, recovery, telling
from agents.memory import Begun, Course, Memory
from agents.questions import Planning, Prospects
from agents.setups import TeamSetup, read
from agents.skills import actions_of
from agents.thinker import Thinker
from bus import messages as m
from bus.messages import Envelope
from bus.node import Node, arguments, open_node
from reasoning import domain as domains

COORDINATOR = "coordinator"


class Team:
    """Reacts to one message at a time. Every request that it answers may come again; every answer is journalled."""

    def __init__(self, node: Node, setup: TeamSetup, thinker: Thinker) -> None:
        self.node, self.setup, self.thinker = node, setup, thinker
        self.domain = domains.load(setup.domain)
        self.memory = memory.load(node.journal)
        self.planning = self._planning()
        self._waiting: dict[str, Callable[[Envelope], None]] = {}
        self._go: Envelope | None = None
        self._enquiry: Envelope | None = None
        self._look = ""
        self._up = False
        self._resume()

    # ------------------------------------------------------------ turns
    def turn(self, mail: tuple[Envelope, ...]) -> None:
        if not self._up:  # not before: only now the time is known
            self._up = True
            telling.up(self.node, "team")
        for envelope in mail:
            if envelope.re:
                react = self._waiting.pop(envelope.re, None)
                if react is not None:
                    react(envelope)
                continue
            match envelope.body:
                case m.Enquire() | m.Ask() | m.Adopt() | m.Go() if envelope.src != COORDINATOR:
                    self.node.refuse(envelope, "not_yours")
                case m.Enquire():
                    self._enquire(envelope)
                case m.Ask():
                    self._ask(envelope, envelope.body)
                case m.Adopt():
                    self._adopt(envelope, envelope.body)
                case m.Go():
                    self._go_on(envelope, envelope.body)
                case _:
                    self.node.reply(envelope, m.Ok())
        self.thinker.deliver()

    def _resume(self) -> None:
        """After a restart: a step that was begun is asked for again under the same id, so it happens once."""
        self._show("observing" if self.memory.course is None else "back at work")
        if self.memory.begun is not None:
            self._send(self.memory.begun)

    def _keep(self, changed: Memory) -> None:
        self.memory = changed
        memory.save(self.node.journal, changed)

    # ------------------------------------------------------------ how do you stand?
    def _enquire(self, envelope: Envelope) -> None:
        """A new epoch begins. A step under way is finished first; then the team looks around and answers."""
        assert isinstance(envelope.body, m.Enquire)
        known, waits = self.memory.epoch, self._enquiry
        if waits is not None and isinstance(waits.body, m.Enquire):
            known = max(known, waits.body.epoch)
        if envelope.body.epoch < known:  # an old one that comes late, or the coordinator has lost its diary
            self.node.reply(envelope, m.Standing(known, self.setup.team, self.memory.step, False, 0))
            return
        self._enquiry = envelope
        if self.memory.begun is None:
            self.thinker.cancel()  # but never a diagnosis: that belongs to the step under way
            self._waiting.pop(self._look, None)  # what an earlier look shows may be from before a step
            self.node.forget(self._look)
            self._look = self._request("world", m.Observe(self.setup.team), self._stand)

    def _stand(self, observed: Envelope) -> None:
        if not isinstance(observed.body, m.Observed) or self._enquiry is None or self.memory.begun is not None:
            return
        enquiry, self._enquiry = self._enquiry, None
        assert isinstance(enquiry.body, m.Enquire)
        epoch = enquiry.body.epoch
        seen = replace(self.memory, epoch=epoch, observed=observed.body.state)
        seen = recovery.still_on_course(self.setup.domain, self.setup.static, seen)
        seen = replace(seen, since=course.beliefs(seen), history=(), open=seen.open)
        self._keep(seen)
        self._begin_planning()
        self._show("taking stock")

        def answer(prospects: Prospects) -> None:
            offer = course.offer(self.memory)
            standing = m.Standing(
                epoch,
                self.setup.team,
                self.memory.step,
                finished=prospects.finished,
                lower_bound=prospects.lower_bound,
                offer=offer,
                inspect=recovery.suspects(self.memory.open),
                gave=self.memory.gave,
                took=self.memory.took,
                hopeless=prospects.hopeless,
                hopeless_with_guest=prospects.hopeless_with_guest,
            )
            self.node.reply(enquiry, standing)

        self.thinker.start(self.planning.prospects, answer)

    # ------------------------------------------------------------ planning
    def _planning(self) -> Planning:
        return Planning(self.setup.domain, self.setup.static, self.setup.conflicts, self.thinker.beat)

    def _begin_planning(self) -> None:
        """What is known of a state stays with it: a thought about the one before may still be on its way."""
        self.planning = self._planning()
        kept, now = self.memory, self.memory.since
        on_course = kept.course if kept.on_course else None
        gone = kept.step - on_course.start if on_course else 0
        self.planning.begin(kept.epoch, now, course.fresh_name(self.domain, kept), on_course, gone)

    def _ask(self, envelope: Envelope, ask: m.Ask) -> None:
        if ask.epoch != self.memory.epoch:
            self.node.reply(envelope, m.Answer(self.memory.epoch, ask.question, "unknown"))
            return
        if self.planning.epoch != ask.epoch:  # restarted since: what was known of the question is searched again
            self._begin_planning()
        q = ask.question
        words = {"alone": "alone", "lend": f"lending by {q.step}", "borrow": f"borrowing from {q.step}"}[q.kind]
        self._show(f"planning: {q.within} steps {words}?")

        def answer(reply: m.Answer) -> None:
            self.node.reply(envelope, reply)
            self._show("waiting for the coordinator")

        planning = self.planning
        self.thinker.start(lambda cancelled: planning.answer(q, cancelled), answer)

    def _adopt(self, envelope: Envelope, adopt: m.Adopt) -> None:
        if adopt.epoch != self.memory.epoch:
            self.node.reply(envelope, m.Adopted(self.memory.epoch, self.setup.team, False, reason="another epoch"))
            return
        if self.planning.epoch != adopt.epoch:
            self._begin_planning()

        self.thinker.cancel()  # a question that is still open has no bearing on the plan that was chosen
        planning = self.planning

        def adopted(found: Course | str) -> None:
            if isinstance(found, str):
                self.node.reply(envelope, m.Adopted(adopt.epoch, self.setup.team, False, reason=found[:2000]))
            else:
                self._follow(envelope, adopt, found, not adopt.plan or planning.leads_to_goal(found))

        self.thinker.start(lambda cancelled: planning.course(adopt, self.setup.team, cancelled), adopted)

    def _follow(self, envelope: Envelope, adopt: m.Adopt, found: Course, to_goal: bool) -> None:
        """A plan that does not lead to the goal, as a given one may not, is followed, but never on course."""
        team, worker = self.setup.team, found.worker
        robot = self.memory.guests.get(worker, f"{team}.{worker}") if found.role == "lend" else found.robot
        at = found.start + found.at if found.at >= 0 else -1
        also = {"alone": "", "lend": f", lending {worker} in step {at}", "borrow": f", borrowing {robot} in step {at}"}
        with self.node.journal.transaction():
            step = max(self.memory.step, found.start)  # others may be further on
            self._keep(replace(self.memory, step=step, course=found, on_course=to_goal, open=(), last=None))
            self.node.reply(
                envelope, m.Adopted(adopt.epoch, team, True, found.makespan, at, worker, robot if worker else "")
            )
            self.node.emit(
                "plan_adopted",
                f"{team} adopts a plan of {found.makespan} steps{also[found.role]}",
                team=team,
                epoch=adopt.epoch,
                start=found.start,
                makespan=found.makespan,
                role=found.role,
            )
        self._show("ready")

    # ------------------------------------------------------------ executing
    def _go_on(self, envelope: Envelope, go: m.Go) -> None:
        again = course.results_again(self.memory, go.step)
        if again is not None:
            self.node.reply(envelope, again)
        elif self.memory.begun is not None:
            self._go = envelope  # asked again after a restart: the step is under way
        elif go.step < self.memory.step or go.epoch != self.memory.epoch:
            reason = f"epoch {self.memory.epoch}, step {self.memory.step} is next"
            self.node.reply(
                envelope, m.StepResult(self.memory.epoch, self.setup.team, go.step, "refused", reason=reason)
            )
        else:
            wanted = (
                recovery.next_inspection(self.domain, self.memory)
                if go.recover
                else course.actions(self.memory, go.step)
            )
            if wanted is None:
                self._idle(envelope, go)
                return
            begun = Begun(go.step, wanted, go.recover)
            self._keep(replace(self.memory, step=go.step, begun=begun))
            self._go = envelope
            self._send(begun)

    def _idle(self, envelope: Envelope, go: m.Go) -> None:
        """Nothing to do in this step: nobody is suspected any more, or the plan is over, with its goal or without."""
        outcome: m.Outcome = "as_planned" if go.recover else "finished" if self.memory.on_course else "refused"
        self._conclude(replace(self.memory, step=go.step + 1), envelope, outcome, reason="its plan is over")

    def _send(self, begun: Begun) -> None:
        """Ask the world; the id is the step's own, so that a repetition after a restart is the same command."""
        team = self.setup.team
        calls = recovery.calls(begun) if begun.recover else course.calls(self.domain, self.memory, begun.step)
        self._show("inspecting" if begun.recover else "executing")
        self._request("world", m.Execute(team, begun.step, calls), self._executed, f"{team}.step.{begun.step}")

    def _executed(self, envelope: Envelope) -> None:
        body, begun, go = envelope.body, self.memory.begun, self._go
        if not isinstance(body, m.Executed) or begun is None or body.step != begun.step:
            return
        if begun.recover:
            self._inspected(body, go)
            return
        differing = course.surprises(self.memory, body.state)
        if differing:
            self._surprised(body, differing, go)
            return
        repaired = [a for a in begun.actions if a.partition("(")[0] in actions_of(self.domain, "repair")]
        changed = course.completed(self.domain, self.setup.team, self.memory, body)
        plan = changed.course
        over = plan is not None and changed.step == plan.start + plan.makespan and changed.on_course
        with self.node.journal.transaction():
            self._conclude(changed, go, "finished" if over else "as_planned")
            for action in repaired:
                robot = action.partition("(")[2].rstrip(")")
                self.node.emit("repair", f"{self.setup.team} has {robot} repaired", team=self.setup.team, robot=robot)
            if over:
                text = f"{self.setup.team} is done after step {body.step}"
                self.node.emit("team_finished", text, team=self.setup.team, step=body.step)

    # ------------------------------------------------------------ monitoring and recovery
    def _surprised(self, body: m.Executed, differing: tuple[str, ...], go: Envelope | None) -> None:
        team = self.setup.team
        changed = replace(course.completed(self.domain, team, self.memory, body), on_course=False)
        plan = self.memory.course
        assert plan is not None
        predicted = plan.states[body.step - plan.start + 1]
        if recovery.only_order(self.memory.observed, predicted, body.state, differing):
            self._conclude(changed, go, "order_changed", differing=differing)
            return
        self.node.emit(
            "discrepancy",
            f"{team} finds {', '.join(differing)} other than planned after step {body.step}",
            team=team,
            step=body.step,
            differing=list(differing),
        )
        self._show("diagnosing")
        details = {(k, a): d for k, by in plan.details.items() for a, d in by.items()}

        def explained(diagnoses: tuple[m.Diagnosis, ...]) -> None:
            causes = [list(d.causes) for d in diagnoses]
            words = " or ".join("{" + ", ".join(c) + "}" for c in causes) or "nothing that it knows of"
            settled = recovery.settle(changed, diagnoses)
            with self.node.journal.transaction():
                self.node.emit("diagnosis", f"{team} explains it by {words}", team=team, step=body.step, causes=causes)
                self._conclude(settled, go, "discrepancy", differing, diagnoses)

        self.thinker.start(
            lambda _: recovery.explain(self.setup.domain, self.setup.static, changed, details), explained
        )

    def _inspected(self, body: m.Executed, go: Envelope | None) -> None:
        changed = recovery.narrowed(course.advanced(self.memory, body), body.findings)
        with self.node.journal.transaction():
            for robot, finding in sorted(body.findings.items()):
                text = f"{self.setup.team} has {robot} inspected: {finding}"
                self.node.emit("inspection", text, team=self.setup.team, robot=robot, finding=finding)
            self._conclude(changed, go, "recovered", diagnoses=changed.open)

    def _conclude(
        self,
        changed: Memory,
        go: Envelope | None,
        outcome: m.Outcome,
        differing: tuple[str, ...] = (),
        diagnoses: tuple[m.Diagnosis, ...] = (),
        reason: str = "",
    ) -> None:
        """Write down how the step ended and tell the coordinator; then attend to what was put off meanwhile."""
        self._go = None
        report = m.StepResult(
            changed.epoch,
            self.setup.team,
            changed.step - 1,
            outcome,
            differing,
            diagnoses,
            recovery.suspects(changed.open),
            reason if outcome == "refused" else "",
        )
        with self.node.journal.transaction():
            self._keep(replace(changed, last=report))
            if go is not None:
                self.node.reply(go, report)
        self._show("finished" if outcome == "finished" else "waiting for the others")
        if self._enquiry is not None:
            self._enquire(self._enquiry)

    # ------------------------------------------------------------ plumbing
    def _request(self, to: str, body: m.Body, react: Callable[[Envelope], None], request_id: str = "") -> str:
        request = self.node.request(to, body, request_id=request_id)
        self._waiting[request] = react
        return request

    def _show(self, doing: str) -> None:
        plan = self.memory.course
        over = plan is not None and self.memory.step >= plan.start + plan.makespan
        self.node.status(
            m.Status(
                "team",
                doing,
                self.memory.step,
                plan.start if plan else 0,
                plan.steps if plan else (),
                epoch=self.memory.epoch,
                finished=over and self.memory.on_course,
            )
        )


def main() -> int:
    config = arguments(sys.argv[1:])
    setup = read(config, TeamSetup)
    with open_node(config) as node, Thinker(node, threaded=config.mode == "realtime") as thinker:
        team = Team(node, setup, thinker)
        for turn in node.turns():
            team.turn(turn.mail)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
