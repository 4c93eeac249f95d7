"""What keeps the house in order and no linter looks at: small files, and nothing but knowledge among the encodings."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGES = ("agents", "bench", "bus", "ops", "reasoning", "world")
LINES, TEST_LINES, ENCODING_LINES = 250, 330, 60


def long(folder: str, suffix: str, most: int) -> dict[str, int]:
    """Files with more lines than `most`; there must be some file to look at."""
    lengths = {str(f.relative_to(ROOT)): len(f.read_text().splitlines()) for f in (ROOT / folder).rglob(f"*{suffix}")}
    assert lengths, folder
    return {file: lines for file, lines in lengths.items() if lines > most}


def test_modules_are_small() -> None:
    """One that grows longer does two things: see which, and make it two."""
    assert not [too for package in PACKAGES for too in long(package, ".py", LINES).items()]
    assert not long("tests", ".py", TEST_LINES)


def test_encodings_are_small() -> None:
    assert not long("encodings", ".lp", ENCODING_LINES)


def test_no_python_among_the_encodings() -> None:
    """With a package of that name on the path the interpreter itself would not start."""
    assert not list((ROOT / "encodings").rglob("*.py"))
