"""One run from start to end: compile, start the processes, wait for the coordinator's last word, stop, judge.

What is shown meanwhile is a `Show`'s business (`ops.shows`): plain lines, the dashboard, or nothing.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from bus.access import OPERATOR
from bus.clock import wall_s
from bus.messages import Envelope, ProcessFault, RunOver
from bus.node import NodeConfig
from bus.transport import Transport
from ops import registry
from ops.compile import Compiled, compile_scenario
from ops.identities import issue
from ops.places import made
from ops.plans import read_plan
from ops.ports import HOST, free_port
from ops.processes import NURSERY, RECORDER, ROUTER, SUPERVISOR, Layout, commands, nursery
from ops.recording import load, parts_of
from ops.scenario import Scenario
from ops.seat import Ears, Seat
from ops.supervisor import GaveUpError, Supervisor, TooLongError
from ops.tables import InputError
from ops.verdict import Report, judge

EVERYWHERE = ("0.0.0.0", "")
OPEN_S = 30.0
RECORDER_S = 20.0


class Show(Protocol):
    """Something that shows a run to people while it goes on. Called on the supervisor's thread."""

    def begin(self, run: str, transport: Callable[[], Transport], stop: Callable[[], None]) -> None:
        """The bus is there; `stop` ends the run when the user has seen enough."""

    def event(self, envelope: Envelope) -> None:
        """Something happened."""

    def end(self) -> None:
        """The run is over; leave the terminal clean."""


@dataclass(frozen=True)
class Options:
    """How to run a scenario. `record` is the directory of the recording (None: one that is thrown away when all is
    well), `port` the router's (0: any that is free), `host` the address that it listens on; `secure`: every process
    proves who it is, and may do only what is its business."""

    record: Path | None = None
    plan: Path | None = None
    port: int = 0
    host: str = HOST
    secure: bool = False


@dataclass(frozen=True)
class Outcome:
    """The end of a run. `home` holds recording and logs, or is None when they were thrown away."""

    run: str
    report: Report
    home: Path | None
    pids: tuple[int, ...]


def execute(scenario: Scenario, options: Options, show: Show) -> Outcome:
    """Run the scenario. Raises `InputError` before anything is started; what happens afterwards is in the report.

    KeyboardInterrupt is raised again after everything was stopped in order.
    """
    plan = options.plan or scenario.plan
    compiled = compile_scenario(scenario, read_plan(plan).given() if plan else None)
    port = free_port(options.port, options.host)
    run = registry.new_name(scenario.name)
    home = _home(run, options.record)
    compiled.write(home)
    link, host = "tls" if options.secure else "tcp", options.host if options.host not in EVERYWHERE else HOST
    layout = Layout(
        run=run,
        teams=compiled.teams,
        connect=f"{link}/{host}:{port}",
        listen=f"{link}/{options.host}:{port}",
        home=home,
        setups=home,
        record=home,
        clock=scenario.clock.option(),
        seed=scenario.seed,
        python=sys.executable,
        identities=home / "identities" if options.secure else None,
    )
    operator = str(home / "identities" / OPERATOR) if options.secure else ""
    running = registry.Running(run, layout.connect, str(home), registry.own_pid(), str(scenario.path), operator)
    try:
        if options.secure:
            names = [*commands(layout), SUPERVISOR]
            issue(home / "identities", run, [host, "localhost"], [name for name in names if name != ROUTER])
        with registry.registered(running):
            over, stopped, pids = _conduct(layout, compiled, show)
    except BaseException:
        if options.record is None:
            shutil.rmtree(home, ignore_errors=True)
        raise
    finally:
        shutil.rmtree(home / "identities", ignore_errors=True)
    report = _judge(scenario, home, over, stopped)
    kept = options.record is not None or report.exit_code != scenario.verdict.exit
    if not kept:
        shutil.rmtree(home, ignore_errors=True)
    return Outcome(run, report, home if kept else None, pids)


