"""What agents tell of their work, for the record and for people who watch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from msgspec.structs import asdict

from agents.adoption import Adoption
from agents.search import Search
from bus.messages import Answer, Exchange, Question, Status
from bus.node import Node
from reasoning.sharing import Shared
from reasoning.words import count, handing


class FirstWord:
    """That a process is up, or back: told in its first turn, not before, since only then the time is known."""

    def __init__(self, node: Node, role: str) -> None:
        self._node, self._role, self._told = node, role, False

    def tell(self) -> bool:
        """Called in every turn; true in the first."""
        if self._told:
            return False
        self._told, node = True, self._node
        back = node.incarnation > 1
        text = f"{node.name} is {'back' if back else 'up'}"
        node.emit("started", text, incarnation=node.incarnation, role=self._role, recovered=back)
        return True


def answered(node: Node, team: str, answer: Answer) -> None:
    q = answer.question
    shared = {"gives": list(q.gives), "takes": list(q.takes)} if q.kind == "share" else {}
    node.emit(
        "question",
        f"{team} {_words(q)}: {answer.verdict}",
        epoch=answer.epoch,
        team=team,
        role=q.kind,
        within=q.within,
        step=q.step,
        verdict=answer.verdict,
        **shared,
    )


def bounds(node: Node, epoch: int, search: Search) -> None:
    known = f"; one of {search.best} is known" if search.best > 0 else ""
    text = f"no shared plan is shorter than {count(search.bound, 'step')}{known}"
    node.emit("bound", text, epoch=epoch, lower=search.bound, best=search.best)


def adopted(node: Node, epoch: int, adoption: Adoption, questions: int, exchanges: Sequence[Exchange]) -> None:
    plan, makespan = adoption.plan, adoption.makespan
    status, proof = (plan.status, plan.proof) if isinstance(plan, Shared) else ("given", "given, not searched")
    node.emit(
        "shared_plan",
        f"shared plan of {count(makespan, 'step')} from step {adoption.start} on, {status}: {proof}",
        epoch=epoch,
        start=adoption.start,
        makespan=makespan,
        status=status,
        proof=proof,
        questions=questions,
        exchanges=[asdict(x) for x in exchanges],
    )
    for x in exchanges:
        text = f"{x.giver} lends {x.robot} to {x.taker}: given in step {x.give_step}, taken in step {x.take_step}"
        node.emit("exchange", text, **asdict(x))


def no_plan(node: Node, why: str, cause: Literal["no_plan", "plan_refused"]) -> None:
    node.emit("no_plan", f"no plan: {why}", team="", reason=why)
    node.emit("needs_person", f"a person is needed: no plan: {why}", cause=cause)


def status(doing: str, step: int, epoch: int, over: bool, search: Search, exchanges: tuple[Exchange, ...]) -> Status:
    """What the coordinator is doing now."""
    return Status(
        "coordinator",
        doing,
        step,
        bound=search.bound,
        best=search.best,
        epoch=epoch,
        questions=search.asked,
        finished=over,
        exchanges=exchanges,
    )


def _words(q: Question) -> str:
    how = {"alone": "alone", "lend": f"lending by step {q.step}", "borrow": f"borrowing from step {q.step} on"}
    return f"in {count(q.within, 'step')} {how.get(q.kind) or handing(q.gives, q.takes)}"
