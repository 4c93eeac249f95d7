"""The supervisor's node: a thread of its own that owns it, since a node belongs to one thread.

It hears every event, takes requests (`ProcessFault`, `RunOver`), and says what there is to say.
Whatever it hears is handed on at once; the callbacks only post it to the supervisor's thread.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass

from bus import keys
from bus.messages import Beat, Envelope, Inject, Injected, Ok, ProcessFault, RunOver, Status
from bus.node import Node, NodeConfig, open_node
from bus.transport import Transport, TransportError
from ops.processes import COORDINATOR, RECORDER, WORLD

Job = Callable[[Node], None]
AUTHORS: dict[type, str] = {ProcessFault: WORLD, RunOver: COORDINATOR}
"""Who alone may say these things."""


@dataclass(frozen=True)
class Ears:
    """Who is told what. `on_fault` gets a function to call when the fault has taken effect, `on_recorder` the process
    id of the recorder as often as it shows a sign of life."""

    on_event: Callable[[Envelope], None]
    on_fault: Callable[[ProcessFault, Callable[[], None]], None]
    on_over: Callable[[RunOver], None]
    on_end: Callable[[str], None]
    on_recorder: Callable[[int], None]


class Seat:
    """Use as a context manager. `on_end` hears when the bus was opened (empty text) or why it cannot be used."""

    def __init__(self, config: NodeConfig, ears: Ears) -> None:
        self._config, self._ears = config, ears
        self._jobs: queue.SimpleQueue[Job] = queue.SimpleQueue()
        self._node: Node | None = None
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._live, name="seat", daemon=True)

    def __enter__(self) -> Seat:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._closing.set()
        if self._node is not None:
            self._node.stop()
        self._thread.join(20.0)

    @property
    def now_s(self) -> float:
        """Simulated seconds, as far as the world's clock was heard."""
        return self._node.now_s if self._node is not None else 0.0

    def transport(self) -> Transport:
        """The bus, for those who only listen. Raises TransportError while it is not open."""
        if self._node is None:
            raise TransportError("the bus is not open")
        return self._node.transport

    def emit(self, kind: str, text: str, **data: object) -> None:
        """Report an event; from any thread, also before the bus is there."""
        self._do(lambda node: node.emit(kind, text, **data))

    def show(self, doing: str) -> None:
        """What the supervisor is doing; from any thread."""
        self._do(lambda node: node.status(Status("supervisor", doing)))

    def _do(self, job: Job) -> None:
        self._jobs.put(job)
        if self._node is not None:
            self._node.wake_soon()

    def _live(self) -> None:
        try:
            node = open_node(self._config)
        except (TransportError, OSError) as error:
            self._ears.on_end(str(error))
            return
        with node:
            run = node.run
            node.post.listen(keys.event(run, "*"), self._ears.on_event)
            node.post.listen(keys.beat(run, RECORDER), self._beat)
            self._node = node
            self._ears.on_end("")
            node.wake_soon()
            if self._closing.is_set():
                node.stop()
            for turn in node.turns():
                for envelope in turn.mail:
                    self._answer(node, envelope)
                while not self._jobs.empty():
                    self._jobs.get()(node)

    def _beat(self, envelope: Envelope) -> None:
        if isinstance(envelope.body, Beat):
            self._ears.on_recorder(envelope.body.pid)

    def _answer(self, node: Node, envelope: Envelope) -> None:
        body = envelope.body
        if envelope.re:
            return
        if AUTHORS.get(type(body), envelope.src) != envelope.src:
            node.refuse(envelope, "not_yours")
        elif isinstance(body, ProcessFault):
            # Answered when it has taken effect: until then the world's time must not go on.
            self._ears.on_fault(body, lambda: self._do(lambda node: node.reply(envelope, Ok())))
        elif isinstance(body, RunOver):
            node.reply(envelope, Ok())
            self._ears.on_over(body)
        elif isinstance(body, Inject):
            node.reply(envelope, Injected(False, "disturbances are for the world: it passes on what is not its own"))
        else:
            node.reply(envelope, Ok())