def _conduct(layout: Layout, compiled: Compiled, show: Show) -> tuple[RunOver | None, str, tuple[int, ...]]:
    """Start, wait, stop. The coordinator's last word, else why there is none, and all process ids that there were."""
    run = _Run(layout, show)
    over: RunOver | None = None
    stopped, interrupted = "", False
    limits = compiled.scenario.limits
    with Supervisor(wall_s, run.said, limits.restarts) as boss, Seat(run.config(), run.ears(boss)) as seat:
        run.seat = seat
        try:
            argv = commands(layout)
            logs = Path(layout.home) / "logs"
            logs.mkdir(exist_ok=True)
            boss.nurse(nursery(layout.python), logs / f"{NURSERY}.log")
            boss.launch(ROUTER, argv.pop(ROUTER), logs / "router.log")
            boss.until(lambda: run.opened, OPEN_S, f"the bus at {layout.connect}")
            show.begin(layout.run, seat.transport, partial(boss.post, run.interrupt))
            for name, command in argv.items():
                boss.launch(name, command, logs / f"{name}.log")
            seat.show("watching over the processes")
            until = partial(_over, run, limits.simulated_s)
            boss.until(until, limits.wall_s, "the coordinator's last word (limits.wall_s)")
            if run.over is None or seat.now_s > limits.simulated_s:
                raise TooLongError(f"not over after {limits.simulated_s:g} simulated seconds (limits.simulated_s)")
            over = run.over  # what is said later, while all are being stopped, does not count
        except (GaveUpError, TooLongError) as error:
            stopped = str(error)
            run.needs_person("gave_up" if isinstance(error, GaveUpError) else "too_long", stopped)
        except KeyboardInterrupt:
            interrupted = True
        finally:
            show.end()
        try:
            # First the recorder: it asks every source for what it has missed, so they must live until it is done.
            boss.stop_together([RECORDER], RECORDER_S, ready=partial(run.recorded, boss))
            boss.stop_together(compiled.teams)
            boss.stop()
        except (GaveUpError, TooLongError) as error:
            stopped = stopped or str(error)
    if interrupted:
        raise KeyboardInterrupt
    return over, stopped, tuple(pid for child in boss.table.values() for pid in child.pids)


def _over(run: _Run, simulated_s: float) -> bool:
    return run.over is not None or (run.seat is not None and run.seat.now_s > simulated_s)


class _Run:
    """What is known of a run while it goes on; all on the supervisor's thread."""

    def __init__(self, layout: Layout, show: Show) -> None:
        self._layout, self._show = layout, show
        self.seat: Seat | None = None
        self.over: RunOver | None = None
        self.opened = False
        self._recorder = 0

    def config(self) -> NodeConfig:
        home = Path(self._layout.home)
        identity = home / "identities" / SUPERVISOR if self._layout.identities else None
        return NodeConfig(self._layout.run, SUPERVISOR, self._layout.connect, home, outsider=True, identity=identity)

    def ears(self, boss: Supervisor) -> Ears:
        """What the seat hears is done on the supervisor's thread."""
        return Ears(
            on_event=lambda envelope: boss.post(partial(self._show.event, envelope)),
            on_fault=lambda fault, done: boss.post(partial(self._disturb, boss, fault, done)),
            on_over=lambda over: boss.post(partial(self._hear_over, over)),
            on_end=lambda error: boss.post(partial(self._hear_open, error)),
            on_recorder=lambda pid: boss.post(partial(self._hear_recorder, pid)),
        )

    def recorded(self, boss: Supervisor) -> bool:
        """Whether the recorder, in its present life, is at work: it has opened its file before its first sign of life,
        and knows what to do when it is told to end."""
        return boss.table[RECORDER].pid == self._recorder

    def said(self, name: str, state: str, cause: str) -> None:
        """What becomes of processes, as events; stopping at the end is not worth one."""
        if self.seat is not None and state != "stopped":
            text = f"{name} {state.replace('_', ' ')}{f': {cause}' if cause else ''}"
            self.seat.emit("process", text, name=name, state=state, cause=cause)

    def needs_person(self, cause: str, why: str) -> None:
        """The system cannot go on by itself."""
        if self.seat is not None:
            self.seat.emit("needs_person", f"a person is needed: {why}", cause=cause)

    def interrupt(self) -> None:
        raise KeyboardInterrupt

    def _disturb(self, boss: Supervisor, fault: ProcessFault, done: Callable[[], None]) -> None:
        boss.disturb(fault.kind, fault.target, done)

    def _hear_over(self, over: RunOver) -> None:
        self.over = over

    def _hear_recorder(self, pid: int) -> None:
        self._recorder = pid

    def _hear_open(self, error: str) -> None:
        if error:
            raise GaveUpError(error)
        self.opened = True


def _home(run: str, record: Path | None) -> Path:
    if record is None:
        return registry.home_of(run)
    if record.exists() and not record.is_dir():
        raise InputError(f"--record {record}: expected a directory, this is a file")
    if record.is_dir() and (parts_of(record) or list(record.glob("*.sqlite"))):
        raise InputError(f"--record {record}: there is a recording already; choose a new directory, or remove it")
    if record.is_dir() and next(record.iterdir(), None) is not None:
        raise InputError(f"--record {record}: there is something else in this directory; choose a new one")
    return made(record).resolve()


def _judge(scenario: Scenario, home: Path, over: RunOver | None, stopped: str) -> Report:
    """The report, from the recording."""
    from ops.invariants import check  # not before: it is needed at the end only

    try:
        recording = load(home)
    except FileNotFoundError:
        return judge(scenario.verdict, (), over, ("there is no recording",), (), stopped)
    return judge(scenario.verdict, recording.events, over, check(recording), recording.beats, stopped)
