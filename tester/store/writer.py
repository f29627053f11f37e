"""Writes a run's database in a thread of its own, which a bounded queue supplies.

A file next to the database reserves RESERVE_BYTES of disk space. On a full disk the file is deleted, and the last
entries of the run, including its status, are written into that space.

The scan's thread only appends to one deque, which carries samples (tuples) and batches of statements in order of
arrival. Appending to and popping from a deque is atomic, so the scan holds no lock. The logger's thread takes the
queued items and commits them in one transaction: every second of wall time, and at once for an urgent batch (a repeat,
an alarm). Items stay in memory until COMMIT has returned. After an error ``failed`` keeps the reason permanently, and
the run must stop. Items in memory stay there, up to the queue's limit. The thread tries to write them again every
second while the rig comes to rest, and ``close`` tries once more.

If the queue is full, the sample is dropped and counted, because a real rig cannot wait. With ``lossless`` (simulated
time) the scan waits instead, also for the COMMIT of a repeat, so that results do not depend on the disk's speed.
"""

from __future__ import annotations

import sqlite3
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from threading import Event as Signal
from threading import Thread

from tester.analysis.results import Burst, RepeatResult
from tester.base.quantities import KEY, TIME, Quantities
from tester.base.trouble import in_words
from tester.store.chain import Chain
from tester.store.disk import Reserve, file_identity, sync_folder
from tester.store.kind_rows import add_channels, recorded_channels
from tester.store.record_schema import StoreError, migrate, version_of
from tester.store.recorder import NullRecorder, Recorder
from tester.store.row_queue import no_utc
from tester.store.sample_blocks import BLOCK_ROWS, pack
from tester.store.sql import Batch, Judged, Ticket, insert

COMMIT_EVERY_S = 0.7
"""Longest time that a sample waits for the start of its commit, s of wall time: a second less the time of a slow disk
and a busy machine.
"""

QUEUE_LIMIT = 65536
"""Number of items in the queue above which samples are dropped: ten minutes at 100 Hz, a minute at 1 kHz."""

RETRY_S = 1.0
"""Time from a write error to the next attempt, s."""

RESERVE_BYTES = 4_000_000
"""Space reserved for the end of a run: a cool-down of 45 min at two samples a second takes 0.3 MB, a full queue (65536
samples of 40 to 60 bytes) up to 4 MB."""
LOSSLESS_LIMIT = 8192
"""Greatest number of items in the queue before the simulation waits, and of samples in one transaction."""

_WRITE_ERRORS = (sqlite3.Error, OSError, ValueError, OverflowError, TypeError, IndexError)
"""Errors of a disk (the first two) or of a value that no column accepts (the others)."""


class RecordGoneError(OSError):
    """The name of the file no longer leads to the open file: further writes would be lost."""


def _averaged(quantities: Quantities) -> tuple[str, ...]:
    return tuple(quantity.name for quantity in quantities.averaged)


def _open(path: Path, quantities: Quantities) -> tuple[sqlite3.Connection, Chain]:
    connection = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
    try:
        version_of(connection)  # before any change, because the file may belong to another program
        # EXTRA until the log is in use: the deletion of a rollback journal is synced as well. A journal that came back
        # after a power cut would undo everything since.
        connection.execute("PRAGMA synchronous = EXTRA")
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = FULL")
        migrate(connection)
        chain = Chain(connection)
        recorded = recorded_channels(connection)
        if recorded is None:
            connection.execute("BEGIN IMMEDIATE")
            add_channels(connection, quantities)
            chain.seal()
            connection.execute("COMMIT")
        elif (recorded.names, _averaged(recorded)) != (quantities.names, _averaged(quantities)):
            others = ", ".join(sorted(set(recorded.names) ^ set(quantities.names))) or "in another order"
            raise StoreError(f"{path.name} was recorded with other channels and cannot be continued: {others}")
        sync_folder(path.parent)
    except ValueError as error:
        connection.close()
        raise StoreError(f"{path.name}: {error}") from error
    except (sqlite3.Error, StoreError):
        connection.close()
        raise
    return connection, chain


