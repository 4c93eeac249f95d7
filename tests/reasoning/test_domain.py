"""Finding and reading domains, from a checkout and from a package that carries its encodings."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from reasoning import domain

ROOT = Path(__file__).parents[2]


def test_every_domain_of_the_checkout_loads_and_its_parts_are_found() -> None:
    assert domain.root() == ROOT / "encodings"
    assert "factory" in domain.domains()
    assert domain.CORE not in domain.domains()
    for name in domain.domains():
        loaded = domain.load(name)
        assert loaded is domain.load(loaded)
        assert loaded.name == name
        assert loaded.program("setup").is_file()
        assert loaded.scenarios
        assert all(action["skill"] for action in loaded.data.actions.values())
        assert loaded.data.exchanged in ("", *loaded.data.kinds)


def test_an_installed_package_finds_its_own_encodings(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "reasoning", tmp_path / "reasoning", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "encodings", tmp_path / "reasoning" / "encodings")
    code = "from reasoning import domain; print(domain.root(), domain.load(domain.domains()[0]).name)"
    env = {**os.environ, "PYTHONPATH": str(tmp_path)}
    out = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=env, capture_output=True, text=True, check=True
    )
    assert out.stdout.split() == [str(tmp_path / "reasoning" / "encodings"), domain.domains()[0]]


def test_what_is_missing_is_told_with_what_there_is() -> None:
    with pytest.raises(domain.DomainError, match=r"no domain 'nowhere'; there are: .*factory"):
        domain.load("nowhere")
    with pytest.raises(domain.DomainError, match=r"dance.lp: no such program; .*check.*setup"):
        domain.load("factory").program("dance")
    with pytest.raises(domain.DomainError, match=r"dance.lp: no such program; there are .*match"):
        domain.core_program("dance")
    assert domain.core_program("match").is_file()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('name = "x"', "missing required field"),
        ('name = "y"\nstory = ""\n[time]\n[setup]\n[kinds]\n[actions]', "expected the folder's name 'x'"),
        ('name = "x"\nstory = ""\ncolour = 1\n[time]\n[setup]\n[kinds]\n[actions]', "unknown field `colour`"),
        ('name = "x"\nstory = ""\n[time]\n[setup.team.n]\ntype = "real"\n[kinds]\n[actions]', "setup"),
        ("name = ", "domain.toml"),
    ],
)
def test_a_malformed_description_names_its_file_and_what_is_wrong(tmp_path: Path, text: str, expected: str) -> None:
    folder = tmp_path / "x"
    folder.mkdir()
    (folder / "domain.toml").write_text(text)
    with pytest.raises(domain.DomainError, match=r"domain\.toml") as error:
        domain.read(folder)
    assert expected in str(error.value)
