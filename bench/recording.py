"""The recorder: CPU for a row, in the scan's thread and in the writer's, and its share of a core at 100 Hz."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.effort import Effort, TopicFailedError
from bench.figures import Figure
from bench.lateness import bare_loop
from bench.stopwatch import cpu_ns
from tester import clock
from tester.engine.tickers import collector_at_rest
from tester.process import SAMPLE_COLUMNS
from tester.store.writer import RunWriter

PERIOD_S = 0.01
DIFFERENT_ROWS = 997


def measure(effort: Effort) -> list[Figure]:
    """Return rows per CPU second, CPU per row, and the CPU share at 100 Hz beyond a bare loop's."""
    count = effort.pick(400_000, 50_000)
    seconds = effort.pick(10.0, 3.0)
    rows = sample_rows()
    costs = [bulk_us(rows, count) for _ in range(effort.runs)]
    shares = [100.0 * (paced_share(rows, seconds) - bare_loop(seconds, PERIOD_S).cpu_share) for _ in range(effort.runs)]
    return [
        Figure("rows", "per CPU s", tuple(1e6 / cost for cost in costs), note="both threads, to the disk"),
        Figure("a row", "us CPU", tuple(costs)),
        Figure("CPU share at 100 Hz", "% of a core", tuple(shares), note="beyond a bare loop's"),
    ]


def sample_rows() -> list[tuple[float, ...]]:
    """Return rows of which no two are alike, as scans make them."""
    width = len(SAMPLE_COLUMNS)
    return [(*(i * 0.01 + column * 1.7 for column in range(width - 1)), 1.0) for i in range(DIFFERENT_ROWS)]


def bulk_us(rows: list[tuple[float, ...]], count: int) -> float:
    """Write ``count`` rows as fast as it goes and return the CPU us for one, commits and close included."""
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        begun = cpu_ns()
        with closing(RunWriter(Path(folder) / "run.db", clock=clock.monotonic, lossless=True)) as writer:
            sample = writer.sample
            for i in range(count):
                sample(rows[i % DIFFERENT_ROWS])
        used = cpu_ns() - begun
        _check(writer)
    return used * 1e-3 / count


def paced_share(rows: list[tuple[float, ...]], seconds: float) -> float:
    """Write a row every 10 ms in real time and return the share of a core, 0..1, of loop and recorder."""
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        with closing(RunWriter(Path(folder) / "run.db", clock=clock.monotonic)) as writer, collector_at_rest():
            begun, origin = cpu_ns(), clock.monotonic()
            for number in range(round(seconds / PERIOD_S)):
                clock.sleep_until(origin + number * PERIOD_S)
                writer.sample(rows[number % DIFFERENT_ROWS])
            used, taken = (cpu_ns() - begun) * 1e-9, clock.monotonic() - origin
        _check(writer)
    return used / taken


def _check(writer: RunWriter) -> None:
    if writer.failed or writer.overruns:
        raise TopicFailedError(f"not every row was written: {writer.failed or writer.overruns}")
