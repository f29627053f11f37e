"""`python -m tests.stop.loop FILE`: a bare loop of 20 ms. Writes when it was woken and how late, a line each."""

from __future__ import annotations

import sys
from pathlib import Path

from tester import clock

PERIOD_S = 0.02


def main(file: Path) -> None:
    """Loop until killed."""
    due_s = clock.monotonic()
    with file.open("w", encoding="utf-8", buffering=1) as out:
        while True:
            due_s += PERIOD_S
            late_s = clock.sleep_until(due_s)
            out.write(f"{due_s} {late_s}\n")
            if late_s > PERIOD_S:
                due_s = clock.monotonic()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
