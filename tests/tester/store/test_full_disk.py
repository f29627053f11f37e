"""A full disk, and a removed record: reported in words, and everything that can be kept is kept."""

from __future__ import annotations

import os
import random
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.store.disk import RESERVE
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tests.tester.store.build import CONDITIONS, RUN, SPECIMENS, Clock, result, utc

DISK_BYTES = 2_000_000


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    """A separate file system of 2 MB, where the system allows one."""
    folder = tmp_path / "disk"
    folder.mkdir()
    made = False
    with suppress(OSError):
        command = ["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs", str(folder)]
        made = subprocess.run(command, check=False, capture_output=True).returncode == 0
    if not made:
        pytest.skip("no file system may be mounted here")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=True)


def begun(folder: Path, clock: Clock, reserve: int = 0) -> RunWriter:
    writer = RunWriter(folder / "run.db", QUANTITIES, clock=clock, utc=utc, synchronous=True, reserve=reserve)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    return writer


def fill(folder: Path) -> Path:
    """Fill the remaining space."""
    ballast = folder / "ballast"
    with suppress(OSError), ballast.open("wb", buffering=0) as file:
        while True:
            file.write(bytes(4096))
    return ballast


def measure(writer: RunWriter, repeats: int) -> int:
    """Record repeats of 500 samples that do not compress until the disk is full; return how many were."""
    noise = random.Random(1)
    for repeat in range(1, repeats + 1):
        key = writer.begin_repeat(1, repeat, 1)
        for _ in range(500):
            values = [noise.random() for _ in QUANTITIES.names]
            values[QUANTITIES.index("repeat_key")] = float(key)
            writer.sample(tuple(values))
        writer.commit_repeat(key, result())
        if writer.failed is not None:
            return repeat
    raise AssertionError("the disk is not full")


def ended(folder: Path) -> tuple[str, str, int, int]:
    """Return status, reason, committed repeats and samples."""
    with RunReader(folder) as reader:
        run, rows = reader.run(), sum(block.rows for block in reader.sample_blocks())
        assert reader.chain().problems == ()
        return run.status, run.reason, len(reader.repeats()), rows


def test_the_reserved_space_takes_the_last_entries_of_the_run(disk: Path) -> None:
    clock = Clock()
    writer = begun(disk, clock, reserve=800_000)
    assert (disk / f"run.db{RESERVE}").stat().st_size == 800_000
    fill(disk)
    count = measure(writer, 20)
    assert writer.failed == "the disk is full: make room, or choose a folder on another disk"
    writer.finish("stopped", f"the run can no longer be recorded: {writer.failed}", 60.0)
    clock.now += 1.0
    writer.service()
    writer.close()
    assert writer.lost is None and not (disk / f"run.db{RESERVE}").exists()
    status, reason, repeats, rows = ended(disk)
    assert (status, repeats, rows) == ("stopped", count, 500 * count)
    assert "the disk is full" in reason


def test_without_that_room_everything_is_written_once_room_returns(disk: Path) -> None:
    clock = Clock()
    writer = begun(disk, clock)
    ballast = fill(disk)
    count = measure(writer, 20)
    for _ in range(3):
        clock.now += 1.0
        writer.service()
    assert writer.lost is not None
    ballast.unlink()
    clock.now += 1.0
    writer.service()
    assert writer.lost is None
    writer.finish("stopped", "full", 60.0)
    clock.now += 1.0
    writer.service()
    writer.close()
    assert ended(disk) == ("stopped", "full", count, 500 * count)


def test_a_run_that_ends_with_the_disk_still_full_reports_a_loss(disk: Path) -> None:
    writer = begun(disk, Clock())
    fill(disk)
    count = measure(writer, 20)
    writer.finish("stopped", "full", 60.0)
    writer.close()
    assert writer.lost is not None and "the disk is full" in writer.lost
    assert ended(disk)[2] < count


def test_where_so_much_room_cannot_be_kept_the_run_begins_without(disk: Path) -> None:
    writer = begun(disk, Clock(), reserve=2 * DISK_BYTES)
    assert not (disk / f"run.db{RESERVE}").exists() and writer.failed is None
    writer.close()


@pytest.mark.skipif(os.name != "posix", reason="Windows removes no file that is open")
@pytest.mark.parametrize("how", ["removed", "moved", "exchanged"])
def test_a_record_that_is_taken_away_is_noticed_at_the_next_commit(tmp_path: Path, how: str) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    writer = begun(folder, Clock())
    assert writer.failed is None
    if how == "moved":
        folder.rename(tmp_path / "elsewhere")
    else:
        (folder / "run.db").unlink()
    if how == "exchanged":
        (folder / "run.db").write_bytes(b"")
    ticket = writer.commit_repeat(writer.begin_repeat(1, 1, 1), result())
    assert not ticket.done and writer.failed is not None
    assert writer.failed.endswith("run.db was removed, or another file put in its place")
    writer.close()
    assert writer.lost is not None
