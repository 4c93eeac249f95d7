"""The benchmarks of the planning core, in their smallest size: they run, and what they tell is whole."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from typing import Any

import pytest

from bench import diagnose, housekeeping, plan, share, teams
from bench.measured import Options, summary
from ops.children import environment
from tests.ops.test_running import children_of
from tests.system.whole import MUSTER, alive, until

QUICK = Options(runs=1, limit_s=1.0, quick=True)


def test_medians_and_ranges_of_seconds_and_the_first_of_what_does_not_change() -> None:
    runs = [{"wall_s": second, "steps": 3} for second in (1.0, 5.0, 2.0)]
    assert summary(runs) == {"wall_s": 2.0, "wall_s_range": [1.0, 5.0], "steps": 3, "runs": 3}


@pytest.mark.slow
def test_plans_beside_the_reference() -> None:
    done: list[dict[str, Any]] = []
    result = plan.run(QUICK, done.append)
    assert result["teams"] == done
    assert [(row["workers"], row["boxes"]) for row in done] == [(1, 1), (2, 1)]
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
    done: list[str] = []
    chosen = QUICK._replace(only=("broken_carrier", "drawn", "one_program"))
    result = share.run(chosen, lambda name, _: done.append(name))
    assert done == ["broken carrier", "2 drawn teams", "one program"]
    replanned = result["broken_carrier"]
    assert (replanned["status"], replanned["steps"], replanned["loans"]) == ("optimal", 10, 1)
    assert replanned["first_s"] <= replanned["wall_s"]
    assert result["drawn"]["2"]["proved"] == 1
    assert result["one_program"]["status"] == "unknown"
    assert 0 < result["one_program"]["bound"] <= 26, "no more can be refuted than the optimum of the questions allows"


@pytest.mark.slow
def test_diagnoses_beside_the_enumeration() -> None:
    done: list[str] = []
    result = diagnose.run(QUICK._replace(limit_s=0.01), lambda name, _: done.append(name))
    assert done == ["1", "large"]
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


def interrupted(lines: int, *words: str) -> str:
    """What a benchmark tells that is interrupted after its first line of progress and so many lines of what it tells,
    while it has processes. None of them outlives it."""
    command = [*MUSTER, "bench", *words]
    with subprocess.Popen(
        command, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stderr.readline()
        told = "".join(process.stdout.readline() for _ in range(lines))
        until(lambda: children_of(process.pid), "there are processes")
        own = children_of(process.pid)
        process.send_signal(signal.SIGINT)
        out, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    assert errors.endswith("interrupted\n")
    until(lambda: not any(map(alive, own)), f"the end of {own}")
    return told + out


@pytest.mark.slow
def test_who_interrupts_has_the_rows_till_then_and_no_process_is_left() -> None:
    told = interrupted(0, "housekeeping", "--only", "none", "--json")
    assert json.loads(told) == {"limit_s": 60.0, "problems": []}, "one room is drawn, and none is solved"
    table = interrupted(2, "plan", "--runs", "1", "--jobs", "1", "--only", "planner").splitlines()
    assert table[1].split()[:3] == ["1", "3", "29"]
    table = interrupted(0, "recovery", "40").splitlines()
    assert [line.split()[:2] for line in table[1:]] == [["T1", "1"], ["coordinator", "0"], ["world", "0"], ["T2", "0"]]


def test_what_was_measured_till_an_interrupt_goes_with_it() -> None:
    def stop(name: str, row: dict[str, Any]) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        diagnose.run(QUICK._replace(limit_s=0.01), stop)
    (told,) = stopped.value.args
    assert set(told) == {"limit_s", "small"}
    assert told["small"]["1"]["runs"] == 1


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
