"""Thinking each thought once: the same questions come up again and again in tests."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, ClassVar

import pytest

from agents import questions, recovery
from reasoning import exchanges


def remembered(function: Callable[..., Any], store: dict[str, Any]) -> Callable[..., Any]:
    """The same function, each call of which is computed once."""

    @wraps(function)
    def remembering(*args: Any, **options: Any) -> Any:
        key = f"{function.__name__} {args!r} {sorted(options.items())!r}"
        if key not in store:
            store[key] = function(*args, **options)
        return store[key]

    return remembering


class RememberingPlanner:
    """The real planner, one for each problem, with its answers kept."""

    store: ClassVar[dict[str, Any]] = {}
    Real = questions.Planner

    def __init__(self, problem: Any, **_: Any) -> None:
        self._key = repr((problem.domain, sorted(problem.state.items()), problem.guest, problem.guests))
        self._real: Any = self.store.get(self._key) or self.Real(problem)
        self.store[self._key] = self._real

    def answer(self, question: Any, *, conflicts: int | None = None) -> Any:
        key = f"{self._key} {question!r}"
        if key not in self.store:
            self.store[key] = self._real.answer(question, conflicts=conflicts)
        return self.store[key]

    def hopeless(self) -> str:
        return str(self._real.hopeless())

    def lower_bound(self) -> int:
        return int(self._real.lower_bound())


def remember_thoughts(monkeypatch: pytest.MonkeyPatch, store: dict[str, Any]) -> None:
    """Have agents think each thought once in a test session."""
    monkeypatch.setattr(questions, "Planner", RememberingPlanner)
    named = ((questions, "check"), (questions, "predict"), (recovery, "predict"), (recovery, "diagnose"))
    for module, name in (*named, (exchanges, "choose")):
        monkeypatch.setattr(module, name, remembered(getattr(module, name), store))
