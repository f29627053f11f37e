"""The writer: its commits, their times, and failures."""

from __future__ import annotations

import copy
import os
import signal
import sqlite3
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from tester.analysis.results import ConditionStatus, RepeatStatus
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.store.record_schema import StoreError
from tester.store.recorder import NullRecorder, Recorder
from tester.store.records import PieceInfo, SessionInfo
from tester.store.run_reader import RunReader
from tester.store.sample_blocks import BLOCK_ROWS
from tester.store.writer import LOSSLESS_LIMIT, RunWriter
from tests.tester.store.build import (
    BURSTS,
    CONDITIONS,
    RUN,
    SPECIMENS,
    Clock,
    open_writer,
    result,
    row,
    small_run,
)


def count(folder: Path, sql: str) -> int:
    """Return another process's view: committed rows only."""
    connection = sqlite3.connect(f"file:{folder / 'run.db'}?mode=ro", uri=True)
    found: int = connection.execute(sql).fetchone()[0]
    connection.close()
    return found


def rows_on_disk(folder: Path) -> int:
    return count(folder, "SELECT coalesce(sum(rows), 0) FROM sample_block")


def setting(writer: RunWriter, name: str) -> object:
    """Return a setting of the writer's own connection, visible only there."""
    return writer._connection.execute(f"PRAGMA {name}").fetchone()[0]


def limit_pages(writer: RunWriter, pages: object) -> None:
    """Limit the file to so many pages; SQLite then raises the error of a full disk."""
    writer._connection.execute(f"PRAGMA max_page_count = {pages}")


def begun(folder: Path, clock: Clock | None = None, **options: bool) -> RunWriter:
    writer = RunWriter(folder / "run.db", QUANTITIES, clock=clock or Clock(), synchronous=True, **options)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    return writer


