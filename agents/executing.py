"""A team executes its plan step by step, compares what it senses with what was predicted, and finds out why it
differs."""

from __future__ import annotations

from collections.abc import Callable

from msgspec.structs import replace

from agents import course, recovery
from agents.memory import Begun, Memory
from agents.mind import Mind
from agents.skills import actions_of
from bus import messages as m
from bus.messages import Envelope


class Executing:
    """At most one step is under way. `concluded` is called when it is over and reported."""

    def __init__(self, mind: Mind, concluded: Callable[[], None]) -> None:
        self.mind, self._concluded = mind, concluded
        self._go: Envelope | None = None

    def resume(self) -> None:
        """After a restart: a step that was begun is asked for again under the same id, so it happens once."""
        if self.mind.memory.begun is not None:
            self._send(self.mind.memory.begun)

    # ------------------------------------------------------------ executing
    def go_on(self, envelope: Envelope, go: m.Go) -> None:
        again = course.results_again(self.mind.memory, go.step)
        if again is not None:
            self.mind.node.reply(envelope, again)
        elif self.mind.memory.begun is not None:
            self._go = envelope  # asked again after a restart: the step is under way
        elif go.step < self.mind.memory.step or go.epoch != self.mind.memory.epoch:
            reason = f"epoch {self.mind.memory.epoch}, step {self.mind.memory.step} is next"
            self.mind.node.reply(
                envelope, m.StepResult(self.mind.memory.epoch, self.mind.team, go.step, "refused", reason=reason)
            )
        else:
            wanted = (
                recovery.next_inspection(self.mind.domain, self.mind.memory)
                if go.recover
                else course.actions(self.mind.memory, go.step)
            )
            if wanted is None:
                self._idle(envelope, go)
                return
            begun = Begun(go.step, wanted, go.recover)
            self.mind.keep(replace(self.mind.memory, step=go.step, begun=begun))
            self._go = envelope
            self._send(begun)

    def _idle(self, envelope: Envelope, go: m.Go) -> None:
        """Nothing to do in this step: nobody is suspected any more, or the plan is over, with its goal or without."""
        outcome: m.Outcome = "as_planned" if go.recover else "finished" if self.mind.memory.on_course else "refused"
        self._conclude(replace(self.mind.memory, step=go.step + 1), envelope, outcome, reason="its plan is over")

    def _send(self, begun: Begun) -> None:
        """Ask the world; the id is the step's own, so that a repetition after a restart is the same command."""
        team = self.mind.team
        calls = recovery.calls(begun) if begun.recover else course.calls(self.mind.domain, self.mind.memory, begun.step)
        self.mind.show("inspecting" if begun.recover else "executing")
        self.mind.request("world", m.Execute(team, begun.step, calls), self._executed, f"{team}.step.{begun.step}")

    def _executed(self, envelope: Envelope) -> None:
        body, begun, go = envelope.body, self.mind.memory.begun, self._go
        if not isinstance(body, m.Executed) or begun is None or body.step != begun.step:
            return
        if begun.recover:
            self._inspected(body, go)
            return
        differing = course.surprises(self.mind.memory, body.state)
        if differing:
            self._surprised(body, differing, go)
            return
        repaired = [a for a in begun.actions if a.partition("(")[0] in actions_of(self.mind.domain, "repair")]
        changed = course.completed(self.mind.domain, self.mind.team, self.mind.memory, body)
        plan = changed.course
        over = plan is not None and changed.step == plan.start + plan.makespan and changed.on_course
        with self.mind.node.journal.transaction():
            self._conclude(changed, go, "finished" if over else "as_planned")
            for action in repaired:
                robot = action.partition("(")[2].rstrip(")")
                self.mind.node.emit(
                    "repair", f"{self.mind.team} has {robot} repaired", team=self.mind.team, robot=robot
                )
            if over:
                text = f"{self.mind.team} is done after step {body.step}"
                self.mind.node.emit("team_finished", text, team=self.mind.team, step=body.step)

    # ------------------------------------------------------------ monitoring and recovery
    def _surprised(self, body: m.Executed, differing: tuple[str, ...], go: Envelope | None) -> None:
        team = self.mind.team
        changed = replace(course.completed(self.mind.domain, team, self.mind.memory, body), on_course=False)
        plan = self.mind.memory.course
        assert plan is not None
        predicted = plan.states[body.step - plan.start + 1]
        if recovery.only_order(self.mind.memory.observed, predicted, body.state, differing):
            self._conclude(changed, go, "order_changed", differing=differing)
            return
        self.mind.node.emit(
            "discrepancy",
            f"{team} finds {', '.join(differing)} other than planned after step {body.step}",
            team=team,
            step=body.step,
            differing=list(differing),
        )
        self.mind.show("diagnosing")
        details = {(k, a): d for k, by in plan.details.items() for a, d in by.items()}

        def explained(diagnoses: tuple[m.Diagnosis, ...]) -> None:
            causes = [list(d.causes) for d in diagnoses]
            words = " or ".join("{" + ", ".join(c) + "}" for c in causes) or "nothing that it knows of"
            settled = recovery.settle(changed, diagnoses)
            with self.mind.node.journal.transaction():
                self.mind.node.emit(
                    "diagnosis", f"{team} explains it by {words}", team=team, step=body.step, causes=causes
                )
                self._conclude(settled, go, "discrepancy", differing, diagnoses)

        self.mind.thinker.start(
            lambda _: recovery.explain(self.mind.setup.domain, self.mind.setup.static, changed, details), explained
        )

    def _inspected(self, body: m.Executed, go: Envelope | None) -> None:
        changed = recovery.narrowed(course.advanced(self.mind.memory, body), body.findings)
        with self.mind.node.journal.transaction():
            for robot, finding in sorted(body.findings.items()):
                text = f"{self.mind.team} has {robot} inspected: {finding}"
                self.mind.node.emit("inspection", text, team=self.mind.team, robot=robot, finding=finding)
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
            self.mind.team,
            changed.step - 1,
            outcome,
            differing,
            diagnoses,
            recovery.suspects(changed.open),
            reason if outcome == "refused" else "",
        )
        with self.mind.node.journal.transaction():
            self.mind.keep(replace(changed, last=report))
            if go is not None:
                self.mind.node.reply(go, report)
        self.mind.show("finished" if outcome == "finished" else "waiting for the others")
        self._concluded()
