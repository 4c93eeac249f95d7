"""News about who is out of contact: in order, whatever the link does."""

from __future__ import annotations

from typing import Any

from bus.messages import Contact
from world.herald import Herald


class Requests:
    """Stands for the world's node: it only notes what is asked."""

    def __init__(self) -> None:
        self.sent: list[tuple[str, Contact]] = []

    def request(self, to: str, body: Any) -> str:
        self.sent.append((to, body))
        return str(len(self.sent))


def states(node: Requests) -> list[tuple[str, str]]:
    return [(body.name, body.state) for _, body in node.sent]


def test_news_about_somebody_waits_for_the_answer_to_the_news_before() -> None:
    node = Requests()
    herald = Herald(node, "coordinator")  # type: ignore[arg-type]
    herald.tell("T1", "lost_contact")
    herald.tell("T1", "back")
    herald.tell("T2", "lost_contact")
    assert states(node) == [("T1", "lost_contact"), ("T2", "lost_contact")]
    herald.told("1")
    assert states(node)[2:] == [("T1", "back")]
    herald.told("3")
    herald.told("2")
    herald.told("17")
    assert len(node.sent) == 3


def test_only_the_latest_of_what_had_to_wait_is_told() -> None:
    node = Requests()
    herald = Herald(node, "coordinator")  # type: ignore[arg-type]
    for state in ("lost_contact", "back", "lost_contact"):
        herald.tell("T1", state)  # type: ignore[arg-type]
    herald.told("1")
    assert states(node) == [("T1", "lost_contact")], "nothing has changed since"
