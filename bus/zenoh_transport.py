"""The one door to Zenoh: a client of the router, and the router itself.

Measured traps that shape this file: a full callback queue blocks the whole session, hence callbacks run on Zenoh's
own thread (``indirect=False``; they only enqueue); such callbacks also leave no Python thread that keeps a dying
process alive.
"""

from __future__ import annotations

import json
import threading
from pathlib import Path
from typing import Any, Literal

import zenoh
import zenoh.ext
from zenoh.handlers import Callback, RingChannel

from bus import keys
from bus.access import ACCESS, AUTHORITY, CERTIFICATE, PRIVATE_KEY
from bus.transport import Notice, Receive, TransportError

# The link's lease is longer than the clock's lease for participants (3 s): a process that is stopped must be found
# silent before its token vanishes, which says that it died. Frequent keep-alives flush a batch that got stuck.
# A longer queue: with the default of two batches, a droppable message behind a few others was often dropped.
LINK = {
    "transport/link/tx/lease": 5000,
    "transport/link/tx/keep_alive": 10,
    "transport/link/tx/queue/size/data": 16,
}
CLIENT = {
    "connect/timeout_ms": 15000,
    "connect/exit_on_failure": True,
    "connect/retry": {"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 1.5},
    "timestamping/enabled": True,  # the latest-value channels order by it
}


def connect(endpoint: str, identity: Path | None = None) -> ZenohTransport:
    """Connect to the router at `endpoint`, waiting up to 15 s for it; to a secure one with an `identity` (see
    `bus.access`).

    Raises TransportError when it is not there.
    """
    return ZenohTransport(open_client(endpoint, identity))


def open_client(endpoint: str, identity: Path | None = None) -> zenoh.Session:
    """A bare session, as `connect` uses it.

    Raises TransportError when there is no router.
    """
    settings = {**CLIENT, **_tls(identity, "connect")} if identity else CLIENT
    try:
        return zenoh.open(_config("client", connect=[endpoint], settings=settings))
    except zenoh.ZError as error:
        text = f"no router answers at {endpoint}: the run is over, or the address is wrong"
        if endpoint.startswith("tls"):
            text += "; or it does not take this identity" if identity else "; a secure one wants an --identity"
        raise TransportError(text) from error


def open_router(endpoint: str, identity: Path | None = None) -> zenoh.Session:
    """Be the router at `endpoint` until the session is closed. With an `identity` it takes only clients that prove
    theirs, and lets them do only what the access control in its folder allows.

    Raises TransportError when the endpoint cannot be listened on, OSError when the identity cannot be read.
    """
    settings: dict[str, Any] = {}
    if identity is not None:
        access = json.loads((identity / ACCESS).read_text())
        settings = {**_tls(identity, "listen"), "access_control": access, "transport/link/protocols": ["tls"]}
    try:
        return zenoh.open(_config("router", listen=[endpoint], settings=settings))
    except zenoh.ZError as error:
        if "in use" in str(error):
            text = f"{endpoint} is in use: is another run going on? Stop it, or choose another port."
        else:
            expected = "tls/HOST:PORT" if identity else "tcp/HOST:PORT"
            text = f"cannot listen on {endpoint}, expected {expected}: {str(error).partition(' at /')[0]}"
        raise TransportError(text) from error


def _tls(identity: Path, side: Literal["connect", "listen"]) -> dict[str, Any]:
    files = {
        "root_ca_certificate": AUTHORITY,
        f"{side}_certificate": CERTIFICATE,
        f"{side}_private_key": PRIVATE_KEY,
    }
    return {
        **{f"transport/link/tls/{setting}": str(identity / file) for setting, file in files.items()},
        "transport/link/tls/enable_mtls": True,
        "transport/link/tls/verify_name_on_connect": True,
    }


def _config(mode: str, settings: dict[str, Any], listen: tuple[str, ...] | list[str] = (), connect: Any = ()) -> Any:
    zenoh.init_log_from_env_or("off")  # its log would go to standard output; what matters arrives as ZError
    config = zenoh.Config()
    basic = {
        "mode": mode,
        "listen/endpoints": list(listen),
        "connect/endpoints": list(connect),
        "scouting/multicast/enabled": False,
        "transport/shared_memory/enabled": False,
    }
    for key, value in {**basic, **LINK, **settings}.items():
        config.insert_json5(key, json.dumps(value))
    return config


class ZenohTransport:
    """See `bus.transport.Transport`."""

    def __init__(self, session: zenoh.Session) -> None:
        self._session = session
        self._open = True
        self._kept: dict[str, zenoh.ext.AdvancedPublisher] = {}
        self._declared: list[Any] = []
        self._drains: list[threading.Thread] = []

    def put(self, key: str, payload: bytes, *, droppable: bool = False) -> None:
        control = zenoh.CongestionControl.DROP if droppable else zenoh.CongestionControl.BLOCK
        try:
            self._session.put(key, payload, congestion_control=control, express=True)
        except zenoh.ZError:
            if self._open:
                raise

    def keep(self, key: str, payload: bytes) -> None:
        if not self._open:
            return
        publisher = self._kept.get(key)
        if publisher is None:
            cache = zenoh.ext.CacheConfig(1)
            publisher = zenoh.ext.declare_advanced_publisher(self._session, key, cache=cache, publisher_detection=True)
            self._kept[key] = publisher
        publisher.put(payload)

    def subscribe(self, keyexpr: str, callback: Receive, *, latest: bool = False, history: bool = False) -> None:
        def receive(sample: Any) -> None:
            if sample.kind == zenoh.SampleKind.PUT:
                callback(str(sample.key_expr), bytes(sample.payload))

        handler: Any = RingChannel(1) if latest else Callback(receive, indirect=False)
        if history:
            late = zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=1)
            subscriber: Any = zenoh.ext.declare_advanced_subscriber(self._session, keyexpr, handler, history=late)
        else:
            subscriber = self._session.declare_subscriber(keyexpr, handler)
        self._declared.append(subscriber)
        self._settle()
        if latest:
            drain = threading.Thread(target=_drain, args=(subscriber, receive), name=f"latest {keyexpr}", daemon=True)
            drain.start()
            self._drains.append(drain)

    def _settle(self) -> None:
        """Return when the router knows what was declared before (it answers in order): who has subscribed misses
        nothing that is sent afterwards."""
        for _ in self._session.liveliness().get(keys.NOBODY, timeout=2.0):
            pass

    def present(self, key: str) -> None:
        self._declared.append(self._session.liveliness().declare_token(key))

    def watch(self, keyexpr: str, callback: Notice) -> None:
        def receive(sample: Any) -> None:
            callback(str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT)

        handler = Callback(receive, indirect=False)
        self._declared.append(self._session.liveliness().declare_subscriber(keyexpr, handler, history=True))

    def close(self) -> None:
        if not self._open:
            return
        self._open = False
        # Advanced subscribers have hung in close() in earlier versions (zenoh-python issue 624): undeclare them first.
        for declared in [*self._declared, *self._kept.values()]:
            declared.undeclare()
        for drain in self._drains:
            # Undeclaring ends them. One that is still inside Zenoh while the interpreter ends would abort the process.
            drain.join(1.0)
        self._session.close()  # type: ignore[no-untyped-call]


def _drain(subscriber: Any, receive: Any) -> None:
    for sample in subscriber:
        receive(sample)
