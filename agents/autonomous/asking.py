"""Asking for help with what cannot be done alone, and offering it instead when nobody can help."""

from __future__ import annotations

from collections.abc import Callable

from agents.autonomous import helping
from agents.autonomous.helpers import Helpers
from agents.autonomous.mind import Mind
from agents.autonomous.thinking import DOOR_UNITS

AGAIN_UNITS = 3
"""After so many units help that was refused is asked for again."""


class Asking:
    """`go_on` is called when there is something else to do instead."""

    def __init__(self, mind: Mind, helpers: Helpers, go_on: Callable[[], None]) -> None:
        self.mind, self.helpers, self._go_on = mind, helpers, go_on

    def ask(self) -> None:
        """The rest needs help: ask for it; if nobody can, offer it instead; then ask again."""
        mind, now = self.mind, self.mind.memory
        need, help_ = now.need, now.help
        assert need is not None
        match help_.phase:
            case "none":
                self.helpers.call("want", need.units, need.strong, need.about)
            case "refused" if need.deadline or self._nobody_ever():
                reasons = "; ".join(f"{team}: {a.reason}" for team, a in sorted(help_.answers.items()))
                text = f"finds nobody who can help: {reasons or 'there is nobody'}"
                mind.emit("nobody_helps", text, about=need.about)
                mind.keep(alone=True, need=None, course=None, help=helping.give_up(help_), looked=False)
                self._go_on()
            case "refused" if not now.offered:
                self.helpers.call("offer", DOOR_UNITS + mind.delay, False, "")
            case "refused":
                mind.keep(help=helping.give_up(help_), offered=False)
                mind.wait(AGAIN_UNITS)
            case _:
                mind.show(f"waiting for help {need.about}")

    def _nobody_ever(self) -> bool:
        """Was help asked for, and will no answer ever be another one?"""
        now = self.mind.memory
        answers = now.help.answers
        asked = now.help.kind == "want" and set(now.known) <= set(answers)  # who is out of contact may come back
        return asked and not any(answer.later for answer in answers.values())
