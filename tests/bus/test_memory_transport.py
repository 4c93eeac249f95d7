"""What the in-memory router does to messages when it is told to misbehave."""

from __future__ import annotations

from bus.memory_transport import MemoryRouter, Mischief


def sent_through(seed: int, mischief: Mischief, count: int = 400) -> list[int]:
    router = MemoryRouter(seed)
    router.mischief = mischief
    got: list[int] = []
    router.connect().subscribe("run/mail/*", lambda _, payload: got.append(int(payload)))
    sender = router.connect()
    for number in range(count):
        sender.put("run/mail/a", b"%d" % number)
    router.flush()
    return got


def test_loss() -> None:
    got = sent_through(1, Mischief(drop=0.25))
    assert got == sorted(got)
    assert 250 < len(got) < 350


def test_repetition() -> None:
    got = sent_through(1, Mischief(repeat=0.25))
    assert set(got) == set(range(400))
    assert 450 < len(got) < 550


def test_delay_reorders_and_loses_nothing() -> None:
    got = sent_through(1, Mischief(delay=0.3))
    assert got != sorted(got)
    assert sorted(got) == list(range(400))
    assert max(abs(place - number) for place, number in enumerate(got)) <= 4


def test_the_dice_are_seeded() -> None:
    mischief = Mischief(drop=0.1, repeat=0.1, delay=0.3)
    assert sent_through(1, mischief) == sent_through(1, mischief)
    assert sent_through(1, mischief) != sent_through(2, mischief)


def test_only_keys_that_match_suffer() -> None:
    assert sent_through(1, Mischief("run/clock/**", drop=1.0)) == list(range(400))
    assert sent_through(1, Mischief("run/**", drop=1.0)) == []
