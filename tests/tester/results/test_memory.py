"""Exports of long runs stay in bounded memory."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from pathlib import Path

import pytest

from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.results.formats import FORMATS, Record
from tester.results.run_files import write_format
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tests.tester.store.build import RUN, Clock, row

MB = 1e6


def recorded(folder: Path, rows: int) -> Path:
    """Write a run of so many samples, no two alike."""
    folder.mkdir()
    writer = RunWriter(folder / "run.db", QUANTITIES, clock=Clock(), synchronous=True)
    writer.begin_run(RUN, [], [])
    base = row(0.0)
    for i in range(rows):
        writer.sample((0.01 * i, *(value + 0.05 * (i % 97) for value in base[1:-1]), 0.0))
    writer.close()
    return folder


def peak_mb(folder: Path, kind: str) -> float:
    """Return Python's peak memory during an export of a run's samples."""
    with RunReader(folder) as reader:
        tracemalloc.start()
        try:
            write_format(folder / FORMATS[kind].file, FORMATS[kind], Record(reader))
            return tracemalloc.get_traced_memory()[1] / MB
        finally:
            tracemalloc.stop()


def test_csv_takes_no_more_memory_for_a_run_five_times_as_long(tmp_path: Path) -> None:
    short, long = recorded(tmp_path / "short", 1500), recorded(tmp_path / "long", 7500)
    assert peak_mb(long, "samples") < 1.2 * peak_mb(short, "samples")


EXPORT = """
import resource, sys
from pathlib import Path
from tester.results.run_files import write_format
from tester.results.formats import FORMATS, Record
from tester.store.run_reader import RunReader
folder, kind = Path(sys.argv[1]), sys.argv[2]
with RunReader(folder) as reader:
    write_format(folder / FORMATS[kind].file, FORMATS[kind], Record(reader))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


@pytest.fixture(scope="module")
def eight_hours(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of eight hours in slip: 2.88 million samples."""
    return recorded(tmp_path_factory.mktemp("long") / "run", 8 * 3600 * 100)


@pytest.mark.campaign
@pytest.mark.skipif(sys.platform != "linux", reason="ru_maxrss counts other units elsewhere")
@pytest.mark.parametrize("kind, most_mb", [("samples", 100.0), ("parquet", 400.0)])
def test_eight_hours_export_in_bounded_memory(eight_hours: Path, kind: str, most_mb: float) -> None:
    command = [sys.executable, "-c", EXPORT, str(eight_hours), kind]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    peak = 1024 * int(done.stdout) / MB
    print(f"{kind}: {peak:.0f} MB at most")
    assert peak < most_mb
