"""Real-time priority for a process that keeps a machine's time, where the operating system grants it.

Linux: round robin among real-time threads, before every ordinary one; it takes root, CAP_SYS_NICE or an `rtprio` limit
(`ulimit -r`). Elsewhere nothing is asked for: Windows' priority classes were not tried.
"""

from __future__ import annotations

import os
import sys
import threading

LEVEL = 10
"""1 to 99; low: kernel threads that serve interrupts run at 50."""


class RealTimePriority:
    """What this process was granted; ``refused`` says why nothing, "" where it was. ``close`` gives it back."""

    def __init__(self) -> None:
        """Ask for every thread that runs now: one left behind would keep the others waiting for the interpreter."""
        self.refused = ""
        self._threads: list[int] = []
        if sys.platform != "linux":
            self.refused = f"not asked for on {sys.platform}"
            return
        for thread in threading.enumerate():
            if thread.native_id is None:
                continue
            try:
                os.sched_setscheduler(
                    thread.native_id, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(LEVEL)
                )
            except OSError as error:
                self.refused = error.strerror or "refused"
                return
            self._threads.append(thread.native_id)

    def close(self) -> None:
        """Be an ordinary process again; threads that have ended need nothing."""
        if sys.platform != "linux":
            return
        for number in self._threads:
            try:
                os.sched_setscheduler(number, os.SCHED_OTHER, os.sched_param(0))
            except OSError:
                continue
        self._threads.clear()
