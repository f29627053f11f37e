"""A bare echo on a pseudo-terminal: how many replies come too late there without our code.

The far end answers each request after the time of line and device, from a loop that does nothing else; the near end
polls as often as a run polls its load cell, waits as long as a run, and looks for replies as often.
"""

from __future__ import annotations

import argparse
import json
import os
import select
import subprocess
import sys
from dataclasses import dataclass

from drivers.transports.serial_line import open_serial_line
from tester.base import clock
from tester.base.processes import RealTimePriority

REQUEST, REPLY = bytes(8), bytes(23)
BAUD = 115200
PERIOD_S = 0.01
PATIENCE_S = 0.0154
"""Time-out of the load cell's profile on its line: wire times, 8 ms for the device, 3 ms margin, s."""
ANSWERS_AFTER_S = (len(REQUEST) + len(REPLY)) * 10 / BAUD + 0.00175 + 0.001
LOOK_S = 0.001
"""A run looks for replies at the ticks of its lines, which are at least this far apart."""


@dataclass(frozen=True, slots=True)
class Echoed:
    """The results of the requests."""

    requests: int
    timeouts: int


def ask(port: str, seconds: float) -> Echoed:
    """Send requests for so long."""
    priority = RealTimePriority()
    line = open_serial_line(port, BAUD)
    requests = timeouts = 0
    end = due = clock.monotonic()
    end += seconds
    try:
        while due < end:
            due = max(due + PERIOD_S, clock.monotonic())
            clock.sleep_until(due)
            line.read(due)  # discard late replies
            asked = clock.monotonic()
            line.write(REQUEST, asked)
            requests += 1
            got = 0
            while got < len(REPLY) and clock.monotonic() - asked < PATIENCE_S:
                clock.sleep_until(clock.monotonic() + LOOK_S)
                got += sum(len(data) for _, data in line.read(clock.monotonic()))
            timeouts += got < len(REPLY)
    finally:
        line.close()
        priority.close()
    return Echoed(requests, timeouts)


def answer(far: int) -> None:
    """Answer until the standard input ends."""
    priority = RealTimePriority()
    try:
        received = 0
        while True:
            ready, _, _ = select.select([far, sys.stdin], [], [])
            if sys.stdin in ready:
                return
            now = clock.monotonic()
            received += len(os.read(far, 4096))
            if received >= len(REQUEST):
                received = 0
                clock.sleep_until(now + ANSWERS_AFTER_S)
                os.write(far, REPLY)
    finally:
        priority.close()


class Echo:
    """Both ends in processes of their own, beside other work."""

    def __init__(self, seconds: float) -> None:
        """Begin."""
        import tty

        self._far, self._near = os.openpty()
        tty.setraw(self._near)
        command = [sys.executable, "-m", "tests.campaigns.doors.echo"]
        self._answering = subprocess.Popen(
            [*command, "--answer", str(self._far)], stdin=subprocess.PIPE, pass_fds=[self._far]
        )
        self._asking = subprocess.Popen(
            [*command, "--ask", os.ttyname(self._near), str(seconds)], stdout=subprocess.PIPE, text=True
        )

    def result(self) -> Echoed:
        """Wait for the end."""
        output, _ = self._asking.communicate()
        self.close()
        return Echoed(**json.loads(output))

    def close(self) -> None:
        """End both."""
        self._asking.kill()
        self._asking.wait()
        if self._answering.stdin is not None and not self._answering.stdin.closed:
            self._answering.stdin.close()
        self._answering.wait()
        for end in (self._far, self._near):
            if end >= 0:
                os.close(end)
        self._far = self._near = -1


def main() -> None:
    """Run one end."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--answer", type=int)
    parser.add_argument("--ask", nargs=2)
    read = parser.parse_args()
    if read.answer is not None:
        answer(read.answer)
    else:
        port, seconds = read.ask
        found = ask(port, float(seconds))
        print(json.dumps({"requests": found.requests, "timeouts": found.timeouts}))


if __name__ == "__main__":
    main()
