"""The service that a screen starts where none runs, and its end at a person's word.

A screen can only end a service that some screen of this user started: it leaves the process's number beside the
service's lock, which the living service holds. One that `tester serve` or the system started is ended where it was
started.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

from tester.base.lock import user_of
from tester.base.processes import tester_command
from tester.service.address import folder as service_folder

LOG = "serve.log"
"""File with the service's output, in the service's folder."""
STARTED = "started-by-screen"
"""File with the number of the service's process that a screen started, in the service's folder."""
LOCK = "service.lock"
"""The service's lock (``tester.service.service_process``), whose holder is its process."""


def start_service(rig: str, runs: Path) -> None:
    """Start ``tester serve``; raises OSError. Only a connection to it shows whether it runs.

    It has a session of its own, so that neither the end of the terminal nor a Ctrl+C there reaches the service. On
    Windows a process group does this, according to its documentation; not tried.
    """
    arguments = tester_command("serve", "--rig", rig, "--out", str(runs))
    detached = 0
    if sys.platform == "win32":
        detached = subprocess.CREATE_NEW_PROCESS_GROUP | subprocess.DETACHED_PROCESS
    where = service_folder()
    with (where / LOG).open("ab") as log:
        process = subprocess.Popen(
            arguments, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True, creationflags=detached
        )
    (where / STARTED).write_text(f"{process.pid}\n", encoding="ascii")


def end_service() -> str:
    """Ask the service to end, as TERM does: it brings the rig to a standstill first. Return "", or why it is not asked.

    Only while the service holds its lock is the number certainly its own.
    """
    where = service_folder()
    holder = user_of(where / LOCK)
    if holder is None:
        return "no service is running here"
    try:
        started = int((where / STARTED).read_text(encoding="ascii"))
    except (OSError, ValueError):
        started = 0
    if holder.pid != started:
        return f"no screen started this service: end process {holder.pid} where it was started"
    if os.name != "posix":  # there TERM would end the process at once, without a standstill
        return f"this system has no way to ask a process to end: end process {holder.pid} while nothing runs"
    try:
        os.kill(holder.pid, signal.SIGTERM)
    except OSError as error:
        return f"process {holder.pid} cannot be asked to end: {error.strerror}"
    return ""