class RunWriter(Recorder):
    """The record of one run in ``path`` (run.db): a new file, or the file of a resumed run.

    ``quantities``: the channels of its samples; a resumed run must have begun with the same channels. ``clock`` returns
    seconds of a monotonic wall clock, ``utc`` the time of day as text. ``synchronous``: work without a thread, for
    tests, and for simulations in which a thread only costs time. Raises StoreError for a foreign or newer database,
    sqlite3.Error if the file cannot be opened.
    """

    def __init__(
        self,
        path: Path,
        quantities: Quantities,
        *,
        clock: Callable[[], float],
        utc: Callable[[], str] = no_utc,
        lossless: bool = False,
        synchronous: bool = False,
        limit: int | None = None,
        commit_every_s: float = COMMIT_EVERY_S,
        reserve: int = 0,
    ) -> None:
        """Open the file and start the logger. ``reserve``: bytes of disk space to reserve for the end."""
        super().__init__(utc)
        self._path = path
        self._clock = clock
        self._lossless = lossless
        self._synchronous = synchronous
        usual = BLOCK_ROWS if synchronous else LOSSLESS_LIMIT if lossless else QUEUE_LIMIT
        self._limit = usual if limit is None else limit
        self._poll_s = 0.1 * commit_every_s
        self._commit_after_s = commit_every_s - self._poll_s
        self._queue: deque[tuple[float, ...] | Batch] = deque()
        self._rows: list[tuple[float, ...]] = []
        self._batches: list[Batch] = []
        self._urgent = False
        self._stored_overruns = 0
        self._stopping = False
        self._wake, self._room, self._committed = Signal(), Signal(), Signal()
        self._width = len(quantities.names)
        self._key_at, self._time_at = quantities.index(KEY), quantities.index(TIME)
        self._connection, self._chain = _open(path, quantities)
        self._file = file_identity(path)
        self._reserve = Reserve(path, reserve) if reserve else None
        self._continue_counting()
        self._committed_at = clock()
        self._thread = None if synchronous else Thread(target=self._run, name="recorder", daemon=True)
        if self._thread is not None:
            self._thread.start()

    def __deepcopy__(self, memo: dict[int, object]) -> NullRecorder:
        """Return a recorder that records nothing and continues the numbering: a copied engine must not write the
        file."""
        copied = NullRecorder(self._utc)
        copied.continue_from(self)
        return copied

    def _continue_counting(self) -> None:
        def last(column: str, table: str) -> int:
            return self._connection.execute(f"SELECT coalesce(max({column}), 0) FROM {table}").fetchone()[0]

        self._repeats = last("id", "repeat")
        self._events = last("sequence", "event")
        self._prompts = last("id", "prompt")
        self._trips = last("id", "trip")

    # The scan's side

    def sample(self, row: tuple[float, ...]) -> None:
        """Record one sample: a value for each recorded channel, as an exact tuple."""
        if len(self._queue) < self._limit:
            self._queue.append(row)
        else:
            self._full(row)

    def _full(self, row: tuple[float, ...]) -> None:
        if self._synchronous and self.failed is None:
            self.service()
        elif self._lossless:
            while len(self._queue) >= self._limit and self.failed is None:
                self._room.clear()
                self._wake.set()
                self._room.wait(self._poll_s)
        if len(self._queue) < self._limit:
            self._queue.append(row)
        else:
            self.overruns += 1

    def _put(self, batch: Batch) -> None:
        self._queue.append(batch)
        if self._synchronous:
            if self.failed is None:
                self.service()
        elif batch.urgent:
            self._wake.set()

    def commit_repeat(
        self, key: int, result: RepeatResult, bursts: Iterable[Burst] = (), judged: Judged | None = None
    ) -> Ticket:
        """Commit a complete repeat; if lossless, return only after the COMMIT."""
        ticket = super().commit_repeat(key, result, bursts, judged)
        if self._lossless:
            self._wait_for(ticket)
        return ticket

    def _wait_for(self, ticket: Ticket) -> None:
        while not ticket.done and self.failed is None:
            self._committed.wait(self._poll_s)
            self._committed.clear()

    def close(self) -> None:
        """Commit the rest, merge the log into the database and close the file."""
        if self._stopping:
            return
        self._stopping = True
        if self._thread is not None:
            self._wake.set()
            self._thread.join()
        self._drain()
        self._commit()
        self._give_room()
        if not self._rows and not self._batches:
            # Leave WAL mode: a finished run is a single file, which reading does not change. A reader at this moment
            # prevents that; the log is then merged when the last reader leaves, and the file stays in WAL mode.
            self._connection.execute("PRAGMA busy_timeout = 0")
            self._connection.execute("PRAGMA synchronous = EXTRA")
            with suppress(sqlite3.OperationalError):
                self._connection.execute("PRAGMA journal_mode = DELETE")
        self._connection.close()

    @property
    def lost(self) -> str | None:
        """Return why the record is incomplete; None if everything was written in the end."""
        return self.failed if self._rows or self._batches or self.overruns else None

    def _give_room(self) -> None:
        """Release the space reserved for the end."""
        if self._reserve is not None:
            self._reserve.give_up()
            self._reserve = None

    # The logger's side

    def _run(self) -> None:
        try:
            while not self._stopping:
                self._wake.wait(self._poll_s)
                self._wake.clear()
                self.service()
        finally:
            # A caller that waits for this thread must not wait for ever, whatever the cause of the thread's end.
            if not self._stopping and self.failed is None:
                self.failed = "the recorder has ended unexpectedly"

    def service(self) -> None:
        """Take the queued items and commit those that are due; the logger's thread calls it ten times a second."""
        waited = self._clock() - self._committed_at
        if self.failed is not None:
            self._try_again(waited)
            return
        self._drain()
        if self._urgent or waited >= self._commit_after_s or len(self._rows) >= LOSSLESS_LIMIT:
            self._commit()

    def _try_again(self, waited_s: float) -> None:
        """Write the items that an error has kept in memory, a second after the last attempt."""
        if waited_s >= RETRY_S:
            if len(self._rows) < QUEUE_LIMIT:  # otherwise the queue fills, and further samples are dropped and counted
                self._drain()
            self._commit()

    def _drain(self) -> None:
        queue = self._queue
        for _ in range(len(queue)):
            item = queue.popleft()
            if isinstance(item, Batch):
                self._batches.append(item)
                self._urgent |= item.urgent
            elif origin := self.origin_s:
                # The times of a resumed run continue from its interruption.
                self._rows.append((item[0] + origin, *item[1:]))
            else:
                self._rows.append(item)
        self._room.set()

    def _commit(self) -> None:
        if self._rows or self._batches or self.overruns != self._stored_overruns:
            try:
                self._write_transaction()
            except _WRITE_ERRORS as error:
                self._fail(error)
                return
            self._rows.clear()
            for batch in self._batches:
                batch.ticket.done = True
                batch.ticket.error = None
            self._batches.clear()
        self._urgent = False
        self._committed_at = self._clock()
        self._committed.set()

    def _write_transaction(self) -> None:
        self._look_for_file()
        connection = self._connection
        connection.execute("BEGIN IMMEDIATE")
        try:
            self._write_rows()
            for batch in self._batches:
                for sql, values in batch.statements:
                    connection.execute(sql, values)
            overruns = self.overruns
            if overruns != self._stored_overruns:
                connection.execute("UPDATE run SET overruns = overruns + ?", (overruns - self._stored_overruns,))
            self._chain.seal()
            connection.execute("COMMIT")
        finally:
            if connection.in_transaction:
                connection.execute("ROLLBACK")
        self._stored_overruns = overruns

    def _look_for_file(self) -> None:
        """Raise RecordGoneError if the file was removed, moved or exchanged: writes to it would be lost without an
        error.
        """
        try:
            there = file_identity(self._path) == self._file
        except FileNotFoundError:
            there = False
        if not there:
            raise RecordGoneError(f"{self._path} was removed, or another file put in its place")

    def _write_rows(self) -> None:
        rows, key_at, time_at = self._rows, self._key_at, self._time_at
        first = 0
        for end in range(1, len(rows) + 1):
            if end == len(rows) or end - first == BLOCK_ROWS or rows[end][key_at] != rows[first][key_at]:
                block = rows[first:end]
                data = pack(block, self._width)
                times = {"first_s": block[0][time_at], "last_s": block[-1][time_at]}
                columns = {"repeat_id": int(block[0][key_at]), "rows": len(block), **times, "data": data}
                self._connection.execute(*insert("sample_block", columns))
                first = end

    def _fail(self, error: Exception) -> None:
        self.failed = self.failed or in_words(error)
        self._give_room()
        self._committed_at = self._clock()
        for batch in self._batches:
            batch.ticket.error = self.failed
        self._urgent = False
        self._committed.set()
        self._room.set()
