"""The notify hook: the user's command, run when a person should look at the rig. It never blocks anything.

The command receives one JSON object on its standard input, and the same values as ``TESTER_EVENT``, ``TESTER_TEXT``,
``TESTER_RUN``, ``TESTER_FOLDER`` in its environment. Events: trip, hold, prompt, finished, disk.
"""

from __future__ import annotations

import asyncio
import os
import shlex
import subprocess
import sys

from pydantic import JsonValue
from pydantic_core import from_json

from tester.base.trouble import in_words

WITHIN_S = 30.0
"""Time after which the command is killed, s [A]."""
AT_ONCE = 4
"""Greatest number of commands at a time; further ones are skipped, so that a hook that hangs cannot accumulate
processes [A].
"""
SHOWN = {"event", "text", "run", "folder"}


class Hook:
    """Runs the command. ``command``: split as a shell would, but run without a shell; "" = none."""

    def __init__(self, command: str) -> None:
        """Run nothing yet."""
        self.arguments = shlex.split(command)
        self.running = 0

    async def notify(self, note: bytes) -> None:
        """Run the command, if there is one, with a note (a JSON object); report a failure on standard error."""
        if not self.arguments or self.running >= AT_ONCE:
            return
        self.running += 1
        try:
            await self._run(note)
        except OSError as error:
            _complain(f"notify: {in_words(error)}")
        finally:
            self.running -= 1

    async def _run(self, note: bytes) -> None:
        fields: JsonValue = from_json(note)
        assert isinstance(fields, dict)
        variables = {
            f"TESTER_{key.upper()}": str(value).replace("\0", "") for key, value in fields.items() if key in SHOWN
        }
        process = await asyncio.create_subprocess_exec(
            *self.arguments, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, env=os.environ | variables
        )
        try:
            async with asyncio.timeout(WITHIN_S):
                await process.communicate(note)
        except TimeoutError:
            process.kill()
            await process.wait()
            _complain(f"notify: ended after {WITHIN_S:g} s")
        if process.returncode:
            _complain(f"notify: exit code {process.returncode}")


def _complain(text: str) -> None:
    sys.stderr.write(text + "\n")
