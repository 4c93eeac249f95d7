"""Building a commonsense base: what becomes a fact, hostile lines, and memory that does not grow with the file."""

from __future__ import annotations

import gzip
import json
import tracemalloc
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ops.cli import main
from ops.commonsense import LONGEST_LINE, SHOWN, Built, Relation, build, relations
from ops.tables import InputError
from reasoning.domain import load
from reasoning.solver import models
from tests.ops.terminal import Terminal

WANTED = {
    "AtLocation": Relation("usual", ("start", "end"), ("kitchen", "bedroom")),
    "HasProperty": Relation("care", ("start",), ("fragile",)),
}


def line(relation: str, start: str, end: str, weight: object = 2.0) -> str:
    uri = f"/a/[/r/{relation}/,{start}/,{end}/]"
    return "\t".join([uri, f"/r/{relation}", start, end, json.dumps({"dataset": "/d/test", "weight": weight})])


LINES = [
    line("AtLocation", "/c/en/fork", "/c/en/kitchen"),
    line("AtLocation", "/c/en/fork/n", "/c/en/kitchen/n/wn/artifact"),  # the same
    line("AtLocation", "/c/en/tea_towel", "/c/en/kitchen", 1.0),
    line("AtLocation", "/c/en/fork", "/c/en/kitchen_drawer"),  # no room
    line("AtLocation", "/c/en/pillow", "/c/en/bedroom", 0.5),  # too light
    line("AtLocation", "/c/de/gabel", "/c/en/kitchen"),
    line("AtLocation", "/c/en/3d_printer", "/c/en/kitchen"),  # no constant
    line("HasProperty", "/c/en/glass/n", "/c/en/fragile"),
    line("HasProperty", "/c/en/glass", "/c/en/transparent"),
    line("IsA", "/c/en/fork", "/c/en/cutlery"),
    "not an assertion",
    line("AtLocation", "/c/en/fork", "/c/en/kitchen") + "\tmore",
    line("AtLocation", "/c/en/spoon", "/c/en/kitchen", "heavy"),
    "/a/x\t/r/AtLocation\t/c/en/knife\t/c/en/kitchen\t{",
    "/a/x\tAtLocation\t/c/en/knife\t/c/en/kitchen\t{}",
]
FACTS = ["usual(fork,kitchen).", "usual(tea_towel,kitchen).", "care(glass)."]


def facts_in(path: Path) -> list[str]:
    return [text for text in path.read_text().splitlines() if text and text[0] not in "%#"]


@pytest.mark.parametrize("packed", [False, True])
def test_what_becomes_a_fact(tmp_path: Path, packed: bool) -> None:
    source, target = tmp_path / ("a.csv.gz" if packed else "a.csv"), tmp_path / "base.lp"
    text = "\n".join(LINES).encode()
    source.write_bytes(gzip.compress(text) if packed else text)
    positions: list[int] = []
    built = build(source, target, WANTED, 1.0, positions.append)
    assert facts_in(target) == FACTS
    assert (built.lines, built.facts, built.light, built.skipped) == (15, {"usual": 2, "care": 1}, 1, 5)
    assert [number for number, _, _ in built.malformed] == [11, 12, 13, 14, 15]
    assert built.malformed[0][1:] == ("expected 5 fields between tabs, found 1", "not an assertion")
    assert "weight" in built.malformed[2][1]
    assert positions == sorted(positions)
    assert positions[-1] == source.stat().st_size
    (model,) = models([target])
    assert len(model.atoms) == 3
    assert list(tmp_path.glob("*.part")) == []


