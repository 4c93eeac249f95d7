"""The port that a run's router listens on."""

from __future__ import annotations

import errno
import socket

from ops import registry
from ops.tables import InputError

HOST = "127.0.0.1"


def free_port(wanted: int, host: str = HOST) -> int:
    """The router's port: the wanted one if it is free, else any. Raises `InputError` when it is in use."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, wanted))
        except OSError as error:
            if error.errno not in (errno.EADDRINUSE, errno.EACCES):
                raise InputError(f"--host {host}: expected an address of this machine ({error.strerror})") from error
            users = [one.run for one in registry.listing() if one.connect.endswith(f":{wanted}")]
            by = f" by the run {users[0]}" if users else ""
            way_out = "choose another with --port N, or leave --port out and a free one is taken"
            raise InputError(f"--port {wanted}: cannot be used{by} ({error.strerror}); {way_out}") from error
        return int(probe.getsockname()[1])