def test_the_file_is_written_with_full_synchronisation_and_a_log(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    assert setting(writer, "journal_mode") == "wal"
    assert setting(writer, "synchronous") == 2
    writer.close()


def test_a_closed_file_is_complete_by_itself(tmp_path: Path) -> None:
    small_run(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["run.db"]


def test_a_committed_repeat_is_on_disk_when_its_ticket_is_done(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    key = writer.begin_repeat(1, 1, 1)
    for i in range(7):
        writer.sample(row(0.01 * i, float(key)))
    ticket = writer.commit_repeat(key, result(), BURSTS)
    assert ticket.done
    assert rows_on_disk(tmp_path) == 7
    assert count(tmp_path, "SELECT count(*) FROM repeat WHERE status = 'valid'") == 1
    assert count(tmp_path, "SELECT count(*) FROM burst") == 2
    writer.close()


def test_samples_wait_for_the_second_to_end(tmp_path: Path) -> None:
    clock = Clock()
    writer = begun(tmp_path, clock)
    for i in range(BLOCK_ROWS + 1):
        writer.sample(row(0.01 * i))
    assert rows_on_disk(tmp_path) == 0
    clock.now += 1.0
    for i in range(BLOCK_ROWS):
        writer.sample(row(10.0 + 0.01 * i))
    assert rows_on_disk(tmp_path) >= BLOCK_ROWS
    writer.close()


def test_an_alarm_is_committed_at_once_with_earlier_rows(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    writer.event(1.0, "step", "heating")
    assert count(tmp_path, "SELECT count(*) FROM event") == 0
    writer.event(1.1, "interlock", "surface above 95 degC", "alarm")
    assert count(tmp_path, "SELECT count(*) FROM event") == 2
    writer.close()


@pytest.mark.parametrize("verb", ["trip", "flush", "end_condition", "finish", "wheel"])
def test_urgent_rows_are_committed_at_once(tmp_path: Path, verb: str) -> None:
    writer = begun(tmp_path)
    writer.event(1.0, "step", "heating")
    if verb == "trip":
        writer.trip(1.0, "overload", "460 N", 460.0, 450.0)
    elif verb == "flush":
        writer.flush()
    elif verb == "end_condition":
        writer.end_condition(1, ConditionStatus.OK)
    elif verb == "finish":
        writer.finish("finished")
    else:
        writer.piece_mounted(PieceInfo(1, 1, 1, "1#", 0.0, 90.0, 90.0))
    assert count(tmp_path, "SELECT count(*) FROM event") == 1
    writer.close()


def test_repeat_keys_count_from_one_without_asking_the_file(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    assert [writer.begin_repeat(1, i, 1) for i in (1, 2, 3)] == [1, 2, 3]
    writer.close()


def test_blocks_do_not_span_repeats(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    for key in (0.0, 1.0, 1.0, 2.0, 0.0):
        writer.sample(row(1.0, key))
    writer.close()
    assert count(tmp_path, "SELECT count(*) FROM sample_block") == 4


def test_blocks_hold_at_most_their_number_of_rows(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    for i in range(2 * BLOCK_ROWS + 10):
        writer.sample(row(0.01 * i))
    writer.close()
    assert count(tmp_path, "SELECT max(rows) FROM sample_block") == BLOCK_ROWS
    assert rows_on_disk(tmp_path) == 2 * BLOCK_ROWS + 10


def test_events_are_numbered_in_order(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    for i in range(5):
        writer.event(float(i), "step", f"event {i}")
    writer.close()
    with RunReader(tmp_path) as reader:
        assert [(event.sequence, event.text) for event in reader.events()] == [(i + 1, f"event {i}") for i in range(5)]


def test_a_void_attempt_keeps_its_reason_and_is_not_committed(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    key = writer.begin_repeat(1, 1, 1)
    writer.void_repeat(key, "held by the operator", 30.0)
    writer.close()
    with RunReader(tmp_path) as reader:
        assert reader.repeats() == []
        (attempt,) = reader.repeats(attempts=True)
        assert (attempt.result.status, attempt.result.reason) == (RepeatStatus.VOID, "held by the operator")


def test_a_sample_of_the_wrong_length_fails_the_writer_and_loses_no_repeat(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    writer.sample((1.0, 2.0))
    ticket = writer.commit_repeat(writer.begin_repeat(1, 1, 1), result())
    assert not ticket.done
    assert ticket.error == writer.failed
    assert writer.failed is not None
    assert "21 values" in writer.failed
    writer.close()
    assert count(tmp_path, "SELECT count(*) FROM repeat") == 0


def test_text_that_no_file_can_hold_fails_the_writer(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    writer.event(1.0, "step", "\ud800", "alarm")
    assert writer.failed is not None
    writer.close()


def test_a_full_disk_is_reported_and_keeps_committed_rows(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    done = writer.commit_repeat(writer.begin_repeat(1, 1, 1), result())
    limit_pages(writer, setting(writer, "page_count"))
    for i in range(2000):
        writer.sample(row(float(i) ** 1.1))
    ticket = writer.commit_repeat(writer.begin_repeat(1, 2, 1), result())
    assert done.done
    assert not ticket.done
    assert writer.failed is not None
    assert "full" in writer.failed
    writer.close()
    assert count(tmp_path, "SELECT count(*) FROM repeat WHERE status = 'valid'") == 1


def test_rows_refused_by_a_full_disk_are_written_when_there_is_room_at_the_end(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    limit_pages(writer, setting(writer, "page_count"))
    for i in range(2000):
        writer.sample(row(float(i) ** 1.1))
    writer.commit_repeat(writer.begin_repeat(1, 1, 1), result())
    writer.event(2.0, "stop", "controlled stop", "alarm")
    assert writer.failed is not None
    limit_pages(writer, 1_000_000)
    writer.close()
    assert rows_on_disk(tmp_path) == 2000
    assert count(tmp_path, "SELECT count(*) FROM event") == 1
    assert count(tmp_path, "SELECT count(*) FROM repeat WHERE status = 'valid'") == 1


def test_samples_that_find_a_full_queue_are_counted_and_the_count_is_stored(tmp_path: Path) -> None:
    clock = Clock()
    writer = RunWriter(tmp_path / "run.db", QUANTITIES, clock=clock, limit=0)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    for i in range(10):
        writer.sample(row(float(i)))
    writer.close()
    assert writer.overruns == 10
    with RunReader(tmp_path) as reader:
        assert reader.run().overruns == 10


def test_a_lossless_writer_waits_instead_of_dropping(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / "run.db", QUANTITIES, clock=Clock(), lossless=True, limit=50)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    for i in range(3000):
        writer.sample(row(float(i)))
    writer.close()
    assert writer.overruns == 0
    assert rows_on_disk(tmp_path) == 3000


def test_a_lossless_commit_returns_only_when_it_is_done(tmp_path: Path) -> None:
    writer = open_writer(tmp_path, synchronous=False, lossless=True)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    assert writer.commit_repeat(writer.begin_repeat(1, 1, 1), result()).done
    writer.close()


def test_a_lossless_writer_that_fails_does_not_wait_for_ever(tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / "run.db", QUANTITIES, clock=Clock(), lossless=True, limit=20)
    writer.sample((1.0,))
    assert not writer.commit_repeat(1, result()).done
    for i in range(100):
        writer.sample(row(float(i)))
    assert writer.overruns > 0
    writer.close()


def test_the_thread_writes_rows_appended_by_the_scan(tmp_path: Path) -> None:
    writer = open_writer(tmp_path, synchronous=False)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    for i in range(LOSSLESS_LIMIT + 100):
        writer.sample(row(0.01 * i))
    writer.finish("finished", rig_seconds=82.0)
    writer.close()
    assert rows_on_disk(tmp_path) == LOSSLESS_LIMIT + 100
    assert writer.failed is None


def test_closing_beside_a_reader_keeps_everything(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    writer.commit_repeat(writer.begin_repeat(1, 1, 1), result())
    with RunReader(tmp_path) as reader:
        under_way = reader._connection.execute("SELECT * FROM condition")
        under_way.fetchone()
        writer.close()
        assert len(reader.repeats()) == 1
    with RunReader(tmp_path) as reader:
        assert len(reader.repeats()) == 1


def test_closing_twice_is_harmless(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    writer.close()
    writer.close()
    with RunReader(tmp_path) as reader:
        assert reader.run().status


def test_a_resumed_run_keeps_counting_and_voids_interrupted_repeats(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    writer.commit_repeat(writer.begin_repeat(1, 1, 1), result())
    writer.begin_repeat(1, 2, 1)
    writer.event(1.0, "step", "cut")
    writer.close()
    again = open_writer(tmp_path)
    again.resume_run()
    assert again.begin_repeat(1, 2, 2) == 3
    again.event(2.0, "step", "goes on")
    again.close()
    with RunReader(tmp_path) as reader:
        assert [attempt.result.status for attempt in reader.repeats(attempts=True)] == ["valid", "void", "open"]
        assert [event.sequence for event in reader.events()] == [1, 2]


def test_a_foreign_file_is_refused_and_left_unchanged(tmp_path: Path) -> None:
    path = tmp_path / "run.db"
    connection = sqlite3.connect(path)
    connection.execute("CREATE TABLE bookmarks (url TEXT)")
    connection.close()
    before = path.read_bytes()
    with pytest.raises(StoreError, match="not made by"):
        RunWriter(path, QUANTITIES, clock=Clock())
    assert path.read_bytes() == before


def test_a_record_of_other_columns_cannot_be_continued(tmp_path: Path) -> None:
    small_run(tmp_path)
    connection = sqlite3.connect(tmp_path / "run.db")
    connection.execute("UPDATE channel SET name = 'other' WHERE position = 3")
    connection.commit()
    connection.close()
    with pytest.raises(StoreError, match=r"other channels.*other, slip_m_s"):
        open_writer(tmp_path)


def test_a_copy_of_a_writer_records_nothing_and_counts_on(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    writer.begin_repeat(1, 1, 1)
    copied = copy.deepcopy(writer)
    assert isinstance(copied, NullRecorder)
    assert copied.begin_repeat(1, 2, 1) == 2
    assert copied.commit_repeat(2, result()).done
    copied.sample(row(1.0))
    writer.close()
    assert count(tmp_path, "SELECT count(*) FROM repeat") == 1


def test_a_null_recorder_can_be_copied() -> None:
    recorder = NullRecorder()
    recorder.begin_repeat(1, 1, 1)
    assert copy.deepcopy(recorder).begin_repeat(1, 2, 1) == 2


def test_a_bare_recorder_records_nothing() -> None:
    with pytest.raises(TypeError):
        Recorder().sample(row(1.0))
    with pytest.raises(TypeError):
        Recorder().flush()


KILLED = """
import sys
from pathlib import Path
from tests.tester.store.build import CONDITIONS, RUN, SPECIMENS, QUANTITIES, result, row
from tester.store.writer import RunWriter
writer = RunWriter(Path(sys.argv[1]) / "run.db", QUANTITIES, clock=lambda: 0.0)
writer.begin_run(RUN, SPECIMENS, CONDITIONS)
n = 0
while True:
    n += 1
    key = writer.begin_repeat(1, n, 1)
    for i in range(20):
        writer.sample(row(n + 0.01 * i, float(key)))
    ticket = writer.commit_repeat(key, result())
    while not ticket.done:
        assert writer.failed is None, writer.failed
    print(n, flush=True)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
def test_a_committed_repeat_survives_a_kill(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", KILLED, str(tmp_path)],
        stdout=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])},
    )
    assert process.stdout is not None
    for line in process.stdout:
        if int(line) == 5:
            break
    process.kill()
    process.wait()
    process.stdout.close()
    with RunReader(tmp_path) as reader:
        committed = reader.repeats()
        assert len(committed) >= 5
        for repeat in committed:
            assert len(reader.samples(1, repeat.repeat)["time_s"]) == 20
            assert repeat.result == replace(result(), status=RepeatStatus.VALID)


def test_rows_refused_by_a_full_disk_are_written_a_second_later_when_there_is_room(tmp_path: Path) -> None:
    clock = Clock()
    writer = begun(tmp_path, clock)
    limit_pages(writer, setting(writer, "page_count"))
    for i in range(2000):
        writer.sample(row(float(i) ** 1.1))
    ticket = writer.commit_repeat(writer.begin_repeat(1, 1, 1), result())
    assert not ticket.done and writer.failed is not None
    limit_pages(writer, 1_000_000)
    writer.service()
    assert not ticket.done  # not at once: a full disk is not retried ten times a second
    clock.now += 1.0
    writer.service()
    assert ticket.done and ticket.error is None
    assert rows_on_disk(tmp_path) == 2000
    assert writer.failed is not None  # the run ends all the same
    writer.close()


def test_rig_times_of_a_resumed_run_count_from_its_origin(tmp_path: Path) -> None:
    writer = begun(tmp_path)
    writer.begin_session(SessionInfo(2, 1000.0, "", "", 0, "", "", "", ""))
    key = writer.begin_repeat(1, 1, 2, 5.0)
    writer.sample(row(6.0, float(key)))
    writer.commit_repeat(key, result(), BURSTS)
    writer.event(7.0, "step", "heating")
    writer.finish("done", rig_seconds=8.0)
    writer.close()
    with RunReader(tmp_path) as reader:
        (repeat,) = reader.repeats()
        (block,) = reader.sample_blocks()
        assert (repeat.begun_s, repeat.result.started_s, repeat.result.ended_s) == (1005.0, 1010.0, 1043.5)
        assert [burst.started_s for burst in reader.bursts(repeat.key)] == [1010.0, 1040.0]
        assert list(block.columns["time_s"]) == [1006.0]
        assert [event.t_s for event in reader.events()] == [1007.0]
        assert reader.run().rig_seconds == 1008.0
