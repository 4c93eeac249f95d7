"""The router process: ``python -m bus.router --connect tcp/127.0.0.1:PORT`` until SIGTERM or SIGINT."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from pathlib import Path

from bus.transport import TransportError

DEFAULT = "tcp/127.0.0.1:7447"


def main(argv: list[str] | None = None) -> int:
    """Run the router; 0 when it was told to stop, 2 when it cannot listen."""
    parser = argparse.ArgumentParser(
        prog="python -m bus.router", description="The router that joins the processes of a run."
    )
    parser.add_argument("--connect", default=os.environ.get("MUSTER_CONNECT", DEFAULT), help="endpoint to listen on")
    parser.add_argument("--identity", type=Path, default=os.environ.get("MUSTER_IDENTITY"), help="makes it secure")
    given = parser.parse_known_args(argv)[0]  # the options that every other process takes mean nothing here
    # Blocked, for all threads to come, and waited for: a handler might interrupt the very wait that it is to end.
    ends = (signal.SIGTERM, signal.SIGINT)
    signal.pthread_sigmask(signal.SIG_BLOCK, ends)
    from bus.zenoh_transport import open_router  # only now: Zenoh may start threads

    try:
        with open_router(given.connect, given.identity):
            print(f"router: listening on {given.connect}", flush=True)
            signal.sigwait(ends)
    except (TransportError, OSError) as error:
        print(f"router: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
