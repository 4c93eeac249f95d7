"""The world's side of ``fast`` mode: rounds, and time that advances when a round has left nothing in flight.

In a round, first all participants take their turn and then, when all have said `Done`, the world takes its own. So
whatever the world does to its participants' processes happens while they are all waiting, and has the same effect
on every run.
"""

from __future__ import annotations

from collections import Counter
from math import isfinite

from bus import keys
from bus.clock import OnContact, Simulation, wall_s
from bus.codec import encode
from bus.contacts import Contacts
from bus.messages import Envelope, Tick
from bus.post import BEAT_S, Post

AGAIN_S = 0.5
"""A tick that has not been answered by all is published again after so many wall seconds."""
ROUNDS_PER_LIFE = 1_000_000_000
"""Every life of the world begins with a higher round than any life before it: what is left of that one counts as
earlier."""
Table = dict[str, dict[str, int]]


def run(post: Post, simulation: Simulation, contacts: Contacts, start_s: float, on_contact: OnContact) -> None:
    """Conduct rounds until the node is stopped."""
    rounds = Rounds(post, contacts, start_s)
    outbox = post.outbox
    outbox.now = lambda: rounds.now_s
    outbox.is_outsider = contacts.is_outsider
    while not post.stopping.is_set():
        wakes = rounds.participants_turn()
        mail = rounds.own_mail()
        outbox.send_due()
        if mail:
            simulation.handle(mail)
        for name, state in contacts.settle(outbox.round):
            on_contact(name, state)
        while post.expected:
            contacts.expect(post.expected.pop())
        while post.given_up:
            contacts.give_up(post.given_up.pop())
        if not mail and not rounds.in_flight() and not contacts.entering(outbox.round):
            times = [*wakes, *(t for t in (simulation.next_s(), outbox.next_due_s()) if t is not None)]
            if times and not contacts.expecting():
                rounds.now_s = max(rounds.now_s, min(times))
                outbox.send_due()
                simulation.advance(rounds.now_s)
            else:
                rounds.idle(wanted=bool(times))
        post.report_refusals()


class Rounds:
    """The round that is under way; `now_s` is the simulated time."""

    def __init__(self, post: Post, contacts: Contacts, start_s: float) -> None:
        self.now_s = start_s
        self._post, self._contacts = post, contacts
        self._round = post.journal.incarnation * ROUNDS_PER_LIFE
        self._members: tuple[str, ...] = ()
        self._sent: Table = {}

    def participants_turn(self) -> list[float]:
        """Announce a round and wait for everybody's word; the times at which they want to be woken."""
        post, contacts, outbox = self._post, self._contacts, self._post.outbox
        self._add(keys.WORLD, outbox.in_round)
        self._round += 1
        before, self._members = self._members, contacts.members(self._round)
        table = {to: counts for to, counts in self._sent.items() if to in self._members}
        tick = Tick("fast", self._round, self.now_s, participants=self._members, mail=table)
        outbox.round = self._round
        outbox.in_round.clear()
        self._sent = {}
        contacts.nudged = False
        self._publish(tick)
        again_wall_s = wall_s() + AGAIN_S
        while not post.stopping.is_set():
            missing = [m for m in self._members if contacts.done(m, self._round) is None and not contacts.gone(m)]
            if not missing:
                break
            if wall_s() > again_wall_s:
                self._publish(tick)
                again_wall_s = wall_s() + AGAIN_S
            post.wait(AGAIN_S / 2)
        wakes = []
        for name in self._members:
            if name not in before:
                outbox.resend(name)
            done = contacts.done(name, self._round)
            if done is not None:
                self._add(name, done.sent)
                if done.wake_at_s >= 0.0 and isfinite(done.wake_at_s):
                    wakes.append(done.wake_at_s)
        return wakes

    def own_mail(self) -> tuple[Envelope, ...]:
        """The world's mail of this round and of earlier ones, once all that was announced is there."""
        self._post.await_mail(self._sent.get(self._post.name, {}), self._round)
        return self._post.take(self._round + 1)

    def in_flight(self) -> bool:
        """Whether anybody has sent anything to a participant in this round."""
        self._add(keys.WORLD, self._post.outbox.in_round)
        self._post.outbox.in_round.clear()
        following = self._contacts.members(self._round + 1)
        return any(to in following for to in self._sent)

    def idle(self, wanted: bool) -> None:
        """Nobody wants time to go on, or it is `wanted` but somebody must come first: wait for that, for mail from
        outside, for news about the participants."""
        post, contacts = self._post, self._contacts
        tick = Tick("fast", self._round, self.now_s, participants=self._members)
        again_wall_s = wall_s() + AGAIN_S
        while not (post.stopping.is_set() or post.held or contacts.nudged or contacts.changes()):
            if wanted and not contacts.expecting():
                return
            post.outbox.send_due_on_wall()
            post.wait(BEAT_S)
            if wall_s() > again_wall_s:  # for those who have come since, who must see a tick to join
                self._publish(tick)
                again_wall_s = wall_s() + AGAIN_S

    def _publish(self, tick: Tick) -> None:
        post = self._post
        # Not droppable: everybody waits for it. A frozen receiver cannot hold it up for long, its link's lease ends.
        post.transport.put(keys.tick(post.run), encode(post.outbox.seal(tick)))

    def _add(self, sender: str, counts: Counter[str] | dict[str, int]) -> None:
        for receiver, count in counts.items():
            self._sent.setdefault(receiver, {})[sender] = self._sent.get(receiver, {}).get(sender, 0) + count
