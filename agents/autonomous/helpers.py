"""The protocol of help as it runs over the bus: what has to be told is told, what is heard is taken in."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from agents.autonomous import hearing, helping
from agents.autonomous.beliefs import without
from agents.autonomous.helping import Help
from agents.autonomous.mind import Mind
from agents.autonomous.willing import Willing, willing
from bus import messages as m
from bus.messages import Envelope


class Helpers:
    """Keeps `memory.help`. `changed` is called when it has changed by what others say."""

    def __init__(self, mind: Mind, changed: Callable[[], None]) -> None:
        self.mind, self._changed = mind, changed
        self._calls: list[tuple[Envelope, m.HelpCall]] = []
        self._later: list[tuple[Envelope, m.HelpSettled]] = []

    @property
    def _peers(self) -> tuple[str, ...]:
        return self.mind.memory.peers or ()

    # ------------------------------------------------------------ telling
    def tell(self) -> None:
        """Have under way what is still to be told, and nothing else."""
        mind, help_ = self.mind, self.mind.memory.help
        told = helping.pending(mind.team, mind.words.here(mind.memory.state), help_)
        for request in mind.under_way(f"{mind.team}.h."):
            if request not in told:
                mind.forget(request)
        for request, (to, body) in told.items():
            mind.request(to, body, partial(self._replied, body), request)

    def call(self, kind: str, units: int, strong: bool, about: str) -> None:
        """Ask all others for help, or offer it."""
        mind = self.mind
        offer = kind == "offer"
        help_ = helping.call(
            mind.team, mind.memory.help, "offer" if offer else "want", units, strong, about, self._peers
        )
        with mind.node.journal.transaction():
            mind.keep(help=help_, offered=offer)
            if offer:
                mind.emit("help_offered", f"offers to help: a robot could be there in {units} units", units=units)
            else:
                text = f"asks all others for help {about}, for {units} units"
                mind.emit("help_wanted", text, units=units, about=about)
        self.tell()

    def take(self, help_: Help) -> None:
        """Something has become of the help that the team itself knows of."""
        self.mind.keep(help=help_)
        self.tell()

    # ------------------------------------------------------------ what is asked
    def called(self, envelope: Envelope, body: m.HelpCall) -> None:
        """Another team calls: it is answered as soon as this one knows what it has to do itself."""
        self._calls.append((envelope, body))
        self.attend()

    def attend(self) -> None:
        """Think about the calls that wait, if that is possible now, and answer."""
        now = self.mind.memory
        if now.resting or now.course is not None or now.help.engaged:
            calls, self._calls = self._calls, []
            for envelope, body in calls:
                self._consider(envelope, body)

    def _consider(self, envelope: Envelope, body: m.HelpCall) -> None:
        mind = self.mind
        now = mind.memory

        def think() -> Willing:
            return willing(mind.words, mind.static, mind.thinking, now, envelope.src, body, mind.delay)

        mind.think(think, partial(self._decide, envelope, body))

    def _decide(self, envelope: Envelope, body: m.HelpCall, found: Willing) -> None:
        mind = self.mind
        help_, answer = hearing.heard_call(mind.team, mind.memory.help, envelope.src, body, found.answer)
        if answer.yes and found.robot:
            help_ = helping.chosen(help_, f"{mind.team}.{found.robot}", found.robot)
        what = ("call for help" if body.kind == "want" else "offer of help") + f" of {envelope.src}"
        says = f"says yes to the {what}" if answer.yes else f"says no: {answer.reason} ({what})"
        with mind.node.journal.transaction():
            mind.keep(help=help_)
            mind.node.reply(envelope, answer)
            mind.emit(
                "help_answered", says,
                of=envelope.src, call=body.kind, yes=answer.yes, units=answer.units, reason=answer.reason,
            )  # fmt: skip
        self.tell()
        self._changed()

    def settled(self, envelope: Envelope, body: m.HelpSettled) -> None:
        """A promise is confirmed or released, or an engagement is off."""
        mind = self.mind
        if self._leaving:
            self._later.append((envelope, body))
            return
        before = mind.memory.help
        help_, reply = hearing.heard_settled(mind.team, before, envelope.src, body)
        with mind.node.journal.transaction():
            mind.keep(help=help_)
            mind.node.reply(envelope, reply)
            if before.phase == "promised" and help_.phase == "none":
                mind.emit("help_released", f"is released by {envelope.src}", by=envelope.src)
            if before.phase == "here" and not help_.engaged:
                self.guest_gone(before.name)
        self._expect(before)
        self.tell()
        self._changed()

    def sent(self, envelope: Envelope, body: m.RobotSent) -> None:
        """A robot has left for this room."""
        mind = self.mind
        help_, reply = hearing.heard_sent(mind.memory.help, envelope.src, body)
        with mind.node.journal.transaction():
            mind.keep(help=help_)
            mind.node.reply(envelope, reply)
        self.tell()
        self._changed()

    def present(self, told: m.Present) -> None:
        """The coordinator says who is in contact."""
        mind = self.mind
        if told.number <= mind.memory.told:
            return
        peers = tuple(team for team in told.teams if team != mind.team)
        known = tuple(sorted({*mind.memory.known, *peers} - {*told.stopped}))
        with mind.node.journal.transaction():
            mind.keep(peers=peers, known=known, told=told.number)
            self._mind_the_lost()
        self.tell()

    # ------------------------------------------------------------ who is out of contact, and what had to wait
    @property
    def _leaving(self) -> bool:
        """Is a robot about to leave? Only the step's end shows where it is then, and what that means for help."""
        begun = self.mind.memory.begun
        return begun is not None and begun.purpose == "leave"

    def catch_up(self) -> None:
        """A step is over: take in what has waited for that."""
        later, self._later = self._later, []
        for envelope, body in later:
            self.settled(envelope, body)
        self._mind_the_lost()
        self.tell()

    def _mind_the_lost(self) -> None:
        """Give up whoever is out of contact, and note since when one has been that has a robot or lends it."""
        mind, now = self.mind, self.mind.memory
        help_, leaving = now.help, {now.help.partner} if self._leaving else set()
        for name in sorted({*help_.asked, help_.partner} - {"", *self._peers} - leaving):
            help_ = hearing.lost(mind.team, help_, name)
        silent_s = -1.0
        if help_.engaged and help_.partner not in self._peers:
            silent_s = now.silent_s if now.silent_s >= 0.0 else mind.node.now_s
        if (help_, silent_s) != (now.help, now.silent_s):
            mind.keep(help=help_, silent_s=silent_s)

    def guest_gone(self, robot: str) -> None:
        """A robot of another team is here no more, or obeys no more: plan without it."""
        text = f"has lost {robot}, which its own team has called home, and plans anew"
        self.mind.emit("helper_gone", text, robot=robot, step=self.mind.memory.step)
        now = self.mind.memory
        left, gone = without(now.state, {robot}), tuple(sorted({*now.gone, robot}))
        self.mind.keep(state=left, gone=gone, course=None, need=None, stopped={}, looked=False, resting=False)

    # ------------------------------------------------------------ what is replied
    def _replied(self, about: m.Body, reply: Envelope) -> None:
        mind, help_, body = self.mind, self.mind.memory.help, reply.body
        if isinstance(body, m.HelpAnswer):
            help_ = hearing.heard_answer(mind.team, help_, reply.src, body)
        elif isinstance(body, m.HelpStands):
            help_ = hearing.heard_stands(help_, reply.src, about, body)
        before = mind.memory.help
        confirmed = before.phase == "confirming" and help_.engaged
        with mind.node.journal.transaction():
            mind.keep(help=help_)
            if confirmed:
                which = "helps" if help_.asker else "is helped by"
                text = f"and {help_.partner} are agreed: {help_.partner} {which} {mind.team}"
                mind.emit("help_confirmed", text, partner=help_.partner, call=help_.kind)
        self._expect(before)
        self.tell()
        self._changed()

    def _expect(self, before: Help) -> None:
        """A robot is going to come: plan with it, unless it is for what cannot begin without it."""
        now = self.mind.memory
        if now.help.phase == "coming" and before.phase != "coming" and not (now.need is not None and now.need.strong):
            self.mind.keep(course=None, need=None, looked=False)
