"""A child process of the service and a socket to it: inherited where the system allows it, else over loopback.

On POSIX the child inherits one end of a socket pair. On Windows (not tried) the child connects back and sends a secret
first.
"""

from __future__ import annotations

import hmac
import os
import secrets
import signal
import socket
import subprocess
import sys
from collections.abc import Sequence

from tester.base.processes import HANG_UP, module_command

INHERITS = os.name == "posix"
BACK_S = 20.0
"""Time for a child to connect back, s [A]."""
SECRET = "TESTER_LINK_SECRET"


def spawn(module: str, arguments: Sequence[str]) -> tuple[subprocess.Popen[bytes], socket.socket]:
    """Run ``python -m module LINK ARGUMENTS``; return the process and the socket to it. Raises OSError."""
    if INHERITS:
        ours, theirs = socket.socketpair()
        with theirs:
            process = subprocess.Popen(
                module_command(module, f"fd:{theirs.fileno()}", *arguments),
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                # Ctrl+C at the terminal is for the owner only. Not a session of its own: Linux shares the processor
                # among sessions (autogroup), and a session that sleeps most of the time waits up to 0.7 s for it.
                process_group=0,
            )
        return process, ours
    secret = secrets.token_hex(32)
    with socket.create_server(("127.0.0.1", 0), backlog=1) as door:
        door.settimeout(BACK_S)
        process = subprocess.Popen(
            module_command(module, f"port:{door.getsockname()[1]}", *arguments),
            stdin=subprocess.DEVNULL,
            env=os.environ | {SECRET: secret},
        )
        while True:
            ours, _ = door.accept()
            ours.settimeout(BACK_S)
            if hmac.compare_digest(ours.recv(len(secret)), secret.encode()):
                return process, ours
            ours.close()


def link_to_owner(nice: int = 0) -> socket.socket:
    """Return the child's end of the link, which ``spawn`` passed as the first argument. Raises OSError.

    From now on the process ignores signals: it ends with its owner, after the rig has come to standstill. ``nice``
    lowers its priority.
    """
    for asking in (signal.SIGINT, signal.SIGTERM, HANG_UP):
        if asking:
            signal.signal(asking, signal.SIG_IGN)
    if nice and hasattr(os, "nice"):
        os.nice(nice)
    kind, _, number = sys.argv[1].partition(":")
    if kind == "fd":
        return socket.socket(fileno=int(number))
    back = socket.create_connection(("127.0.0.1", int(number)), timeout=BACK_S)
    back.sendall(os.environ.pop(SECRET).encode())
    return back
