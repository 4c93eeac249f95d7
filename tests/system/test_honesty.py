"""Agents know what their sensors and messages tell them, and nothing else. Watched in a real run, from outside: what
each has subscribed to, as the router says; which files it opens, as the interpreter says; and all that is sent to it.
"""

from __future__ import annotations

import ast
import queue
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import pytest
import zenoh

from bus import keys
from bus import messages as m
from bus.codec import decode
from bus.messages import Envelope, Event, RunOver
from bus.node import NodeConfig
from bus.zenoh_transport import _config, open_client
from ops.children import environment
from ops.compile import compile_scenario
from ops.processes import ROUTER, Layout, commands
from ops.scenario import load
from ops.seat import Ears, Seat
from tests.bus.conftest import free_endpoint

pytestmark = [pytest.mark.slow, pytest.mark.timeout(120)]

ROOT = Path(__file__).parents[2]
RUN = "honest"
TEAMS = ("T1", "T2")
AGENTS = ("coordinator", *TEAMS)
SCENARIO = """
story = "The carrier of T1 breaks as it attaches; it might be the worker as well."
domain = "factory"
[floor]
width = 3
height = 2
[teams.T1]
boxes = 1
workers = [{name = "w1", at = [1, 1], effector = 1}]
carrier = {name = "c1", at = [1, 1]}
[teams.T2]
boxes = 1
workers = [{name = "w1", at = [1, 2], effector = 1}]
carrier = {name = "c1", at = [1, 1]}
[[fault]]
on_action = "T1.attach(c1,w1)"
kind = "break"
target = "T1.c1"
"""
WATCHED = """
import runpy, sys
_, notes, directory, module, *options = sys.argv
log = open(notes, "w", buffering=1)
def hook(event, args):
    if event in ("open", "sqlite3.connect") and str(args[0]).startswith(directory):
        log.write(str(args[0]) + chr(10))
sys.addaudithook(hook)
sys.argv = [module, *options]
runpy.run_module(module, run_name="__main__", alter_sys=True)
"""
"""Runs a module and notes which files below a directory it opens."""


class Watched(NamedTuple):
    """A run as it looked from outside: who subscribed to which keys, who opened which files of the run, and all
    messages with their keys, in the order in which they came."""

    subscribed: dict[str, set[str]]
    opened: dict[str, set[str]]
    messages: list[tuple[str, Envelope]]

    def mail(self, name: str) -> list[Envelope]:
        return [envelope for key, envelope in self.messages if key.startswith(keys.mail(RUN, name, ""))]

    def first(self, kind: str) -> int:
        """The place of the first event of this kind among all messages."""
        return next(n for n, (_, e) in enumerate(self.messages) if isinstance(e.body, Event) and e.body.kind == kind)


@pytest.fixture(scope="module")
def watched(tmp_path_factory: pytest.TempPathFactory) -> Watched:
    home = tmp_path_factory.mktemp("honest")
    (home / "scenario.toml").write_text(SCENARIO)
    compiled = compile_scenario(load(str(home / "scenario.toml")))
    compiled.write(home)
    endpoint = free_endpoint()
    over: queue.Queue[RunOver] = queue.Queue()
    heard: list[tuple[str, bytes]] = []
    ears = Ears(lambda _: None, lambda _, done: done(), over.put, lambda _: None, lambda _: None)
    with ExitStack() as stack:
        settings = {"adminspace/enabled": True, "adminspace/permissions/read": True}
        router = stack.enter_context(zenoh.open(_config("router", settings, listen=[endpoint])))
        listener = stack.enter_context(open_client(endpoint))
        listener.declare_subscriber(f"muster/{RUN}/**", lambda s: heard.append((str(s.key_expr), bytes(s.payload))))
        stack.enter_context(Seat(NodeConfig(RUN, "supervisor", endpoint, outsider=True), ears))
        argv = commands(Layout(RUN, TEAMS, endpoint, home, home, home, "fast", 1, sys.executable))
        for name, command in argv.items():
            if name in AGENTS:
                watcher = [sys.executable, "-c", WATCHED, str(home / f"{name}.opened"), str(home)]
                stack.enter_context(started([*watcher, *command[2:]], home / f"{name}.log"))
            elif name != ROUTER:
                stack.enter_context(started(command, home / f"{name}.log"))
        assert over.get(timeout=90).goal
        subscribed = subscriptions(router)
    opened = {name: set((home / f"{name}.opened").read_text().split()) for name in AGENTS}
    relative = {name: {str(Path(file).relative_to(home)) for file in files} for name, files in opened.items()}
    messages = [(key, e) for key, payload in heard if isinstance(e := decode(payload), Envelope)]
    return Watched(subscribed, relative, messages)


