"""The only place that reads a clock or sleeps. Everything else is handed its time."""

from __future__ import annotations

import time
from datetime import UTC, datetime, timedelta


def monotonic() -> float:
    """Return seconds of a clock that never jumps (undefined origin)."""
    return time.monotonic()


def cpu_seconds() -> float:
    """Return the CPU seconds this process has used."""
    return time.process_time()


def sleep_until(deadline_s: float) -> float:
    """Sleep until the monotonic ``deadline_s``; return how late it woke, in s (0 when the deadline had passed by less).

    An absolute deadline does not accumulate the lateness of earlier waits.
    """
    delay = deadline_s - time.monotonic()
    if delay > 0.0:
        time.sleep(delay)
    return max(0.0, time.monotonic() - deadline_s)


def utc_now() -> str:
    """Return the wall clock as ISO 8601 text in UTC, for records only; never for control."""
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


def local_stamp() -> str:
    """Return the local wall clock as a folder-safe text, ``2024-02-21T14-05-09``."""
    return datetime.now().strftime("%Y-%m-%dT%H-%M-%S")


def utc_in(seconds: float) -> str:
    """Return the wall clock in so many seconds from now as ISO 8601 text in UTC, for people only."""
    return (datetime.now(UTC) + timedelta(seconds=seconds)).isoformat(timespec="seconds").replace("+00:00", "Z")
