"""The closed vocabulary of disturbances. What is not in this table is refused, never ignored.

Shared by scenario files (``[[fault]]``), the command line (``muster inject``) and the world, which carries
out the physical ones itself and passes the others on to the supervisor or to a process's node.
"""

from __future__ import annotations

from typing import Literal, NamedTuple


class FaultKind(NamedTuple):
    """`on`: what the target names; `args`: optional and required arguments with their meaning."""

    on: Literal["robot", "body", "object", "new", "team", "process", "link"]
    required: tuple[str, ...]
    optional: tuple[str, ...]
    help: str


KINDS: dict[str, FaultKind] = {
    "break": FaultKind("robot", (), (), "the robot achieves nothing from now on, unseen"),
    "move": FaultKind(
        "body",
        (),
        ("x", "y", "to"),
        "a person puts a robot, or what is in a room, on cell x, y; what is on a line on line position to",
    ),
    "bring": FaultKind("new", ("what", "x", "y"), (), "a person puts a thing of that kind on cell x, y of a room"),
    "take": FaultKind("object", (), (), "a person takes a thing out of its room"),
    "set": FaultKind("object", ("attribute", "value"), (), "a person changes a sensed property of an object"),
    "order": FaultKind("team", ("add",), (), "so many more objects enter the team's line"),
    "cancel": FaultKind("team", ("objects",), (), "the last so many objects leave the team's order"),
    "deadline": FaultKind(
        "team", ("units",), (), "the team has until so many units of time after the run's beginning (0: no deadline)"
    ),
    "kill": FaultKind("process", (), (), "SIGKILL; the supervisor restarts it"),
    "pause": FaultKind("process", ("for_s",), (), "SIGSTOP, and SIGCONT after for_s simulated seconds"),
    "restart": FaultKind("process", (), (), "SIGTERM; the supervisor restarts it"),
    "stop": FaultKind("team", (), (), "SIGKILL of the team's process, which is not started again"),
    "drop": FaultKind("link", ("share",), (), "this share of the mail from one process (to another) is lost"),
    "delay": FaultKind("link", ("share", "for_s"), (), "this share of the mail arrives for_s seconds late"),
    "repeat": FaultKind("link", ("share",), (), "this share of the mail arrives twice"),
}
