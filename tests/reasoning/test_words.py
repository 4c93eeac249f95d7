"""Numbers in sentences."""

from __future__ import annotations

import pytest

from reasoning.words import count


@pytest.mark.parametrize(
    ("number", "noun", "text"),
    [
        (0, "step", "0 steps"),
        (1, "step", "1 step"),
        (2, "body", "2 bodies"),
        (1, "body", "1 body"),
        (3, "day", "3 days"),
    ],
)
def test_a_number_agrees_with_its_noun(number: int, noun: str, text: str) -> None:
    assert count(number, noun) == text