def test_only_the_first_malformed_lines_are_kept(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x\n" * 50)
    built = build(tmp_path / "a.csv", tmp_path / "base.lp", WANTED, 1.0)
    assert (built.skipped, len(built.malformed)) == (50, SHOWN)


def test_a_line_without_end_is_one_malformed_line(tmp_path: Path) -> None:
    good = line("AtLocation", "/c/en/fork", "/c/en/kitchen")
    (tmp_path / "a.csv").write_text(f"{'x' * (3 * LONGEST_LINE)}\n{good}\n{'y' * (LONGEST_LINE + 1)}")
    built = build(tmp_path / "a.csv", tmp_path / "base.lp", WANTED, 1.0)
    assert (built.lines, built.skipped, built.facts) == (3, 2, {"usual": 1})
    assert all(len(text) <= 80 for _, _, text in built.malformed)


HOSTILE = st.one_of(
    st.binary(max_size=60),
    st.lists(st.text(max_size=12), min_size=4, max_size=6).map(lambda parts: "\t".join(parts).encode()),
    st.tuples(st.sampled_from(["AtLocation", "HasProperty"]), st.text(max_size=12), st.text(max_size=12)).map(
        lambda t: line(t[0], f"/c/en/{t[1]}", f"/c/en/{t[2]}").encode()
    ),
    st.sampled_from(["1e999", "NaN", "[]", '{"weight": null}', '{"weight": {}}', "9" * 400]).map(
        lambda text: f"/a/x\t/r/AtLocation\t/c/en/fork\t/c/en/kitchen\t{text}".encode()
    ),
    st.text(max_size=12).map(lambda word: line("AtLocation", f"/c/en/{word}", "/c/en/kitchen").encode()),
)


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(hostile=st.lists(HOSTILE, max_size=8))
def test_hostile_lines_never_become_anything_but_facts(
    hostile: list[bytes], tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("hostile")
    good = line("AtLocation", "/c/en/fork", "/c/en/kitchen").encode()
    (folder / "a.csv").write_bytes(b"\n".join([*hostile, good]))
    built = build(folder / "a.csv", folder / "base.lp", WANTED, 1.0)
    assert "usual(fork,kitchen)." in facts_in(folder / "base.lp")
    (model,) = models([folder / "base.lp"])  # it parses, without a message
    assert {atom.name for atom in model.atoms} <= {"usual", "care"}
    assert len(model.atoms) == sum(built.facts.values())
    assert built.skipped <= built.lines


@pytest.mark.slow
def test_memory_does_not_grow_with_the_file(tmp_path: Path) -> None:
    def peak(lines: int) -> int:
        source = tmp_path / "a.csv.gz"
        with gzip.open(source, "wt") as file:
            for number in range(lines):
                file.write(line("AtLocation", f"/c/en/thing_{number % 500}", "/c/en/kitchen") + "\n")
                file.write("broken\n")
        tracemalloc.start()
        build(source, tmp_path / "base.lp", WANTED, 1.0)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    peak(10)
    small, large = peak(1_000), peak(12_000)
    assert large < 1.2 * small + 100_000


def test_a_file_that_ends_too_early_leaves_nothing_behind(tmp_path: Path) -> None:
    whole = gzip.compress("\n".join(LINES * 500).encode())
    (tmp_path / "a.csv.gz").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "base.lp").write_text("% as it was\n")
    with pytest.raises(InputError, match=r"a\.csv\.gz: cannot be made"):
        build(tmp_path / "a.csv.gz", tmp_path / "base.lp", WANTED, 1.0)
    assert (tmp_path / "base.lp").read_text() == "% as it was\n"
    assert [file.name for file in tmp_path.glob("*.part")] == []


def test_the_command_builds_what_its_domain_wants(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, target = tmp_path / "a.csv", tmp_path / "base.lp"
    source.write_text("\n".join(LINES))
    assert main(["commonsense", "build", str(source), "-o", str(target)]) == 0
    assert facts_in(target) == FACTS
    told = capsys.readouterr().out
    assert "1 care, 2 usual, of 15 lines; 1 weighed too little" in told
    assert "5 malformed lines skipped:\n  line 11: expected 5 fields" in told
    assert main(["commonsense", "build", str(source), "--threshold", "0.5", "-o", str(target), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["facts"], told["light"], told["skipped"]) == ({"usual": 3, "care": 1}, 0, 5)
    assert "usual(pillow,bedroom)." in facts_in(target)


def test_what_cannot_be_built_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "a.csv"
    assert main(["commonsense", "build", str(source), "-o", str(tmp_path / "b.lp")]) == 2
    assert "there is no such file" in capsys.readouterr().err
    source.write_text("")
    assert main(["commonsense", "build", str(source), "-o", str(tmp_path / "none" / "b.lp")]) == 2
    assert "cannot be made" in capsys.readouterr().err
    with pytest.raises(InputError, match="has no commonsense base"):
        relations(load("factory"))
    with pytest.raises(SystemExit):
        main(["commonsense", "build", str(source), "--threshold", "nan", "-o", "b.lp"])


@pytest.mark.slow
def test_a_bar_on_a_terminal(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("\n".join(LINES * 8_000))
    words = ["commonsense", "build", str(tmp_path / "a.csv"), "-o", str(tmp_path / "b.lp")]
    terminal = Terminal(f"import sys; from ops.cli import main; sys.exit(main({words!r}))", 100, 30)
    try:
        assert terminal.until(lambda: b"weighed too little" in terminal.seen, 60.0), terminal.seen[-2000:]
        assert b"reading" in terminal.seen
    finally:
        terminal.close()


def test_an_empty_file_is_an_empty_base(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("")
    assert build(tmp_path / "a.csv", tmp_path / "base.lp", WANTED, 1.0) == Built()
    (model,) = models([tmp_path / "base.lp"])
    assert model.atoms == ()
