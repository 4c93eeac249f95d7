"""A team answers the coordinator: how it stands, what it could do, and that it adopts a plan."""

from __future__ import annotations

from msgspec.structs import replace

from agents import course, guests, recovery
from agents.memory import Course
from agents.mind import Mind
from agents.questions import Planning, Prospects
from bus import messages as m
from bus.messages import Envelope
from reasoning.words import count, handing


class Answering:
    """Every question may come again, and be withdrawn by the next enquiry."""

    def __init__(self, mind: Mind) -> None:
        self.mind = mind
        self.planning: Planning | None = None
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
        setup = self.mind.setup
        seen = recovery.still_on_course(self.mind.domain, setup.static, setup.guests, seen)
        seen = replace(seen, since=course.beliefs(seen), history=(), open=seen.open)
        self.mind.keep(seen)
        planning = self._begin_planning()
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
                stock=dict(prospects.stock),
            )
            self.mind.node.reply(enquiry, standing)

        self.mind.thinker.start(planning.prospects, answer)

    # ------------------------------------------------------------ planning
    def _begin_planning(self) -> Planning:
        """What is known of a state stays with it: a thought about the one before may still be on its way."""
        kept, setup = self.mind.memory, self.mind.setup
        problem = guests.problem(self.mind.domain, setup.static, setup.guests, kept, kept.since)
        self.planning = Planning(kept.epoch, problem, setup.conflicts, self.mind.thinker.beat)
        if kept.on_course and kept.course is not None:
            self.planning.keep(course.rest(kept.course, kept.step - kept.course.start))
        return self.planning

    def _planning(self, epoch: int) -> Planning:
        """What is known in this epoch; after a restart it is searched again."""
        same = self.planning is not None and self.planning.epoch == epoch
        return self.planning if self.planning is not None and same else self._begin_planning()

    def ask(self, envelope: Envelope, ask: m.Ask) -> None:
        if ask.epoch != self.mind.memory.epoch:
            self.mind.node.reply(envelope, m.Answer(self.mind.memory.epoch, ask.question, "unknown"))
            return
        planning = self._planning(ask.epoch)
        q = ask.question
        published = {"alone": "alone", "lend": f"lending by {q.step}", "borrow": f"borrowing from {q.step}"}
        words = published.get(q.kind) or handing(q.gives, q.takes)
        self.mind.show(f"planning: {count(q.within, 'step')} {words}?")

        def answer(reply: m.Answer) -> None:
            self.mind.node.reply(envelope, reply)
            self.mind.show("waiting for the coordinator")

        self.mind.thinker.start(lambda cancelled: planning.answer(q, cancelled), answer)

    def adopt(self, envelope: Envelope, adopt: m.Adopt) -> None:
        if self._elsewhere(envelope, adopt.epoch):
            return
        planning = self._planning(adopt.epoch)
        self.mind.thinker.cancel()  # a question that is still open has no bearing on the plan that was chosen

        def adopted(found: Course | str) -> None:
            if isinstance(found, str):
                self.mind.node.reply(envelope, m.Adopted(adopt.epoch, self.mind.team, False, reason=found[:2000]))
            else:
                self._follow(envelope, adopt, found, not adopt.plan or planning.leads_to_goal(found))

        self.mind.thinker.start(lambda cancelled: planning.course(adopt, self.mind.team, cancelled), adopted)

    def _elsewhere(self, envelope: Envelope, epoch: int) -> bool:
        """Is the team in another epoch? Then it says so."""
        now = self.mind.memory.epoch
        if epoch != now:
            self.mind.node.reply(envelope, m.Adopted(now, self.mind.team, False, reason="another epoch"))
        return epoch != now

    def _follow(self, envelope: Envelope, adopt: m.Adopt, found: Course, to_goal: bool) -> None:
        """A plan that does not lead to the goal, as a given one may not, is followed, but never on course."""
        team = self.mind.team
        with self.mind.node.journal.transaction():
            step = max(self.mind.memory.step, found.start)  # others may be further on
            self.mind.keep(replace(self.mind.memory, step=step, course=found, on_course=to_goal, open=(), last=None))
            told = course.adopted(team, self.mind.memory)
            self.mind.node.reply(envelope, told)
            words = course.exchanges(told)
            self.mind.node.emit(
                "plan_adopted",
                f"{team} adopts a plan of {count(found.makespan, 'step')}{words}",
                team=team,
                epoch=adopt.epoch,
                start=found.start,
                makespan=found.makespan,
                role=found.role,
            )
        self.mind.show("ready")

    def welcome(self, envelope: Envelope, welcome: m.Welcome) -> None:
        """Now it is known which robots come."""
        plan = self.mind.memory.course
        if self._elsewhere(envelope, welcome.epoch) or plan is None:
            return
        took = tuple(replace(hand, robot=welcome.robots.get(hand.name, hand.robot)) for hand in plan.took)
        with self.mind.node.journal.transaction():
            self.mind.keep(replace(self.mind.memory, course=replace(plan, took=took)))
            self.mind.node.reply(envelope, course.adopted(self.mind.team, self.mind.memory))
