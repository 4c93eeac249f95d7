"""Whether a rigid body, such as what two robots carry together, gets from one pose to another, and how.

"yes" comes with a path. "no" is proved: by the start or the goal that is not free, or by a disc of the body that alone
has no way. "undecided" means that ompl found nothing within its budget; planners take it for no, and it is counted.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import weakref
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from types import TracebackType
from typing import IO, Literal

from reasoning.motion.layout import Layout
from reasoning.motion.oracle import Oracle
from reasoning.motion.rigid import Body, Pose, Surroundings, extent, placed, turning

Verdict = Literal["yes", "no", "undecided"]
BUDGET = 20_000
"""How many clearances the search may look up."""
LIVES = 3
"""How many workers one query may cost."""
KEPT = 65_536


class WorkerError(Exception):
    """The worker does not start."""


@dataclass(frozen=True)
class Answer:
    """A path, both ends included, if and only if the verdict is "yes"."""

    verdict: Verdict
    path: tuple[Pose, ...] = ()


class PayloadPlanner:
    """Answers about rigid bodies. The worker is started when it is first needed, and again when it died.

    Equal questions to the same layout have equal answers, whatever was asked before.
    """

    def __init__(self, oracle: Oracle, *, seed: int = 0, budget: int = BUDGET) -> None:
        self._oracle, self._seed, self._budget = oracle, seed, budget
        self._worker: subprocess.Popen[str] | None = None
        self._end: weakref.finalize[..., PayloadPlanner] | None = None
        self._known: dict[tuple[Layout, Body, Pose, Pose], Answer] = {}
        self.verdicts: Counter[Verdict] = Counter()
        """How often each verdict was found; answers that were known already are not counted again."""
        self.deaths = 0
        """How many workers died."""

    def __enter__(self) -> PayloadPlanner:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    @property
    def pid(self) -> int | None:
        """The worker's process, if there is one."""
        return self._worker.pid if self._worker else None

    def path(self, layout: Layout, body: Body, start: Pose, goal: Pose) -> Answer:
        """Raises WorkerError when no worker can be started."""
        key = (layout, body, start, goal)
        if key not in self._known:
            if len(self._known) >= KEPT:
                self._known.clear()
            self._known[key] = answer = self._decide(layout, body, start, goal)
            self.verdicts[answer.verdict] += 1
        return self._known[key]

    def close(self) -> None:
        """End the worker; a later query starts another one. It ends with its planner at the latest."""
        if self._end is not None:
            self._end()
        self._worker = self._end = None

    def _decide(self, layout: Layout, body: Body, start: Pose, goal: Pose) -> Answer:
        around, margin = Surroundings(layout), self._oracle.margin_m
        if min(around.clearance(body, start), around.clearance(body, goal)) < margin:
            return Answer("no")
        for end, radius in sorted({(end, capsule.radius_m) for capsule in body for end in capsule[:2]}):
            if not self._oracle.path_exists(layout, radius, placed(end, start), placed(end, goal)):
                return Answer("no")
        whole = self._oracle.shortest(layout, extent(body), start[:2], goal[:2])
        if whole is not None:  # the body can turn anywhere on this way
            turned = start[2] + turning(start, goal)
            return Answer("yes", (start, *((x, y, turned) for x, y in whole.points)))
        found = self._asked(layout, body, start, goal)
        if found is None or not around.clear_path(body, found, margin):
            return Answer("undecided")
        return Answer("yes", tuple(found))

    def _asked(self, layout: Layout, body: Body, start: Pose, goal: Pose) -> list[Pose] | None:
        query = {
            "room": (layout.width_m, layout.height_m),
            "polygons": layout.polygons,
            "discs": layout.discs,
            "body": body,
            "start": start,
            "goal": goal,
            "margin_m": self._oracle.margin_m,
            "seed": self._seed + 1,  # ompl does not take 0
            "budget": self._budget,
        }
        for _ in range(LIVES):
            line = self._exchanged(json.dumps(query))
            if line:
                path = json.loads(line)
                return None if path is None else [(x, y, yaw) for x, y, yaw in path]
            self.deaths += 1
            self.close()
        return None

    def _exchanged(self, line: str) -> str:
        """The worker's answer; empty when it died."""
        worker = self._started()
        assert worker.stdin is not None
        assert worker.stdout is not None
        with suppress(BrokenPipeError):
            worker.stdin.write(line + "\n")
            worker.stdin.flush()
            return worker.stdout.readline()
        return ""

    def _started(self) -> subprocess.Popen[str]:
        if self._worker is not None:
            return self._worker
        complaints = tempfile.TemporaryFile()  # noqa: SIM115 (closed with the worker)
        command = [sys.executable, "-m", "reasoning.motion.worker"]
        self._worker = worker = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=complaints, text=True
        )
        self._end = weakref.finalize(self, _ended, worker, complaints)
        assert worker.stdout is not None
        if worker.stdout.readline() != "ready\n":
            complaints.seek(0)
            complaint = complaints.read().decode(errors="replace").strip()
            self.close()
            raise WorkerError(f"the motion worker does not start: {complaint or 'it said nothing'}")
        return worker


def _ended(worker: subprocess.Popen[str], complaints: IO[bytes]) -> None:
    worker.kill()
    worker.communicate()
    complaints.close()
