"""Which teams are in contact. Who is out of contact has not failed: the others wait, and it may come back."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from bus.messages import Contact, Envelope, Ok
from bus.node import Node


class Membership:
    """The teams of a run; `live` are those in contact."""

    def __init__(self, teams: Iterable[str], lost: Iterable[str]) -> None:
        self.teams = frozenset(teams)
        self.live = self.teams - set(lost)

    @property
    def lost(self) -> tuple[str, ...]:
        """Teams out of contact, in order."""
        return tuple(sorted(self.teams - self.live))

    def hear(self, news: Contact) -> str:
        """What has changed, in words; empty if nothing has or it is no team."""
        before = self.live
        if news.state in ("lost_contact", "stopped"):
            self.live -= {news.name}
        else:
            self.live |= self.teams & {news.name}
        if self.live < before:
            return f"contact with {news.name} is lost"
        return f"{news.name} is back" if self.live > before else ""

    def take_in(self, node: Node, news: Envelope, note: Callable[..., None]) -> str:
        """Answer news of the world; what has changed as in `hear`. It is told once, so what must outlive this process
        is noted, as `lost`, together with the reply."""
        change = self.hear(news.body) if isinstance(news.body, Contact) else ""
        with node.journal.transaction():
            node.reply(news, Ok())
            if change:
                note(lost=self.lost)
        return change
