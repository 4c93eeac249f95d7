"""Who takes part in the world's time: joins, signs of life, and the judgement that somebody is out of contact."""

from __future__ import annotations

import msgspec
from msgspec.structs import replace

from bus import keys
from bus.clock import ContactState, wall_s
from bus.codec import encode
from bus.messages import Done, Envelope, Join, Ok
from bus.post import Post

START_PATIENCE = 2.0
"""At the start a participant has so many times `return_s` to join: it may be one of many that start together."""


class _Member(msgspec.Struct):
    """What is known of one participant. It counts from round `enters` on; `join` is news that `settle` has yet to take
    in; `answered` the id of the last one it took in; who is `given_up` will not be started again."""

    state: str = "expected"
    incarnation: int = 0
    join: Envelope | None = None
    answered: str = ""
    enters: int = -1
    done: Done | None = None
    token: bool = False
    given_up: bool = False
    vanished_wall_s: float = 0.0
    sign_wall_s: float = 0.0
    back_by_wall_s: float = 0.0


class Contacts:
    """Works on the world's post; `settle` is where memberships change, once per round."""

    def __init__(self, post: Post, participants: tuple[str, ...], *, lease_s: float, return_s: float) -> None:
        now = wall_s()
        self._post = post
        self._lease_s, self._return_s = lease_s, return_s
        self._start_wall_s = now
        self._members = {name: _Member(sign_wall_s=now, vanished_wall_s=now) for name in sorted(participants)}
        self.nudged = False
        """Somebody that was done with the latest round wants another one."""
        run = post.run
        post.listen(keys.join(run, "*"), self._on_join)
        post.listen(keys.done(run, "*"), self._on_done)
        post.listen(keys.beat(run, "*"), self._on_beat)
        enqueue = post.inbox.into(self._on_token)
        post.transport.watch(keys.live(run, "*"), lambda key, there: enqueue(key, b"1" if there else b""))

    def members(self, round_number: int) -> tuple[str, ...]:
        """Those that take part in a round."""
        return tuple(
            name for name, m in self._members.items() if m.state == "present" and 0 <= m.enters <= round_number
        )

    def entering(self, round_number: int) -> bool:
        """Whether somebody is to enter after this round."""
        return any(m.state == "present" and m.enters > round_number for m in self._members.values())

    def expecting(self) -> bool:
        """Whether time must wait: somebody has yet to join for the first time, or is bound to come back."""
        return any(
            m.state == "expected" or (m.state == "lost_contact" and m.back_by_wall_s > wall_s())
            for m in self._members.values()
        )

    def expect(self, name: str) -> None:
        """Somebody who was lost is bound to come back: time waits for it as long as for one that died."""
        if name in self._members:
            self._members[name].back_by_wall_s = wall_s() + self._return_s

    def give_up(self, name: str) -> None:
        """Somebody was ended for good: no word from it is to be expected."""
        if name in self._members:
            self._members[name].given_up = True

    def done(self, name: str, round_number: int) -> Done | None:
        """What `name` said at the end of this round, if it has."""
        done = self._members[name].done
        return done if done is not None and done.round == round_number else None

    def gone(self, name: str) -> bool:
        """Whether no word about the present round is to be expected any more: in a new life, or out of contact."""
        member = self._members[name]
        return member.join is not None or self._silent(member)

    def changes(self) -> bool:
        """Whether `settle` has something to do."""
        if self._assembling():
            return False
        return any(m.join is not None or self._lost(m) for m in self._members.values())

    def settle(self, round_number: int) -> list[tuple[str, ContactState]]:
        """Take in who has joined and give up who is silent; what has changed, by name.

        Who joins is left out of the next round and enters in the one after it, so that everybody sees it come anew.
        """
        changed: list[tuple[str, ContactState]] = []
        if self._assembling():
            return changed
        for name, member in self._members.items():
            if member.join is not None:
                if member.state != "present":
                    changed.append((name, "present" if member.state == "expected" else "back"))
                member.state, member.incarnation, member.done = "present", member.join.inc, None
                member.enters, member.answered = round_number + 2, member.join.id
                member.given_up = False
                self._answer(name, member.join)
                member.join = None
            elif (lost := self._lost(member)) is not None:
                member.state, member.enters, member.done = lost, -1, None
                changed.append((name, lost))
        return changed

    def is_outsider(self, name: str) -> bool:
        """Whether `name` takes no part in simulated time, now or at all."""
        member = self._members.get(name)
        return member is None or member.state != "present"

    def _assembling(self) -> bool:
        """Whether somebody has yet to come for the first time: all enter in the same round, whoever started
        faster."""
        return any(m.state == "expected" and m.join is None and not self._silent(m) for m in self._members.values())

    def _lost(self, member: _Member) -> ContactState | None:
        """What is new of somebody who has not joined, if anything is."""
        if member.given_up:
            return "stopped" if member.state != "stopped" else None
        return "lost_contact" if member.state != "lost_contact" and self._silent(member) else None

    def _silent(self, member: _Member) -> bool:
        wall = wall_s()
        if member.given_up:
            return True
        if member.state == "expected":
            return wall - self._start_wall_s > START_PATIENCE * self._return_s
        if not member.token:
            return wall - member.vanished_wall_s > self._return_s
        return wall - member.sign_wall_s > self._lease_s

    def _answer(self, name: str, join: Envelope) -> None:
        outbox = self._post.outbox
        told = replace(outbox.seal(Ok(), re=join.id), round=self._members[name].enters)
        self._post.transport.put(keys.mail(self._post.run, name, self._post.name), encode(told))

    # ------------------------------------------------------------ what is heard
    def _on_join(self, envelope: Envelope) -> None:
        member = self._members.get(envelope.src)
        if member is None or not isinstance(envelope.body, Join) or envelope.inc < member.incarnation:
            return
        member.sign_wall_s = member.vanished_wall_s = wall_s()
        if envelope.id == member.answered and member.state == "present":
            self._answer(envelope.src, envelope)  # the answer was lost
        else:
            member.join = envelope

    def _on_done(self, envelope: Envelope) -> None:
        member = self._members.get(envelope.src)
        if member is None or not isinstance(envelope.body, Done) or envelope.inc != member.incarnation:
            return
        member.sign_wall_s = wall_s()
        if member.done is not None and member.done.round == envelope.body.round:
            self.nudged = self.nudged or 0 <= envelope.body.wake_at_s <= self._post.outbox.now()
        else:
            member.done = envelope.body

    def _on_beat(self, envelope: Envelope) -> None:
        member = self._members.get(envelope.src)
        if member is not None and envelope.inc >= member.incarnation:
            member.sign_wall_s = wall_s()

    def _on_token(self, key: str, payload: bytes) -> None:
        member = self._members.get(keys.last(key))
        if member is not None:
            member.token = bool(payload)
            member.sign_wall_s = member.vanished_wall_s = wall_s()
