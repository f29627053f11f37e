"""Looks at items of the queue in processes of their own, so that neither the scan nor clients wait for planning.

``python -m tester.service.assessing LINK``: the first line from the link is a task, the answer an assessment.
"""

from __future__ import annotations

import socket
import subprocess
from typing import Final

from pydantic import TypeAdapter, ValidationError

from tester.base import clock
from tester.queue.assess import Assessment, AssessTask, assess
from tester.service.child_process import link_to_owner, spawn

TASK: Final[TypeAdapter[AssessTask]] = TypeAdapter(AssessTask)
FOUND: Final[TypeAdapter[Assessment]] = TypeAdapter(Assessment)
WITHIN_S: Final = 120.0
"""Time limit of a look, s [A]: a plan of 100,000 conditions takes some seconds."""
NICE: Final = 5
"""Lower priority: the scan comes first."""
BROKEN_OFF: Final = Assessment(("the look at the recipe has broken off: add it again, or see the service's log",))


class Assessor:
    """One look at a time. ``begin`` it, then ``poll`` until it returns what was found."""

    def __init__(self) -> None:
        """Begin idle."""
        self._process: subprocess.Popen[bytes] | None = None
        self._link: socket.socket | None = None
        self._received = bytearray()
        self._until_s = 0.0

    @property
    def busy(self) -> bool:
        """Whether a look is under way."""
        return self._process is not None

    def begin(self, task: AssessTask) -> None:
        """Begin a look. Raises OSError."""
        self._process, self._link = spawn("tester.service.assessing", ())
        self._link.sendall(TASK.dump_json(task) + b"\n")
        self._link.setblocking(False)
        self._received.clear()
        self._until_s = clock.monotonic() + WITHIN_S

    def poll(self) -> Assessment | None:
        """Return what was found, None while the look is under way. It never waits."""
        link = self._link
        assert link is not None
        try:
            while data := link.recv(1 << 16):
                self._received += data
        except BlockingIOError:
            if clock.monotonic() < self._until_s:
                return None
        except OSError:
            self._received.clear()
        try:
            found = FOUND.validate_json(bytes(self._received))
        except ValidationError:
            found = BROKEN_OFF
        self.end()
        return found

    def end(self) -> None:
        """End a look under way."""
        if self._link is not None:
            self._link.close()
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._process = self._link = None


def look(link: socket.socket) -> None:
    """Carry out the task from the owner at the other end, and send what was found."""
    with link, link.makefile("rb", buffering=0) as stream:
        task = TASK.validate_json(stream.readline())
        try:
            found = assess(task)
        except OSError as error:
            found = Assessment((f"the recipe cannot be kept or read: {error}",))
        link.sendall(FOUND.dump_json(found))


if __name__ == "__main__":
    look(link_to_owner(NICE))
