"""How many teams a machine carries: ``python -m bench.scale``, or ``muster bench scale``.

For each number of teams, real team processes start together behind one router, as ``muster run`` starts them: by the
supervisor, whose nursery has yet to be started. Ready is a team that has loaded its domain, opened its journal and
joined the clock; then they idle, and memory and CPU are read.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bench.loopback import free_endpoint
from bench.measured import ignored, progress, telling
from bus.clock import run_world, wall_s
from bus.messages import Envelope
from bus.node import Node, NodeConfig, open_node
from ops.processes import ROUTER, Layout, commands, nursery
from ops.supervisor import Supervisor

SIZES = (4, 16, 64)
DOMAIN = "factory"
CALM_S = 2.0
IDLE_S = 5.0


def run(sizes: tuple[int, ...] = SIZES, on_row: Callable[[int, dict[str, float]], None] = ignored) -> dict[str, Any]:
    """Measure each size; seconds (`_s`), megabytes (`_mb`), per cent of one core (`_percent`). `on_row` gets each size
    and its figures when they are there."""
    result: dict[str, Any] = {}
    with telling(result):
        for size in sizes:
            progress(f"{size} teams")
            result[str(size)] = _measure(size)
            on_row(size, result[str(size)])
    return result


class _Watch:
    """A world without physics that reads the teams' use of the machine while they idle."""

    def __init__(self, node: Node, size: int) -> None:
        self._node, self._missing = node, size
        self._ready_wall_s = self._calm_wall_s = 0.0
        self._cpu_s = 0.0
        self.pids: list[int] = []
        self.figures: dict[str, float] = {}

    def contact(self, name: str, state: str) -> None:
        if state == "lost_contact":
            raise RuntimeError(f"{name} did not come")
        self._missing -= 1
        if not self._missing:
            self._ready_wall_s = wall_s()
            self.figures["start_cpu_s_each"] = sum(map(_cpu_s, self.pids)) / len(self.pids)

    def handle(self, mail: tuple[Envelope, ...]) -> None:
        pass

    def next_s(self) -> float | None:
        return None

    def advance(self, to_s: float) -> None:
        wall = wall_s()
        if not self._calm_wall_s and wall > self._ready_wall_s + CALM_S:
            self._calm_wall_s, self._cpu_s = wall, sum(map(_cpu_s, self.pids))
        elif self._calm_wall_s and wall > self._calm_wall_s + IDLE_S:
            used_s = sum(map(_cpu_s, self.pids)) - self._cpu_s
            count = len(self.pids)
            self.figures["idle_percent_each"] = 100.0 * used_s / (wall - self._calm_wall_s) / count
            self.figures["memory_mb_each"] = sum(map(_pss_mb, self.pids)) / count
            self._node.stop()

    def ready_after_s(self, start_wall_s: float) -> float:
        return self._ready_wall_s - start_wall_s


def _measure(size: int) -> dict[str, float]:
    names = tuple(f"T{number}" for number in range(1, size + 1))
    endpoint = free_endpoint()
    with tempfile.TemporaryDirectory() as folder, Supervisor(wall_s, lambda *_: None) as boss:
        home = Path(folder)
        layout = Layout("scale", names, endpoint, home, home, home, clock="realtime", python=sys.executable)
        command = commands(layout)
        boss.launch(ROUTER, command[ROUTER], home / "router.log")
        with open_node(NodeConfig("scale", "world", endpoint, mode="realtime")) as node:
            watch = _Watch(node, size)
            start_wall_s = wall_s()
            boss.nurse(nursery(sys.executable), home / "nursery.log")
            for name in names:
                setup = {"domain": DOMAIN, "team": name, "static": {}}
                (home / f"{name}.json").write_text(json.dumps(setup))
                boss.launch(name, command[name], home / f"{name}.log")
                watch.pids.append(boss.table[name].pid)
            run_world(
                node, watch, participants=names, mode="realtime", return_s=60.0, lease_s=60.0, on_contact=watch.contact
            )
        if "memory_mb_each" not in watch.figures:  # the world's clock takes a signal for a wish to end in order
            raise KeyboardInterrupt
        return {
            "ready_s": watch.ready_after_s(start_wall_s),
            **watch.figures,
            "router_mb": _pss_mb(boss.table[ROUTER].pid),
        }


def _cpu_s(pid: int) -> float:
    """Seconds of processor time that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _pss_mb(pid: int) -> float:
    """Memory of a process, with what it shares divided among those who share it."""
    for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
        if line.startswith("Pss:"):
            return int(line.split()[1]) / 1024
    return 0.0


def main() -> None:
    """Measure and print."""
    print("teams   all ready   CPU till then, each   memory each   idle CPU each   router", flush=True)
    run(on_row=_print_row)


def _print_row(size: int, figures: dict[str, float]) -> None:
    starting = (("ready_s", 10, "s"), ("start_cpu_s_each", 20, "s"))
    idling = (("memory_mb_each", 11, "MB"), ("idle_percent_each", 13, "%"), ("router_mb", 7, "MB"))
    cells = (f"{figures[name]:{width}.2f} {unit}" for name, width, unit in (*starting, *idling))
    print(f"{size:>5}" + "".join(cells), flush=True)


if __name__ == "__main__":
    main()
