"""A secure bus, with a real router: who may say and hear what. The rules are in `bus.access`."""

from __future__ import annotations

import stat
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from bus import keys
from bus.access import ACCESS, OPERATOR, PRIVATE_KEY
from bus.transport import TransportError
from bus.zenoh_transport import CLIENT, ZenohTransport, connect
from ops.identities import issue
from ops.processes import RECORDER, ROUTER, SUPERVISOR
from tests.bus.conftest import Collected, free_endpoint

RUN = "secure"
NAMES = ("world", "coordinator", "T1", "T2", RECORDER, SUPERVISOR)
Heard = Collected[tuple[str, bytes]]
Join = Callable[[str], ZenohTransport]


@pytest.fixture(scope="module")
def identities(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return issue(tmp_path_factory.mktemp("identities"), RUN, ["127.0.0.1"], NAMES)


@pytest.fixture(scope="module")
def endpoint(identities: Path) -> Iterator[str]:
    at = free_endpoint().replace("tcp/", "tls/")
    argv = [sys.executable, "-m", "bus.router", "--connect", at, "--identity", str(identities / ROUTER)]
    with subprocess.Popen(argv, stdout=subprocess.PIPE, text=True) as router:
        assert router.stdout is not None
        assert "listening" in router.stdout.readline()
        yield at
        router.terminate()


@pytest.fixture
def join(identities: Path, endpoint: str) -> Iterator[Join]:
    opened: list[ZenohTransport] = []

    def as_(name: str) -> ZenohTransport:
        opened.append(connect(endpoint, identities / name))
        return opened[-1]

    yield as_
    for transport in opened:
        transport.close()


def hears(transport: ZenohTransport, keyexpr: str) -> Heard:
    heard: Heard = Collected()
    transport.subscribe(keyexpr, heard.pair)
    return heard


def test_agents_hear_their_mail_and_the_clock_and_never_the_truth(join: Join) -> None:
    team, operator, world = join("T1"), join(OPERATOR), join("world")
    everything, truth = hears(team, f"muster/{RUN}/**"), hears(team, keys.truth_frame(RUN))
    for own in (keys.mail(RUN, "T1", "*"), keys.tick(RUN)):  # what comes in by these, the first would hear, too
        hears(team, own)
    seen = hears(operator, keys.truth_frame(RUN))
    world.put(keys.truth_frame(RUN), b"truth")
    world.put(keys.mail(RUN, "T2", "world"), b"for another")
    world.put(keys.mail(RUN, "T1", "world"), b"mail")
    world.put(keys.tick(RUN), b"tick")
    seen.wait_for((keys.truth_frame(RUN), b"truth"))
    everything.wait_for((keys.tick(RUN), b"tick"))  # sent last
    assert everything.items == [(keys.mail(RUN, "T1", "world"), b"mail"), (keys.tick(RUN), b"tick")]
    assert truth.items == []


@pytest.mark.parametrize(
    "key",
    [
        keys.mail(RUN, "world", "coordinator"),
        keys.mail(RUN, "coordinator", "T2"),
        keys.beat(RUN, "T2"),
        keys.event(RUN, "world"),
        keys.tick(RUN),
        keys.truth_frame(RUN),
        keys.done(RUN, "T2"),
    ],
)
def test_nobody_speaks_under_anothers_name(join: Join, key: str) -> None:
    team, operator = join("T1"), join(OPERATOR)
    heard = hears(operator, f"muster/{RUN}/**")
    team.put(key, b"forged")
    team.put(keys.beat(RUN, "T1"), b"honest")
    heard.wait_for((keys.beat(RUN, "T1"), b"honest"))
    assert [entry for entry in heard.items if entry[1] == b"forged"] == []


def test_presence_and_the_latest_status_are_ones_own(join: Join) -> None:
    team, operator = join("T1"), join(OPERATOR)
    tokens: Collected[tuple[str, bool]] = Collected()
    team.present(keys.live(RUN, "T2"))
    team.keep(keys.status(RUN, "T2"), b"forged")
    team.keep(keys.status(RUN, "T1"), b"mine")
    team.present(keys.live(RUN, "T1"))
    operator.watch(keys.live(RUN, "*"), tokens.pair)
    late: Heard = Collected()
    operator.subscribe(keys.status(RUN, "*"), late.pair, history=True)
    tokens.wait_for((keys.live(RUN, "T1"), True))
    late.wait_for((keys.status(RUN, "T1"), b"mine"))
    assert tokens.items == [(keys.live(RUN, "T1"), True)]
    assert late.items == [(keys.status(RUN, "T1"), b"mine")]


@pytest.mark.slow
def test_strangers_are_not_let_in(endpoint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CLIENT, "connect/timeout_ms", 1000)
    others = issue(tmp_path, RUN, ["127.0.0.1"], ["world"])
    for identity in (None, others / "world"):
        with pytest.raises(TransportError, match="identity"):
            connect(endpoint, identity)


def test_private_keys_are_the_owners_alone(identities: Path) -> None:
    assert {folder.name for folder in identities.iterdir()} == {*NAMES, ROUTER, OPERATOR}
    for folder in identities.iterdir():
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
        assert stat.S_IMODE((folder / PRIVATE_KEY).stat().st_mode) == 0o600
        assert (folder / ACCESS).exists() == (folder.name == ROUTER)
