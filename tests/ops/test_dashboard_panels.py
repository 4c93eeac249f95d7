"""Single lines of the dashboard: who is listed, what is said of a team without a plan, what gives way to what."""

from __future__ import annotations

from rich.text import Text

from bus.messages import Beat, Status
from ops.dashboard.panels import processes, processes_line
from ops.dashboard.teams import plan
from ops.dashboard.text import ends
from tests.ops.pictures import folded
from tests.ops.test_dashboard import event, said


def test_the_router_is_told_of_when_it_is_gone_and_only_then() -> None:
    beat = said("T1", Beat(7))
    started = event("process", "supervisor", name="router", state="started")
    assert "router" not in "".join(line.plain for line in processes(folded([beat, started]), 80, 8))
    assert "1 of 1 present" in processes_line(folded([beat, started]), 80).plain
    died = event("process", "supervisor", name="router", state="died")
    assert "✗ router" in "".join(line.plain for line in processes(folded([beat, started, died]), 80, 8))


def test_a_team_without_a_plan_has_had_one_or_not() -> None:
    for step, words in ((0, " no plan yet"), (7, " no plan now")):
        assert plan(Status("T1", "waiting", step=step), 20, 1)[0].plain.rstrip() == words


def test_keys_have_all_the_place_that_signs_leave() -> None:
    left, right = Text("signs " * 5), Text("keys " * 9)
    assert ends(76, left, right).plain == left.plain + " " + right.plain
    assert ends(70, left, right).plain == left.plain + right.plain[:39] + "…"
    assert ends(70, Text("signs " * 9), right).plain == ("signs " * 9)[:34] + "…" + right.plain[:34] + "…"
