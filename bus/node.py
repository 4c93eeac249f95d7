"""A process's place on the bus: the only door that the other packages use.

    with open_node(arguments()) as node:
        for turn in node.turns():
            for message in turn.mail:
                ...
                node.reply(message, Ok())

A node belongs to one thread; `stop` and `wake_soon` may be called from any.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple, Self

from msgspec import Raw

from bus import keys
from bus.clock import date_s, wall_s
from bus.codec import encode
from bus.journal import Journal
from bus.messages import Body, Envelope, Impair, Status
from bus.options import Mode, NodeConfig, arguments
from bus.participant import Participant
from bus.post import Post
from bus.signals import stopping
from bus.transport import Transport

__all__ = ["NoAnswer", "Node", "NodeConfig", "Turn", "arguments", "open_node"]


class NoAnswer(Exception):  # noqa: N818 - it reads as what happened
    """Nobody answered a blocking question in time: what became of it is unknown."""


class Turn(NamedTuple):
    """Simulated time in seconds and the mail to handle, in order; the mail may be empty."""

    now_s: float
    mail: tuple[Envelope, ...]


class Node:
    """See `open_node`. Use it in a ``with`` block: a node that is not closed keeps its process from ending."""

    def __init__(self, config: NodeConfig, transport: Transport, journal: Journal) -> None:
        self.config = config
        self.name, self.run = config.name, config.run
        self.mode: Mode = config.mode
        self.transport, self.journal = transport, journal
        self.incarnation = journal.incarnation
        self.post = Post(config.run, config.name, transport, journal)
        self._part = Participant(self.post, config.mode, outsider=config.outsider)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Leave the bus and close the journal; safe to repeat."""
        self.transport.close()
        self.journal.close()

    @property
    def now_s(self) -> float:
        """Simulated seconds; 0 before the world's clock has been heard."""
        return self.post.outbox.now()

    # ------------------------------------------------------------ turns
    def turns(self) -> Iterator[Turn]:
        """The main loop of a process: one turn whenever there is mail, or it is time to wake. Ends after `stop`,
        SIGTERM or SIGINT.

        Who takes part in simulated time gets a turn, perhaps without mail, when it enters.
        Raises `bus.participant.ClockError` when the world's clock is of the other mode.
        """
        with stopping(self.stop):
            for now_s, mail in self._part.turns():
                yield Turn(now_s, mail)

    def stop(self) -> None:
        """End `turns`, from any thread."""
        self.post.stop()

    def wake_at(self, at_s: float) -> None:
        """Have a turn at that simulated time, even without mail."""
        self._part.wake_at(at_s)

    def wake_soon(self) -> None:
        """Have a turn now, even without mail; from any thread."""
        self.post.wake()

    def expect(self, name: str) -> None:
        """In the world: the process `name`, out of contact, was told to go on. Simulated time waits for it to join
        again, no longer than for one that died; without this a fast clock would have run far ahead."""
        self.post.expected.append(name)

    def give_up(self, name: str) -> None:
        """In the world: the process `name` was ended, and nobody will start it again. Nobody waits for it."""
        self.post.given_up.append(name)

    def beat(self, doing: str) -> None:
        """Show a sign of life. Call it at least every 0.5 s of wall time in long work; `turns` does while it
        waits."""
        self.post.beat(doing)

    # ------------------------------------------------------------ mail
    def request(self, to: str, body: Body, *, retry_s: float = 1.0, request_id: str = "") -> str:
        """Send a request and give its id; the reply will be mail whose `re` is that id.

        A command that must happen once even if this process dies and asks again needs a `request_id` of its own,
        the same in both lives; otherwise one is made.

        Until then it is sent again under the same id, after `retry_s` simulated seconds and then more and more
        slowly (up to 8 times that, in ``fast`` mode up to 2 s), and at once when the receiver is seen in a new life.
        """
        return self.post.outbox.request(to, body, retry_s, request_id)

    def forget(self, request_id: str) -> None:
        """Stop repeating a request; its reply will be dropped."""
        self.post.outbox.forget(request_id)

    def reply(self, to: Envelope, body: Body) -> None:
        """Answer a request, once. The reply is journalled, in the transaction under way if there is one, and then
        sent; who asks again gets it again, also from a later life of this process."""
        self.post.reply(to, body)

    def refuse(self, message: Envelope, reason: str) -> None:
        """Count a message that its sender has no business to send, and answer it with `Ok`, so that it is not sent
        again; nothing else comes of it."""
        self.post.refuse(message, reason)

    def ask(self, to: str, body: Body, timeout_s: float, *, retry_s: float = 1.0) -> Body:
        """Request and wait for the reply, for those who do not live in turns, or in the world's turn for a word to
        an outsider. The request is sent again every `retry_s` wall seconds.

        Raises NoAnswer after `timeout_s` wall seconds. Other mail is kept for the next turn.
        """
        post, outbox = self.post, self.post.outbox
        answers: list[Envelope] = []
        request = outbox.seal(body, message_id=outbox.request_id())
        post.catches[to, request.id] = answers.append
        outbox.mail(to, request)
        wall = wall_s()
        end_wall_s, again_wall_s = wall + timeout_s, wall + retry_s
        try:
            while not answers:
                wall = wall_s()
                if wall >= end_wall_s or post.stopping.is_set():
                    raise NoAnswer(f"{to} did not answer {type(body).__name__} within {timeout_s:g} s")
                if wall >= again_wall_s:
                    outbox.again(to, request)
                    again_wall_s = wall + retry_s
                post.wait(min(end_wall_s, again_wall_s) - wall)
        finally:
            del post.catches[to, request.id]
        return answers[0].body

    def impair(self, impair: Impair) -> None:
        """Make this node's own outgoing mail unreliable, as an `Impair` that arrives does."""
        self.post.outbox.impairments.set(impair)

    # ------------------------------------------------------------ streams
    def listen(self, keyexpr: str, handler: Callable[[Envelope], None]) -> None:
        """Have `handler` called, by this thread while it waits, with the envelopes on keys that end in a source."""
        self.post.listen(keyexpr, handler)

    def emit(self, kind: str, text: str, /, **data: object) -> None:
        """Report an event (`bus.events.KINDS`), numbered and journalled, in the transaction under way if there is
        one.

        Raises ValueError for an unknown kind.
        """
        self.post.emit(kind, text, data)

    def status(self, body: Status) -> None:
        """Say what the process is doing; who looks later sees the latest."""
        self.transport.keep(keys.status(self.run, self.name), encode(self.post.outbox.seal(body)))

    def publish(self, key: str, body: Body | Raw) -> None:
        """Put a body, or one that is packed already, on a stream that may drop it."""
        self.transport.put(key, encode(self.post.outbox.seal(body)), droppable=True)


def open_node(config: NodeConfig, transport: Transport | None = None) -> Node:
    """Open the journal and connect to the router (or use `transport`, in tests).

    Raises `bus.transport.TransportError` when there is no router, sqlite3.Error when the journal cannot be used.
    """
    if config.home is not None:
        config.home.mkdir(parents=True, exist_ok=True)
    journal = Journal(config.home / f"{config.name}.sqlite" if config.home is not None else None)
    if config.outsider and config.home is None:
        # It comes and goes without a memory, yet must not ask under the ids of its former lives.
        journal.incarnation = int(date_s() * 1000)
    if transport is None:
        from bus import zenoh_transport  # only now: tests with the in-memory twin do without Zenoh

        transport = zenoh_transport.connect(config.connect, config.identity)
    return Node(config, transport, journal)
