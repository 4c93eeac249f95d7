"""A team answers the coordinator: how it stands, what it could do, and that it adopts a plan."""

from __future__ import annotations

from msgspec.structs import replace

from agents import course, recovery
from agents.memory import Course
from agents.mind import Mind
from agents.questions import Planning, Prospects
from bus import messages as m
from bus.messages import Envelope
from reasoning.words import count


class Answering:
    """Every question may come again, and be withdrawn by the next enquiry."""

    def __init__(self, mind: Mind) -> None:
        self.mind = mind
        self.planning = self._planning()
        self._enquiry: tuple[Envelope, m.Enquire] | None = None
        self._look = ""

    # ------------------------------------------------------------ how do you stand?
    def enquire(self, envelope: Envelope, enquire: m.Enquire) -> None:
        """A new epoch begins. A step under way is finished first; then the team looks around and answers."""
        known = max(self.mind.memory.epoch, self._enquiry[1].epoch if self._enquiry is not None else 0)
        if enquire.epoch < known:  # an old one that comes late, or the coordinator has lost its diary
            self.mind.node.reply(envelope, m.Standing(known, self.mind.team, self.mind.memory.step, False, 0))
            return
        self._enquiry = envelope, enquire
        self.attend()

    def attend(self) -> None:
        """Look around for the enquiry that waits, if there is one, unless a step is under way."""
        if self._enquiry is not None and self.mind.memory.begun is None:
            self.mind.thinker.cancel()  # but never a diagnosis: that belongs to the step under way
            self.mind.forget(self._look)  # what an earlier look shows may be from before a step
            self._look = self.mind.request("world", m.Observe(self.mind.team), self._stand)

    def _stand(self, observed: Envelope) -> None:
        if not isinstance(observed.body, m.Observed) or self._enquiry is None or self.mind.memory.begun is not None:
            return
        (enquiry, enquire), self._enquiry = self._enquiry, None
        epoch = enquire.epoch
        seen = replace(self.mind.memory, epoch=epoch, observed=observed.body.state)
        seen = recovery.still_on_course(self.mind.setup.domain, self.mind.setup.static, seen)
        seen = replace(seen, since=course.beliefs(seen), history=(), open=seen.open)
        self.mind.keep(seen)
        self._begin_planning()
        self.mind.show("taking stock")

        def answer(prospects: Prospects) -> None:
            offer = course.offer(self.mind.memory)
            standing = m.Standing(
                epoch,
                self.mind.team,
                self.mind.memory.step,
                finished=prospects.finished,
                lower_bound=prospects.lower_bound,
                offer=offer,
                inspect=recovery.suspects(self.mind.memory.open),
                gave=self.mind.memory.gave,
                took=self.mind.memory.took,
                hopeless=prospects.hopeless,
                hopeless_with_guest=prospects.hopeless_with_guest,
            )
            self.mind.node.reply(enquiry, standing)

        self.mind.thinker.start(self.planning.prospects, answer)

    # ------------------------------------------------------------ planning
    def _planning(self) -> Planning:
        setup = self.mind.setup
        return Planning(setup.domain, setup.static, setup.conflicts, self.mind.thinker.beat)

    def _begin_planning(self) -> None:
        """What is known of a state stays with it: a thought about the one before may still be on its way."""
        self.planning = self._planning()
        kept, now = self.mind.memory, self.mind.memory.since
        on_course = kept.course if kept.on_course else None
        gone = kept.step - on_course.start if on_course else 0
        self.planning.begin(kept.epoch, now, course.fresh_name(self.mind.domain, kept), on_course, gone)

    def ask(self, envelope: Envelope, ask: m.Ask) -> None:
        if ask.epoch != self.mind.memory.epoch:
            self.mind.node.reply(envelope, m.Answer(self.mind.memory.epoch, ask.question, "unknown"))
            return
        if self.planning.epoch != ask.epoch:  # restarted since: what was known of the question is searched again
            self._begin_planning()
        q = ask.question
        words = {"alone": "alone", "lend": f"lending by {q.step}", "borrow": f"borrowing from {q.step}"}[q.kind]
        self.mind.show(f"planning: {count(q.within, 'step')} {words}?")

        def answer(reply: m.Answer) -> None:
            self.mind.node.reply(envelope, reply)
            self.mind.show("waiting for the coordinator")

        planning = self.planning
        self.mind.thinker.start(lambda cancelled: planning.answer(q, cancelled), answer)

    def adopt(self, envelope: Envelope, adopt: m.Adopt) -> None:
        if adopt.epoch != self.mind.memory.epoch:
            self.mind.node.reply(
                envelope, m.Adopted(self.mind.memory.epoch, self.mind.team, False, reason="another epoch")
            )
            return
        if self.planning.epoch != adopt.epoch:
            self._begin_planning()

        self.mind.thinker.cancel()  # a question that is still open has no bearing on the plan that was chosen
        planning = self.planning

        def adopted(found: Course | str) -> None:
            if isinstance(found, str):
                self.mind.node.reply(envelope, m.Adopted(adopt.epoch, self.mind.team, False, reason=found[:2000]))
            else:
                self._follow(envelope, adopt, found, not adopt.plan or planning.leads_to_goal(found))

        self.mind.thinker.start(lambda cancelled: planning.course(adopt, self.mind.team, cancelled), adopted)

    def _follow(self, envelope: Envelope, adopt: m.Adopt, found: Course, to_goal: bool) -> None:
        """A plan that does not lead to the goal, as a given one may not, is followed, but never on course."""
        team, worker = self.mind.team, found.worker
        robot = self.mind.memory.guests.get(worker, f"{team}.{worker}") if found.role == "lend" else found.robot
        at = found.start + found.at if found.at >= 0 else -1
        also = {"alone": "", "lend": f", lending {worker} in step {at}", "borrow": f", borrowing {robot} in step {at}"}
        with self.mind.node.journal.transaction():
            step = max(self.mind.memory.step, found.start)  # others may be further on
            self.mind.keep(replace(self.mind.memory, step=step, course=found, on_course=to_goal, open=(), last=None))
            self.mind.node.reply(
                envelope, m.Adopted(adopt.epoch, team, True, found.makespan, at, worker, robot if worker else "")
            )
            self.mind.node.emit(
                "plan_adopted",
                f"{team} adopts a plan of {count(found.makespan, 'step')}{also[found.role]}",
                team=team,
                epoch=adopt.epoch,
                start=found.start,
                makespan=found.makespan,
                role=found.role,
            )
        self.mind.show("ready")
