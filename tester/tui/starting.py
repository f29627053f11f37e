"""Starts the service as a separate process, which outlives the terminal and the program that started it."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from pathlib import Path

from tester.base.processes import tester_command
from tester.service.address import folder

LOG = "serve.log"
"""Log of the service's output, in its folder."""


def start_service(rig: str, runs: Path) -> None:
    """Start ``tester serve``; raises OSError. Connect to it to find out whether it runs.

    A session of its own: neither the end of the terminal nor a Ctrl+C in it reaches the service. Windows has process
    groups for that, as documented; not tried.
    """
    arguments = tester_command("serve", "--rig", rig, "--out", str(runs))
    detached = 0
    if sys.platform == "win32":
        detached = subprocess.CREATE_NEW_PROCESS_GROUP | subprocess.DETACHED_PROCESS
    with (folder() / LOG).open("ab") as log:
        subprocess.Popen(
            arguments, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True, creationflags=detached
        )


async def call(*arguments: str) -> tuple[bool, str]:
    """Run ``tester ARGUMENTS``; return whether it succeeded, and its error output."""
    process = await asyncio.create_subprocess_exec(
        *tester_command(*arguments),
        stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.PIPE,
    )  # fmt: skip
    _, output = await process.communicate()
    return process.returncode == 0, output.decode(errors="replace").strip()
