"""`python -m tests.campaigns.latency [--seconds 600] [--idle] [--keep DIR]`: from a sample to the command it led to.

`tester sim` logs every frame; `tester run` controls the rig over TCP in real time while it slides under load. Beside
both, unless `--idle`: one busy process a core and one that writes and syncs to the disk without a pause. The definition
of the figures is in tests/realtime/frames.py. Prints a line a figure; exit code 1 where one misses.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.base import clock
from tests.campaigns.acceptance.figure import Figure, at_least, at_most, holds
from tests.realtime.frames import Latencies, latencies, share
from tests.realtime.processes import LOADED_N, SLIDING_M_S, NotReachedError, sliding
from tests.realtime.state import Row

ASKED_P99_S = 0.02
TRIP_S = 0.15
"""A scan later than this trips."""
SLIDING_SHARE = 0.8
"""Minimum share of the samples at 100 Hz that must count: between two slip pulses the wheel rolls."""

SPIN = "while True: pass"
WRITE = """
import os, sys
block = os.urandom(1 << 20)
with open(sys.argv[1], "wb", buffering=0) as file:
    while True:
        file.seek(0)
        for _ in range(16):
            file.write(block)
        os.fsync(file.fileno())
"""


@contextmanager
def load(folder: Path) -> Iterator[None]:
    """Keep every core and the disk busy."""
    commands: list[list[str]] = [[sys.executable, "-c", SPIN] for _ in range(os.cpu_count() or 1)]
    commands.append([sys.executable, "-c", WRITE, str(folder / "load.bin")])
    processes = [subprocess.Popen(command) for command in commands]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


class Counting:
    """Determines from the state log whether the rig slid under load at a time."""

    def __init__(self, rows: Sequence[Row], from_s: float, to_s: float) -> None:
        self._times = [row.time_s for row in rows]
        self._slid = [row.slip_m_s > SLIDING_M_S and row.force_z_n > LOADED_N for row in rows]
        self._from_s, self._to_s = from_s, to_s

    def __call__(self, t: float) -> bool:
        at = bisect_right(self._times, t) - 1
        return self._from_s <= t <= self._to_s and 0 <= at < len(self._slid) and self._slid[at]


def observe(folder: Path, seconds: float, *, idle: bool) -> tuple[Latencies, str]:
    """Let a run slide for a while; return its latencies and why it ended early, "" if it did not."""
    with sliding(folder, bus_log=True) as (sim, run), nullcontext() if idle else load(folder):
        print(f"priority: tester sim {policy_of(sim.process.pid)}, tester run {policy_of(run.process.pid)}", flush=True)
        began_s = sim.state.rows[-1].time_s
        give_up = clock.monotonic() + seconds
        while clock.monotonic() < give_up and run.process.poll() is None:
            clock.sleep_until(clock.monotonic() + 0.5)
        ended = run.said() if run.process.poll() is not None else ""
        sim.state.fresh()
        rows = sim.state.rows
        sim.stop()  # completes its logs
        print(sim.errors.read_text(encoding="utf-8").strip().replace("ended", "tester sim"), flush=True)
    return latencies(sim.bus_log, Counting(rows, began_s, rows[-1].time_s)), ended


def policy_of(pid: int) -> str:
    """Return as text whether a process has real-time priority: without it, the competing load determines the
    figures."""
    if sys.platform != "linux":
        return "ordinary"
    return "real-time" if os.sched_getscheduler(pid) & ~os.SCHED_RESET_ON_FORK == os.SCHED_RR else "ordinary"


def figures_of(found: Latencies, ended: str, seconds: float) -> list[Figure]:
    """Compare with the limits."""
    most = max(found.sync_periods_s, default=inf)
    return [
        holds("no trip", not ended, ended or "none", "none"),
        at_least("drive samples while sliding under load", len(found.drives_s), SLIDING_SHARE * 100.0 * seconds),
        at_most("drive sample to command, p99", 1e3 * share(found.drives_s, 0.99), 1e3 * ASKED_P99_S, "ms", 2),
        holds("drive sample to command, median and maximum", True, _spread(found.drives_s), "no limit"),
        at_most("load cell sample to command, p99", 1e3 * share(found.cell_s, 0.99), 1e3 * ASKED_P99_S, "ms", 2),
        holds("load cell sample to command, median and maximum", True, _spread(found.cell_s), "no limit"),
        holds("SYNC period, median and maximum", True, _spread(found.sync_periods_s), "10 ms"),
        at_most("latest scan", 1e3 * (most - 0.01), 1e3 * TRIP_S, "ms", 1, note=" (later ones trip)"),
    ]


def _spread(values: Sequence[float]) -> str:
    if not values:
        return "none"
    return f"{1e3 * share(values, 0.5):.2f} ms, {1e3 * max(values):.2f} ms of {len(values)}"


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.latency", description="Sample to command on the wire.")
    parser.add_argument("--seconds", type=float, default=600.0, help="how long to measure, s (default 600)")
    parser.add_argument("--idle", action="store_true", help="without load beside it")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep logs and runs in this folder")
    read = parser.parse_args(arguments)
    with TemporaryDirectory(prefix="latency-", ignore_cleanup_errors=True) as temporary:
        folder = (read.keep or Path(temporary)).resolve()
        try:
            figures = figures_of(*observe(folder, read.seconds, idle=read.idle), read.seconds)
        except NotReachedError as error:
            figures = [holds("a run that slides", False, str(error), "sliding under load")]
    for figure in figures:
        print(figure, flush=True)
    return 0 if all(figure.ok for figure in figures) else 1


if __name__ == "__main__":
    sys.exit(main())
