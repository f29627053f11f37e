"""`python -m tests.campaigns.stop.loop FILE PHASE`: a bare loop of 20 ms. Writes when it woke, how late.

It wakes at PHASE (s) after whole multiples of its period, so that several loops never wake together.
"""

from __future__ import annotations

import sys
from pathlib import Path

from tester.base import clock

PERIOD_S = 0.02


def main(file: Path, phase_s: float) -> None:
    """Loop until killed."""
    due_s = next_due_s(phase_s)
    with file.open("w", encoding="utf-8", buffering=1) as out:
        while True:
            due_s += PERIOD_S
            late_s = clock.sleep_until(due_s)
            out.write(f"{due_s} {late_s}\n")
            if late_s > PERIOD_S:
                due_s = next_due_s(phase_s)


def next_due_s(phase_s: float) -> float:
    """Return the last moment of the grid."""
    return (clock.monotonic() // PERIOD_S) * PERIOD_S + phase_s


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]))
