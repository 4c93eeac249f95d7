"""Commands take effect exactly once, over a bad link and across the lives of who carries them out."""

from __future__ import annotations

import random
from collections import Counter
from pathlib import Path

import pytest

from bus.memory_transport import MemoryRouter, Mischief
from bus.messages import Execute, Executed
from bus.node import Node
from tests.bus.conftest import Bus, Threads

COMMANDS = 150


class DeadError(Exception):
    """The worker was killed, before or after it had kept what it did."""


def work(node: Node, dice: random.Random) -> None:
    """Count executions in the journal; die now and then at the worst moments."""
    for turn in node.turns():
        for message in turn.mail:
            assert isinstance(message.body, Execute)
            key = f"step {message.body.step}"
            with node.journal.transaction():
                count = int(node.journal.get(key) or b"0") + 1
                node.journal.put(key, b"%d" % count)
                node.reply(message, Executed("T1", message.body.step, {"count": count}))
                if dice.random() < 0.03:
                    raise DeadError("before the commit")
            if dice.random() < 0.03:
                raise DeadError("after the commit")


def live_again_and_again(bus: Bus, home: Path, lives: list[Node]) -> None:
    dice = random.Random(7)
    while True:
        lives.append(bus.node("worker", outsider=True, home=home))
        with lives[-1] as node:
            try:
                return work(node, dice)
            except DeadError:
                continue


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_every_command_counts_once(seed: int, tmp_path: Path, threads: Threads) -> None:
    router = MemoryRouter(seed)
    bus = Bus(router.connect)
    router.mischief = Mischief("muster/*/mail/*/*", drop=0.1, repeat=0.1, delay=0.2)
    lives: list[Node] = []
    threads.start(live_again_and_again, bus, tmp_path, lives)
    client = bus.node("client", outsider=True)
    asked = {client.request("worker", Execute("T1", step), retry_s=0.02): step for step in range(COMMANDS)}
    replies: Counter[str] = Counter()
    for turn in client.turns():
        for message in turn.mail:
            assert message.body == Executed("T1", asked[message.re], {"count": 1})
            replies[message.re] += 1
        if len(replies) == COMMANDS:
            client.stop()
    lives[-1].stop()
    threads.join()
    assert set(replies.values()) == {1}
    assert len(lives) > 3, "it has died a few times"
    last = bus.node("worker", outsider=True, home=tmp_path)
    assert [int(value) for _, value in last.journal.items("step ")] == [1] * COMMANDS
    bus.close()
