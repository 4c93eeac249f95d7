"""The search for a shared makespan against brute force over drawn teams with hidden, monotone abilities."""

from __future__ import annotations

from itertools import permutations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoning.sharing import Asking, Known, Ledger, Loan, Shared, advance
from reasoning.values import Question

LONGEST = 14


class Team:
    """A team as the coordinator never sees it: when it can finish, and its exchange steps at every horizon."""

    def __init__(self, alone: int, lend: list[int], borrow: list[int]) -> None:
        self.alone, self.lend, self.borrow = alone, lend, borrow

    def earliest_lend(self, k: int) -> int | None:
        """Earliest step to lend in at horizon k: less with every further step of horizon."""
        return None if k < self.alone else self.lend[min(k - self.alone, len(self.lend) - 1)]

    def latest_borrow(self, k: int) -> int | None:
        step = self.borrow[min(k, len(self.borrow) - 1)]
        return None if step < 0 else step

    def answer(self, q: Question) -> Known:
        if q.kind == "alone":
            return Known(q, "yes" if q.within >= self.alone else "no", max(self.alone, 0))
        if q.kind == "lend":
            step = self.earliest_lend(q.within)
            return Known(q, "yes" if step is not None and step <= q.step else "no", q.within, q.step)
        step = self.latest_borrow(q.within)
        return Known(q, "yes" if step is not None and step >= q.step else "no", q.within, q.step)


@st.composite
def teams(draw: st.DrawFn) -> Team:
    falling = sorted(draw(st.lists(st.integers(0, 8), min_size=1, max_size=6)), reverse=True)
    rising = sorted(draw(st.lists(st.integers(-1, 9), min_size=LONGEST, max_size=LONGEST)))
    return Team(draw(st.integers(0, LONGEST + 2)), falling, [min(b, k) for k, b in enumerate(rising)])


def feasible(all_teams: dict[str, Team], k: int, delay: int, bench: dict[str, int]) -> bool:
    """Brute force: every assignment of suppliers to borrowers is tried."""
    borrowers = [t for t in all_teams.values() if t.alone > k]
    times: list[int | None] = [t.earliest_lend(k) for t in all_teams.values() if t.alone <= k]
    ready = [t + delay for t in times if t is not None and t <= k] + list(bench.values())
    wanted = [t.latest_borrow(k) for t in borrowers]
    if any(w is None for w in wanted) or len(wanted) > len(ready):
        return False
    return any(all(r <= w for r, w in zip(p, wanted, strict=True)) for p in permutations(ready, len(wanted)))


def solve(all_teams: dict[str, Team], delay: int, bench: dict[str, int]) -> tuple[Shared, int]:
    ledgers = {name: Ledger() for name in all_teams}
    asked = 0
    while True:
        step = advance(ledgers, delay, bench, LONGEST - 1)
        if isinstance(step, Shared):
            return step, asked
        assert isinstance(step, Asking)
        assert step.questions, "a search that goes on must ask something"
        for name, question in step.questions.items():
            assert ledgers[name].verdict(question) is None, "asked although the answer follows"
            ledgers[name] = ledgers[name].learn(all_teams[name].answer(question))
            asked += 1


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(
    st.lists(teams(), min_size=1, max_size=4),
    st.integers(1, 3),
    st.dictionaries(st.sampled_from(["T9.w1"]), st.integers(0, 6)),
)
def test_least_horizon_is_that_of_brute_force(drawn: list[Team], delay: int, bench: dict[str, int]) -> None:
    named = {f"T{i}": t for i, t in enumerate(drawn)}
    expected = next((k for k in range(LONGEST) if feasible(named, k, delay, bench)), None)
    shared, _ = solve(named, delay, bench)
    if expected is None:
        assert shared.status in ("unknown", "infeasible")
        return
    assert (shared.status, shared.makespan, shared.lower_bound) == ("optimal", expected, expected)
    assert set(shared.roles) == set(named)
    for loan in shared.loans:
        taken = shared.roles[loan.taker]
        ready = bench[loan.giver] if loan.giver in bench else shared.roles[loan.giver].step + delay
        assert named[loan.taker].answer(taken).verdict == "yes"
        assert ready <= taken.step
    assert len({loan.giver for loan in shared.loans}) == len(shared.loans)


def test_nobody_to_borrow_from_is_infeasible_without_a_single_question() -> None:
    result = advance({"T1": Ledger(can_alone=False, can_borrow=False)}, delay=2)
    assert isinstance(result, Shared)
    assert result.status == "infeasible"
    assert "T1" in result.proof


def test_an_offer_that_stands_is_taken_without_a_question() -> None:
    """A team on course offers the rest of its plan and carries over what its proof refuted."""
    offers = {
        "T1": Ledger().learn(Known(Question("alone", 5), "yes", 5), Known(Question("alone", 4), "no")),
        "T2": Ledger().learn(Known(Question("alone", 4), "yes", 4)),
    }
    result = advance({**offers, "T1": Ledger(5, offers["T1"].answers)}, delay=2)
    assert result == Shared("optimal", 5, 5, {"T1": Question("alone", 5), "T2": Question("alone", 5)}, (), result.proof)


def test_a_budget_that_ran_out_makes_the_result_feasible_not_optimal() -> None:
    q = Question("alone", 3)
    ledger = Ledger(3).learn(Known(q, "unknown"), Known(Question("alone", 4), "yes", 4))
    result = advance({"T1": ledger}, delay=2)
    assert isinstance(result, Shared)
    assert (result.status, result.makespan, result.lower_bound) == ("feasible", 4, 3)


def test_a_robot_on_the_bench_serves_a_borrower() -> None:
    ledger = Ledger(can_alone=False).learn(
        Known(Question("borrow", 6, 3), "yes", 6, 3), Known(Question("borrow", 5, 3), "no")
    )
    result = advance({"T1": ledger}, delay=2, bench={"T2.w3": 3})
    assert isinstance(result, Shared)
    assert result.loans == (Loan("T2.w3", "T1"),)
