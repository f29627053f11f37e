"""Latency of the controlling program, from sample to command, from the bus logs of `tester sim`.

All times are the simulator's, on its side of the wire. Drives sample at SYNC and answer with their TPDOs; the load cell
samples when a request is complete. A scan is a burst of RPDO1s and the SYNC after them. A scan counts as reflecting a
sample only if its first RPDO1 came ``GUARD_S`` or more after the sample's last frame was on its way to the program: one
that came sooner may have been computed without it, and the next one counts.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

GUARD_S = 0.002
"""A scan takes less than this from what it takes in to what it sends (0.2 ms of CPU), s [A]."""
_LINE = re.compile(r"\((\d+\.\d+)\) \S+ ([0-9A-F]{3})#")
_SYNC, _RPDO1, _TPDO1 = 0x080, range(0x201, 0x280), range(0x181, 0x200)
_PRESS = 0x203


@dataclass(slots=True)
class Scan:
    """One scan as it arrived on the wire, and the drives' answers to its SYNC."""

    first_s: float
    press_s: float = 0.0
    last_s: float = 0.0
    sync_s: float = 0.0
    answered_s: float = 0.0


@dataclass(slots=True)
class Latencies:
    """Seconds from sample to command, for drives and load cell, and between two SYNCs."""

    drives_s: list[float] = field(default_factory=list[float])
    cell_s: list[float] = field(default_factory=list[float])
    sync_periods_s: list[float] = field(default_factory=list[float])


def scans_of(can_log: Path) -> list[Scan]:
    """Return the scans of a candump log, those with a SYNC."""
    scans: list[Scan] = []
    scan: Scan | None = None
    with can_log.open(encoding="utf-8") as lines:
        for line in lines:
            found = _LINE.match(line)
            if found is None:
                continue
            t, can_id = float(found[1]), int(found[2], 16)
            if can_id in _RPDO1:
                scan = scan or Scan(t)
                scan.last_s = t
                if can_id == _PRESS:
                    scan.press_s = t
            elif can_id == _SYNC and scan is not None:
                scan.sync_s = scan.answered_s = t
                scans.append(scan)
                scan = None
            elif can_id in _TPDO1 and scans:
                scans[-1].answered_s = max(scans[-1].answered_s, t)
    return scans


def cell_samples(line_log: Path) -> list[tuple[float, float]]:
    """Return (request complete, reply complete) of every answered request of a Modbus log, s."""
    samples: list[tuple[float, float]] = []
    asked: float | None = None
    with line_log.open(encoding="utf-8") as lines:
        for line in lines:
            stamp, direction, _ = line.split(" ", 2)
            t = float(stamp.strip("()"))
            if direction == "TX":
                asked = t
            elif asked is not None:
                samples.append((asked, t))
                asked = None
    return samples


def latencies(bus_log: Path, counts: Callable[[float], bool]) -> Latencies:
    """Work out the latencies of the samples taken at times that count (s of the rig)."""
    scans = scans_of(bus_log / "can.log")
    starts = [scan.first_s for scan in scans]
    found = Latencies()
    for scan, following in pairwise(scans):
        if not counts(scan.sync_s):
            continue
        found.sync_periods_s.append(following.sync_s - scan.sync_s)
        reflected = bisect_left(starts, scan.answered_s + GUARD_S)
        if reflected < len(scans):
            found.drives_s.append(scans[reflected].last_s - scan.sync_s)
    for asked, replied in cell_samples(bus_log / "modbus-load_cell.log"):
        reflected = bisect_left(starts, replied + GUARD_S)
        if counts(asked) and reflected < len(scans):
            found.cell_s.append(scans[reflected].press_s - asked)
    return found


def share(values: Sequence[float], part: float) -> float:
    """Return the value that ``part`` of all do not exceed; NaN for none."""
    ordered = sorted(values)
    return ordered[max(0, round(part * len(ordered)) - 1)] if ordered else float("nan")