@contextmanager
def started(argv: list[str], log: Path) -> Iterator[None]:
    with log.open("wb") as out, subprocess.Popen(argv, env=environment(), stdout=out, stderr=out) as process:
        try:
            yield
        finally:
            process.kill()  # nobody needs the end of the recording
            process.wait(30)


def subscriptions(router: Any) -> dict[str, set[str]]:
    """Keys by process, from the router's own tables. Who is who is told by the presence tokens."""

    def table(what: str) -> Iterator[tuple[str, list[str]]]:
        for reply in router.get(f"@/*/router/{what}/**", timeout=5.0):
            key = str(reply.ok.key_expr).partition(f"/{what}/")[2]
            yield key, msgspec.json.decode(bytes(reply.ok.payload))["clients"]

    names = {
        client: keys.last(key)
        for key, clients in table("token")
        for client in clients
        if key.startswith(keys.live(RUN, ""))
    }
    found: dict[str, set[str]] = defaultdict(set)
    for key, clients in table("subscriber"):
        for client in clients:
            found[names.get(client, "")].add(key)
    return dict(found)


def test_agents_subscribe_to_their_mail_and_to_the_clock(watched: Watched) -> None:
    for name in AGENTS:
        assert watched.subscribed[name] == {keys.mail(RUN, name, "*"), keys.tick(RUN)}


def test_the_truth_has_readers_all_the_same(watched: Watched) -> None:
    """Otherwise that no agent is among them would mean nothing."""
    assert {keys.truth_frame(RUN), keys.truth_scene(RUN)} <= watched.subscribed["recorder"]
    assert watched.first("fault_injected") < watched.first("discrepancy")


def test_agents_open_their_own_files_only(watched: Watched) -> None:
    for name in AGENTS:
        assert {f"{name}.json", f"{name}.sqlite"} <= watched.opened[name]
        assert {file for file in watched.opened[name] if not file.startswith(f"{name}.")} == set()


SAID: dict[str, dict[str, tuple[type, ...]]] = {
    "team": {
        "world": (m.Executed, m.Observed, m.Ok),
        "coordinator": (m.Enquire, m.Ask, m.Adopt, m.Go),
        "recorder": (m.EventsFrom, m.Ping),
    },
    "coordinator": {
        "world": (m.Contact, m.Order, m.Ok),
        "team": (m.Standing, m.Answer, m.Adopted, m.StepResult),
        "supervisor": (m.Ok,),
        "recorder": (m.EventsFrom, m.Ping),
    },
}
"""What a receiver is told by whom. Teams tell the coordinator answers, never states, and nothing to one another."""


def test_agents_are_told_what_is_theirs_to_know(watched: Watched) -> None:
    for name in AGENTS:
        said = SAID["team" if name in TEAMS else name]
        mail = watched.mail(name)
        assert len(mail) > 20
        for envelope in mail:
            source = "team" if envelope.src in TEAMS else envelope.src
            assert isinstance(envelope.body, said[source]), f"{envelope.src} told {name}: {envelope.body}"


def test_sensors_show_what_can_be_sensed(watched: Watched) -> None:
    sensed = {"at", "effector", "attached", "line", "stage", "wet"}
    for team in TEAMS:
        states = [e.body.state for e in watched.mail(team) if isinstance(e.body, m.Executed | m.Observed)]
        assert states
        assert {fluent.partition("(")[0] for state in states for fluent in state} == sensed


def test_only_an_inspection_finds_what_is_broken(watched: Watched) -> None:
    orders = {e.id: e.body for e in watched.mail("world") if isinstance(e.body, m.Execute)}
    inspected = []
    for team in TEAMS:
        for envelope in watched.mail(team):
            if isinstance(envelope.body, m.Executed):
                asked = {str(call.args[0]) for call in orders[envelope.re].calls if call.name == "inspect"}
                assert set(envelope.body.findings) == asked
                inspected += sorted(asked)
    assert inspected, "nobody was inspected: it shows nothing"


def test_nobody_hears_of_anything_broken_before_a_team_has_found_out(watched: Watched) -> None:
    """The world knew all the time, and told the recorder."""
    found_out = watched.first("diagnosis")
    for number, (key, envelope) in enumerate(watched.messages):
        told = key.startswith((f"muster/{RUN}/mail/T", keys.mail(RUN, "coordinator", ""), keys.tick(RUN)))
        if told and b"broken" in msgspec.json.encode(envelope.body):
            assert number > found_out or isinstance(envelope.body, m.StepResult), f"{key}: {envelope.body}"
            return
    raise AssertionError("nobody was ever told that something is broken: it shows nothing")


def test_no_agent_names_the_keys_of_the_truth() -> None:
    for file in sorted((ROOT / "agents").rglob("*.py")) + sorted((ROOT / "reasoning").rglob("*.py")):
        names = {node.attr for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.Attribute)}
        assert not names & {"truth_frame", "truth_scene", "listen", "subscribe"}, file.name
