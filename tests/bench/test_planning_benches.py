"""The benchmarks of the planning core, in their smallest size: they run, and what they tell is whole."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from bench import diagnose, housekeeping, plan, share, teams
from bench.measured import Options, summary

QUICK = Options(runs=1, limit_s=1.0, quick=True)


def test_medians_and_ranges_of_seconds_and_the_first_of_what_does_not_change() -> None:
    runs = [{"wall_s": second, "steps": 3} for second in (1.0, 5.0, 2.0)]
    assert summary(runs) == {"wall_s": 2.0, "wall_s_range": [1.0, 5.0], "steps": 3, "runs": 3}


@pytest.mark.slow
def test_plans_beside_the_reference() -> None:
    result = plan.run(QUICK)
    assert [(row["workers"], row["boxes"]) for row in result["teams"]] == [(1, 1), (2, 1)]
    for row in result["teams"]:
        assert row["planner"]["steps"] == row["reference"]["steps"]
        assert row["ratio"] > 0
        assert not row["ratio_is_at_least"]


def test_one_part_alone_tells_no_ratio() -> None:
    result = plan.run(QUICK._replace(only=("planner",)))
    assert "median_ratio" not in result
    assert "reference" not in result["teams"][0]


@pytest.mark.slow
def test_sharing_after_the_carrier_broke_and_drawn_teams() -> None:
    result = share.run(QUICK._replace(only=("broken_carrier", "drawn", "one_program")))
    replanned = result["broken_carrier"]
    assert (replanned["status"], replanned["steps"], replanned["loans"]) == ("optimal", 10, 1)
    assert replanned["first_s"] <= replanned["wall_s"]
    assert result["drawn"]["2"]["proved"] == 1
    assert result["one_program"]["status"] == "unknown"
    assert 0 < result["one_program"]["bound"] <= 26, "no more can be refuted than the optimum of the questions allows"


@pytest.mark.slow
def test_diagnoses_beside_the_enumeration() -> None:
    result = diagnose.run(QUICK._replace(limit_s=0.01))
    small, large = result["small"]["1"], result["large"]
    assert (small["runs"], small["finished"], small["agreed"]) == (1, 0, 0)
    assert (large["runs"], large["truth_found"]) == (2, 2)
    assert large["mean_expected"] <= large["mean_arbitrary_useful"] <= large["mean_arbitrary"]


@pytest.mark.slow
def test_rooms_at_levels_of_geometry_beside_the_reference(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(housekeeping, "SIZES", housekeeping.SIZES[1:3])
    done: list[list[int]] = []
    chosen = QUICK._replace(limit_s=60.0, only=("none", "both", "reference"))
    result = housekeeping.run(chosen, lambda row: done.append(row["size"]))
    assert done == [[1, 3, 12], [1, 1, 4]]
    assert set(result["total_s"]) == {"none", "both", "reference"}
    for row in result["problems"]:
        for section in ("none", "both", "reference"):
            assert (row[section]["status"], row[section]["steps"]) == ("optimal", row["size"][2])
        assert row["both"]["checked"]
        assert row["both"]["replans"] == 0 < row["both"]["queries"]
    monkeypatch.setattr(sys, "argv", ["housekeeping", "--runs", "1", "--limit", "0.01", "--only", "both"])
    housekeeping.main()
    told = capsys.readouterr().out.splitlines()
    assert [line.split()[:4] for line in told if "/" in line][1:] == [["1", "3", "12", ">"], ["1", "1", "4", ">"]]
    assert told[-1] == "both: 0 replans (target 0)"


def test_a_drawn_team_is_the_same_in_every_size_and_every_fourth_has_one_worker() -> None:
    few, many = teams.drawn(3, 4).problems, teams.drawn(3, 9).problems
    assert few == {name: many[name] for name in few}
    workers = [sum(fluent.startswith("effector") for fluent in problem.state) for problem in many.values()]
    assert [count == 1 for count in workers] == [n % 4 == 0 for n in range(9)]


@pytest.mark.slow
def test_tables_and_json_come_from_the_command_line() -> None:
    command = [sys.executable, "-m", "ops.cli", "bench", "plan", "--quick", "--runs", "1", "--only", "planner"]
    table = subprocess.run(command, capture_output=True, text=True, check=True)
    assert table.stdout.startswith("workers boxes")
    assert "planner: workers 2, boxes 1" in table.stderr
    told = subprocess.run([*command, "--json"], capture_output=True, text=True, check=True)
    assert len(json.loads(told.stdout)["teams"]) == 2


@pytest.mark.parametrize("words", [["--runs", "0"], ["--limit", "-1"], ["--only", "nothing"]])
def test_wrong_options_are_refused(words: list[str]) -> None:
    done = subprocess.run([sys.executable, "-m", "bench.plan", *words], capture_output=True, text=True)
    assert done.returncode == 2
    assert "usage: muster bench plan" in done.stderr
