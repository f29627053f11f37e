"""`tester`, with a person who presses the STOP key after a share of the run's time.

Run as a file, by the Python of any installation: python stopping.py SHARE run RECIPE ... A run that ends earlier is not
stopped.
"""

from __future__ import annotations

import sys

from tester.cli import console
from tester.cli.main import main
from tester.machine.context import Progress
from tester.machine.time_left import RunPosition


class Stopping(console.Console):
    """A console with an impatient operator."""

    at_share = 1.0
    pressed = False
    done = 0.0

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        """Store the run's progress."""
        self.done = at.share
        super().show(now_s, run, at)

    def commands(self) -> list[str]:
        """Return the command to stop, once."""
        if self.pressed or self.done < self.at_share:
            return []
        self.pressed = True
        return ["stop"]


if __name__ == "__main__":
    Stopping.at_share = float(sys.argv.pop(1))
    console.Console = Stopping
    sys.exit(main())
