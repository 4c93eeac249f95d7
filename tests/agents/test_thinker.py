"""Where an agent thinks: the result comes to the main loop, unless nobody wants it any more."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest

from agents.questions import Planning
from agents.thinker import Thinker
from bus.messages import Question
from reasoning.values import Problem
from tests.agents.rooms import DOMAIN, LENDER, STATIC

LIMIT_S = 10.0


class Loop:
    """Stands for the node: it is woken when there is something to deliver."""

    def __init__(self) -> None:
        self.woken = threading.Semaphore(0)
        self.beats: list[str] = []

    def wake_soon(self) -> None:
        self.woken.release()

    def beat(self, doing: str) -> None:
        self.beats.append(doing)

    def wait(self) -> None:
        assert self.woken.acquire(timeout=LIMIT_S)


def thinker(loop: Loop, *, threaded: bool) -> Thinker:
    return Thinker(loop, threaded=threaded)  # type: ignore[arg-type]


def test_without_a_thread_it_thinks_at_once() -> None:
    loop, got = Loop(), list[int]()
    with thinker(loop, threaded=False) as mind:
        mind.start(lambda cancelled: 41 + (not cancelled()), got.append)
        assert got == [42]
        mind.beat()
    assert loop.beats == ["thinking"]


def test_with_a_thread_results_come_in_order_and_to_the_main_loop() -> None:
    loop, got = Loop(), list[tuple[int, threading.Thread]]()
    with thinker(loop, threaded=True) as mind:
        for number in range(3):
            mind.start(lambda _, number=number: number, lambda n: got.append((n, threading.current_thread())))
        for _ in range(3):
            loop.wait()
        assert got == []
        mind.deliver()
        mind.beat()
    assert got == [(number, threading.current_thread()) for number in range(3)]
    assert loop.beats == [], "the main loop shows its own signs of life"


def test_what_was_cancelled_is_not_delivered_and_the_work_is_told() -> None:
    loop, got = Loop(), list[str]()
    begun, told = threading.Event(), list[bool]()

    def work(cancelled: Callable[[], bool]) -> str:
        told.append(cancelled())
        begun.set()
        go_on.wait(LIMIT_S)
        told.append(cancelled())
        return "old"

    go_on = threading.Event()
    with thinker(loop, threaded=True) as mind:
        mind.start(work, got.append)
        mind.start(lambda _: "waiting", got.append)
        assert begun.wait(LIMIT_S)
        mind.cancel()
        go_on.set()
        mind.start(lambda _: "new", got.append)
        loop.wait()
        loop.wait()
        mind.deliver()
    assert (told, got) == ([False, True], ["new"])


def test_a_bug_in_a_thought_surfaces_in_the_main_loop() -> None:
    loop = Loop()

    def bug(_: Callable[[], bool]) -> int:
        raise ZeroDivisionError("a bug")

    with thinker(loop, threaded=True) as mind:
        mind.start(bug, lambda _: None)
        loop.wait()
        with pytest.raises(ZeroDivisionError, match="a bug"):
            mind.deliver()


def test_a_search_that_was_cancelled_does_not_cancel_those_after_it() -> None:
    """The planner and what it has learned outlive the piece of work that they were made for."""
    planning = Planning(1, Problem(DOMAIN, STATIC, LENDER, "w3"))
    asked = list[bool]()

    def cancelled() -> bool:
        asked.append(True)
        return True

    planning.prospects(cancelled)
    assert planning.answer(Question("lend", 4, 0), lambda: False).verdict == "yes"
    planner = planning._planner
    assert planner is not None
    assert not planner._cancelled()
    assert not asked
