"""The recorder: CPU for a row, its share of a core at 100 Hz, samples lost at 1 kHz, lateness beside a disk hog."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Generator
from contextlib import closing, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, at_most
from bench.lateness import bare_loop
from bench.stopwatch import cpu_ns
from tester.base import clock
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.machine.tickers import collector_at_rest
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter

PERIOD_S = 0.01
FAST_PERIOD_S = 0.001
SHARE_LIMIT_PERCENT = 2.0
LATE_LIMIT_MS = 20.0
"""Limit of a scan's lateness due to the recorder, with a disk hog beside it."""
HOG = """
import os, sys
block = os.urandom(8 << 20)
while True:
    with open(sys.argv[1], "wb") as file:
        for _ in range(16):
            file.write(block)
            os.fsync(file.fileno())
"""
DIFFERENT_ROWS = 997


def measure(effort: Effort) -> list[Figure]:
    """Return rows per CPU second, CPU per row, and the CPU share at 100 Hz beyond a bare loop's."""
    count = effort.pick(400_000, 50_000)
    seconds = effort.pick(10.0, 3.0)
    rows = sample_rows()
    costs = [bulk_us(rows, count) for _ in range(effort.runs)]
    shares = [100.0 * (paced_share(rows, seconds) - bare_loop(seconds, PERIOD_S).cpu_share) for _ in range(effort.runs)]
    lost = [float(lost_samples(rows, seconds)) for _ in range(effort.runs)]
    calls, late = zip(*[beside_disk_hog(rows, seconds) for _ in range(effort.runs)], strict=True)
    return [
        Figure("rows", "per CPU s", tuple(1e6 / cost for cost in costs), note="both threads, to the disk"),
        Figure("a row", "us CPU", tuple(costs)),
        Figure(
            "CPU share at 100 Hz", "% of a core", tuple(shares), at_most(SHARE_LIMIT_PERCENT), "beyond a bare loop's"
        ),
        Figure("samples lost at 1 kHz", "samples", tuple(lost), at_most(0.0, worst=True)),
        Figure(
            "longest call beside a disk hog", "ms", calls, at_most(LATE_LIMIT_MS, worst=True), "in the scan's thread"
        ),
        Figure("latest scan beside a disk hog", "ms", late, at_most(LATE_LIMIT_MS), "beyond a bare loop's latest"),
    ]


def sample_rows() -> list[tuple[float, ...]]:
    """Return rows that all differ, like those of scans."""
    width = len(QUANTITIES.names)
    return [(*(i * 0.01 + column * 1.7 for column in range(width - 1)), 1.0) for i in range(DIFFERENT_ROWS)]


def bulk_us(rows: list[tuple[float, ...]], count: int) -> float:
    """Write ``count`` rows as fast as it goes and return the CPU us for one, including commits and close."""
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        begun = cpu_ns()
        with closing(RunWriter(Path(folder) / "run.db", QUANTITIES, clock=clock.monotonic, lossless=True)) as writer:
            sample = writer.sample
            for i in range(count):
                sample(rows[i % DIFFERENT_ROWS])
        used = cpu_ns() - begun
        _check(writer)
    return used * 1e-3 / count


def paced_share(rows: list[tuple[float, ...]], seconds: float) -> float:
    """Write a row every 10 ms in real time and return the share of a core, 0..1, of loop and recorder."""
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        with (
            closing(RunWriter(Path(folder) / "run.db", QUANTITIES, clock=clock.monotonic)) as writer,
            collector_at_rest(),
        ):
            begun, origin = cpu_ns(), clock.monotonic()
            for number in range(round(seconds / PERIOD_S)):
                clock.sleep_until(origin + number * PERIOD_S)
                writer.sample(rows[number % DIFFERENT_ROWS])
            used, taken = (cpu_ns() - begun) * 1e-9, clock.monotonic() - origin
        _check(writer)
    return used / taken


def lost_samples(rows: list[tuple[float, ...]], seconds: float) -> int:
    """Write a row every millisecond in real time and return how many are missing in the file."""
    count = round(seconds / FAST_PERIOD_S)
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        with (
            closing(RunWriter(Path(folder) / "run.db", QUANTITIES, clock=clock.monotonic)) as writer,
            collector_at_rest(),
        ):
            origin = clock.monotonic()
            for number in range(count):
                clock.sleep_until(origin + number * FAST_PERIOD_S)
                writer.sample(rows[number % DIFFERENT_ROWS])
        if writer.failed:
            raise TopicFailedError(writer.failed)
        with RunReader(Path(folder)) as reader:
            return count - sum(block.rows for block in reader.sample_blocks())


def beside_disk_hog(rows: list[tuple[float, ...]], seconds: float) -> tuple[float, float]:
    """Return the longest call of the recorder, and the excess of the greatest lateness over a bare loop's, in ms."""
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder, disk_hog(Path(folder)):
        bare, _ = latest(None, rows, seconds)
        with closing(RunWriter(Path(folder) / "run.db", QUANTITIES, clock=clock.monotonic)) as writer:
            late, longest = latest(writer, rows, seconds)
        _check(writer)
    return 1e3 * longest, 1e3 * max(late - bare, 0.0)


def latest(writer: RunWriter | None, rows: list[tuple[float, ...]], seconds: float) -> tuple[float, float]:
    """Loop at 100 Hz, with an urgent commit a second; return the greatest lateness and the longest call, s."""
    late = longest = 0.0
    with collector_at_rest():
        origin = clock.monotonic()
        for number in range(round(seconds / PERIOD_S)):
            late = max(late, clock.sleep_until(origin + number * PERIOD_S))
            if writer is not None:
                begun = clock.monotonic()
                writer.sample(rows[number % DIFFERENT_ROWS])
                if number % 100 == 99:
                    writer.event(number * PERIOD_S, "bench", "a repeat is over", "alarm")
                longest = max(longest, clock.monotonic() - begun)
    return late, longest


@contextmanager
def disk_hog(folder: Path) -> Generator[None]:
    """Keep the disk busy from another process while the block lasts."""
    process = subprocess.Popen([sys.executable, "-c", HOG, str(folder / "hog")])
    try:
        yield
    finally:
        process.kill()
        process.wait()


def _check(writer: RunWriter) -> None:
    if writer.failed or writer.overruns:
        raise TopicFailedError(f"not every row was written: {writer.failed or writer.overruns}")
