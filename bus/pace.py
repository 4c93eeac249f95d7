"""The world's side of ``realtime`` mode: time runs at `factor` times the wall's pace; mail is handled as it
arrives."""

from __future__ import annotations

from bus import keys
from bus.clock import OnContact, Simulation, wall_s
from bus.codec import encode
from bus.contacts import Contacts
from bus.messages import Tick
from bus.post import Post
from bus.rounds import ROUNDS_PER_LIFE

TICK_S = 0.1
STEP_S = 0.02
"""Wall seconds that one call of `advance` covers when all is well."""
CATCH_UP = 2.0
"""After a hold-up simulated time runs so many times faster, rather than in a leap, until it has caught up."""
OWED_S = 1.0
"""What it is behind more than this, in wall seconds, is given up."""


def run(
    post: Post, simulation: Simulation, contacts: Contacts, start_s: float, factor: float, on_contact: OnContact
) -> None:
    """Keep pace until the node is stopped. Time stands still until all participants have joined or are given up."""
    outbox = post.outbox
    now_s, wall, owed_s = start_s, wall_s(), 0.0
    tick_wall_s = 0.0
    number = post.journal.incarnation * ROUNDS_PER_LIFE
    outbox.now = lambda: now_s
    outbox.is_outsider = contacts.is_outsider
    while not post.stopping.is_set():
        if wall_s() - tick_wall_s >= TICK_S:
            tick_wall_s = wall_s()
            number += 1
            tick = Tick("realtime", number, now_s, factor, contacts.members(number))
            post.transport.put(keys.tick(post.run), encode(outbox.seal(tick)), droppable=True)
            for name, state in contacts.settle(number):
                on_contact(name, state)
        if contacts.expecting() or contacts.entering(number + 1):
            wall = wall_s()  # nobody is to miss the beginning
        else:
            passed_s = wall_s() - wall
            wall = wall_s()
            owed_s = min(owed_s + passed_s, OWED_S)
            step_s = min(owed_s, CATCH_UP * min(passed_s, STEP_S))
            owed_s -= step_s
            now_s += factor * step_s
            simulation.advance(now_s)
        post.expected.clear()  # here time waits for nobody
        while post.given_up:
            contacts.give_up(post.given_up.pop())
        for name in sorted(post.reborn):
            outbox.resend(name)
        post.reborn.clear()
        outbox.send_due()
        mail = post.take(None)
        if mail:
            simulation.handle(mail)
        post.report_refusals()
        post.wait(max(STEP_S - (wall_s() - wall), 0.0005))
