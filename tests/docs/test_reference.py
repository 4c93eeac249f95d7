"""The reference pages in docs/reference are those that the code makes now, and every link in the documentation leads
somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import msgspec
import pytest

from bus import events, faults, messages
from ops.cli import main
from ops.commands import COMMANDS
from ops.reference import pages

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "docs" / "reference"
PAGES = sorted([*(ROOT / "docs").rglob("*.md"), ROOT / "README.md"])


@pytest.mark.parametrize("name", [*pages()])
def test_the_committed_page_is_up_to_date(name: str) -> None:
    assert (REFERENCE / name).read_text(encoding="utf-8") == pages()[name], "run: muster reference"


def test_there_are_no_pages_besides() -> None:
    assert sorted(file.name for file in REFERENCE.iterdir()) == sorted(pages())


def test_nothing_is_left_out() -> None:
    made = pages()
    assert all(f"### {name}\n" in made["messages.md"] for name in ("Envelope", "SkillCall", "Tick", "Inject"))
    assert (
        len(re.findall(r"^### ", made["messages.md"], re.M))
        == sum(isinstance(value, type) and issubclass(value, msgspec.Struct) for value in vars(messages).values()) - 1
    )  # `Body` is nobody's message
    assert all(f"| `{kind}` |" in made["events.md"] for kind in events.KINDS)
    assert all(f"| `{kind} " in made["faults.md"] for kind in faults.KINDS)
    assert all(f"## muster {name}\n" in made["cli.md"] for name in COMMANDS)
    for key in ("teams.NAME.workers[].at", "exchange.delay", "makespan_at_most", "simulated_s", "frame_hz"):
        assert f"| `{key}` |" in made["scenario.md"]


def test_the_command_writes_the_pages(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reference", "-o", str(tmp_path / "new")]) == 0
    assert {file.name: file.read_text(encoding="utf-8") for file in (tmp_path / "new").iterdir()} == pages()
    assert "messages.md" in capsys.readouterr().out


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_leads_somewhere(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if "://" in target:
            continue
        path, _, anchor = target.partition("#")
        file = (page.parent / path) if path else page
        assert file.exists(), f"{target}: there is no {path}"
        if anchor:
            assert anchor in _anchors(file), f"{target}: there is no such heading"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_no_page_speaks_of_one_machine(page: Path) -> None:
    found = re.findall(r"/(?:home|root|work|Users|tmp)/\S*", page.read_text(encoding="utf-8"))
    assert not found


def _anchors(file: Path) -> set[str]:
    titles = re.findall(r"^#+ (.+)$", file.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w\- ]", "", title).strip().lower().replace(" ", "-") for title in titles}


def test_every_cause_has_its_line() -> None:
    """What a diagnosis may name stands in the table of causes and recoveries."""
    text = (ROOT / "docs" / "monitoring.md").read_text(encoding="utf-8")
    programs = [path.read_text(encoding="utf-8") for path in (ROOT / "encodings").glob("*/diagnosis_persons.lp")]
    heads = [head for program in programs for head in re.findall(r"^person\((.*?)\) *:-", program, re.M)]
    causes = {name for head in heads for name in re.findall(r"([a-z_]+)\(", head)}
    assert {"moved", "gone", "set_back"} <= causes
    for cause in ("broken", *causes):
        assert f"| `{cause}(" in text, cause
