"""`python -m tests.campaigns.stop.owner FOLDER`: `tester serve` on the simulated rig; records when STOP is in control.

The operator's STOP is carried out, as is any that comes before a run ticks. Any other STOP is followed to the point
where the run would receive it, recorded and dropped there, so that one run survives two hundred of them. Each scan is
also recorded, with its due time.
"""

from __future__ import annotations

import sys
from array import array
from pathlib import Path
from typing import Any

from tester.base import clock
from tester.machine.tickers import Ticked, TickedWorld, run_simulated
from tester.run import part_run, preconditions
from tester.service import service
from tester.service.command_handler import Orders
from tester.service.service import ServiceOptions
from tester.service.service_process import host
from tester.service.stop_lane import StopLane

OPERATOR, PROBE = "operator", "probe-"
STOPS, SCANS = "stops.txt", "scans.bin"


class Noted:
    """A run whose scans are recorded: clock time of each beginning, and its due time (rig time), s."""

    def __init__(self, run: Ticked, notes: array[float]) -> None:
        self.run, self.notes = run, notes

    @property
    def finished(self) -> bool:
        """As of the run."""
        return self.run.finished

    @property
    def waiting(self) -> bool:
        """As of the run."""
        return self.run.waiting

    def tick(self, now: float) -> float:
        """Record the scan, and do it."""
        self.notes.append(clock.monotonic())
        self.notes.append(now)
        return self.run.tick(now)


def note_stops(file: Path) -> None:
    """Write the sender of each STOP, and when it was in control (tester.base.clock.monotonic), a line each.

    ``kept``: while nothing ticks the lane's thread keeps it, and nothing begins any more. ``done``: it is carried out;
    one that was already kept also covers those that came after it.
    """
    carry_out, end = Orders.stop, StopLane.end_ticking
    take = StopLane._take  # pyright: ignore[reportPrivateUsage]
    written = file.open("w", encoding="utf-8", buffering=1)
    stood_for: list[str] = []
    early: set[str] = set()

    def stop(self: Orders, name: str, fast: bool) -> None:
        names = [name, *stood_for]
        stood_for.clear()
        real = [one for one in names if self.desk.watch is None or one in early]
        found = [one for one in names if OPERATOR in one or (PROBE in one and one in real)]
        if found:  # the planned run does not begin, or does not move
            carry_out(self, found[0], fast)
        else:
            self.desk.tell("command", f"stop by {name}", "warning")
        written.write("".join(f"{clock.monotonic()} done {one}\n" for one in names))

    def recorded_take(self: StopLane, line: str) -> None:
        before = len(self._wishes)  # pyright: ignore[reportPrivateUsage]
        name = line.split(" ", 3)[-1]
        if not self.ticking:  # recorded before the answer: the receiver of the answer looks for the record
            early.add(name)
            written.write(f"{clock.monotonic()} kept {name}\n")
        take(self, line)
        if len(self._wishes) == before:  # pyright: ignore[reportPrivateUsage]
            stood_for.append(name)

    def rested(self: StopLane) -> None:
        for wish in self._wishes:  # pyright: ignore[reportPrivateUsage]
            written.write(f"{clock.monotonic()} kept {wish.name}\n")
        end(self)

    Orders.stop, StopLane._take = stop, recorded_take  # pyright: ignore[reportPrivateUsage]
    StopLane.end_ticking = rested


def note_scans(file: Path) -> None:
    """Append the scans of each run."""

    def ticked(engine: Ticked, world: TickedWorld, **options: Any) -> float:
        notes: array[float] = array("d")
        try:
            return run_simulated(Noted(engine, notes), world, **options)
        finally:
            with file.open("ab") as out:
                notes.tofile(out)

    part_run.run_simulated = ticked  # type: ignore[assignment]
    service.run_simulated = ticked  # type: ignore[assignment]


def main(folder: Path) -> int:
    """Serve until the process ends.

    The plan of 200,000 conditions matters, not the 245 GB of its record: its runs are stopped before they fill a disk.
    """
    preconditions.too_little_room = lambda folder, needed: ""
    note_stops(folder / STOPS)
    note_scans(folder / SCANS)
    return host(ServiceOptions(runs=folder / "runs"), f"unix:{folder / 'service.sock'}", None, "")


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
