"""Samples at every zoom: for each 8 samples, 64, 512 ... the least and the greatest value of every column.

No sample is ever left out of a picture: it lies between the two. The first level is made once a run, block by block,
and kept beside the record; what a running run has recorded since is added at each question. Only the record counts: a
file that does not belong to its present samples is made anew.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from itertools import accumulate, islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tester.base.quantities import TIME
from tester.page.stored.drawn_columns import DrawnColumn, drawn, drawn_columns
from tester.results.run_files import PYRAMID, write_file
from tester.store.record_schema import StoreError
from tester.store.run_reader import RunReader
from tester.store.sample_blocks import unpack_array
from tester.store.sql import Row, blob, whole

if TYPE_CHECKING:
    from numpy.typing import NDArray

FACTOR = 8
"""Samples or buckets in a bucket of the next level."""
MADE_BY = 1
"""Increase it when the same samples give another file than before."""
AT_LEAST = 20_000
"""A run with fewer samples gets no file, because reading them again takes no longer [measured: 20 ms]."""
AT_ONCE = 256
"""Blocks that are read before they are worked on: 5 MB."""
TOGETHER = 32
"""Blocks whose columns are computed in one call: many are short, and a call costs more than their samples."""
THREADS = 2
"""Threads that decompress: zlib and numpy leave the interpreter to others meanwhile."""


class SamplesState(NamedTuple):
    """What identifies the samples of a record: it only grows while the run is under way, and stays the same after."""

    blocks: int
    last: int
    rows: int
    bytes: int


class Buckets(NamedTuple):
    """Buckets in order of time: the first time in each, rig seconds, shape (n); least and greatest values, shape
    (columns, n), NaN where nothing was recorded. Float64, float32.
    """

    t_s: NDArray[np.float64]
    low: NDArray[np.float32]
    high: NDArray[np.float32]

    def gathered(self, size: int) -> Buckets:
        """Return buckets of ``size`` of these."""
        if size <= 1 or not len(self.t_s):
            return self
        if size == FACTOR and len(self.t_s) % FACTOR == 0:
            return Buckets(self.t_s[::FACTOR], _by_eight(self.low, np.fmin), _by_eight(self.high, np.fmax))
        first = np.arange(0, len(self.t_s), size)
        return Buckets(
            self.t_s[first], np.fmin.reduceat(self.low, first, axis=1), np.fmax.reduceat(self.high, first, axis=1)
        )

    def between(self, from_s: float, to_s: float) -> slice:
        """Return the places of the buckets that hold times of a window; the one that it begins in as well."""
        first = max(int(np.searchsorted(self.t_s, from_s, "right")) - 1, 0)
        return slice(first, int(np.searchsorted(self.t_s, to_s, "right")))

    def at(self, places: slice) -> Buckets:
        """Return some of the buckets."""
        return Buckets(self.t_s[places], self.low[:, places], self.high[:, places])


def _by_eight(values: NDArray[np.float32], of: np.ufunc) -> NDArray[np.float32]:
    """Reduce every eight columns to one, in halves: twice as fast as ``reduceat`` [measured]."""
    for _ in range(3):
        values = of(values[:, 0::2], values[:, 1::2])
    return values


@dataclass
class Pyramid:
    """The levels of a run; ``first`` has a bucket for every 8 samples of a block."""

    columns: tuple[DrawnColumn, ...]
    state: SamplesState
    first: Buckets
    kept: bool = False
    """Whether it is that of a run that is over."""

    @cached_property
    def levels(self) -> tuple[Buckets, ...]:
        """Return the levels, the finest first."""
        found = [self.first]
        while len(found[-1].t_s) > FACTOR:
            found.append(found[-1].gathered(FACTOR))
        return tuple(found)

    def window(self, reader: RunReader, from_s: float, to_s: float, points: int) -> Buckets:
        """Return a window of rig time, s, as at most 2 x ``points`` buckets, as many as there are. Raises StoreError.
        """
        finest = self.first.between(from_s, to_s)
        if finest.stop - finest.start <= 2 * points:
            return self._samples(reader, from_s, to_s, points)
        narrowed = ((level, level.between(from_s, to_s)) for level in self.levels)
        level, places = next(
            (found for found in narrowed if found[1].stop - found[1].start <= FACTOR * 2 * points),
            (self.levels[-1], slice(None)),
        )
        return _fitting(level.at(places), points)

    def _samples(self, reader: RunReader, from_s: float, to_s: float, points: int) -> Buckets:
        """Return a narrow window from the samples themselves."""
        sql = "SELECT * FROM sample_block WHERE last_s >= ? AND first_s <= ? ORDER BY id"
        of = _Blocks(reader, self.columns)
        blocks = [of.samples(row) for row in reader.rows(sql, (from_s, to_s))]
        if not blocks:
            return _nothing(len(self.columns))
        found = _joined(blocks)
        keep = (found.t_s >= from_s) & (found.t_s <= to_s)
        return _fitting(Buckets(found.t_s[keep], found.low[:, keep], found.high[:, keep]), points)


def _fitting(found: Buckets, points: int) -> Buckets:
    return found.gathered(-(-len(found.t_s) // (2 * points)))


def _nothing(columns: int) -> Buckets:
    empty = np.empty((columns, 0), np.float32)
    return Buckets(np.empty(0), empty, empty)


def state_of(reader: RunReader) -> SamplesState:
    """Return the state of a record's samples. Raises StoreError."""
    sql = (
        "SELECT count(*) AS blocks, coalesce(max(id), 0) AS last, coalesce(sum(rows), 0) AS rows,"
        " coalesce(sum(length(data)), 0) AS bytes FROM sample_block"
    )
    return next(SamplesState(*(whole(row, name) for name in SamplesState._fields)) for row in reader.rows(sql))


def pyramid_of(reader: RunReader, before: Pyramid | None, *, lasting: bool) -> Pyramid:
    """Return the pyramid of a run's present samples. Raises StoreError.

    ``before``: an earlier one of the same run, to which only new blocks are added; ``lasting``: the run is over, so
    that the file beside its record is read, or written where it is missing.
    """
    state, columns = state_of(reader), drawn_columns(reader.quantities())
    if before is not None and before.state == state and before.kept >= lasting:
        return before
    file = reader.path.with_name(f"samples{PYRAMID}")
    if lasting and (stored := _read(file, columns, state)) is not None:
        return stored
    if before is not None and before.state.last <= state.last and not before.kept:
        made = Pyramid(columns, state, _joined([before.first, _made(reader, columns, before.state.last)]))
    else:
        made = Pyramid(columns, state, _made(reader, columns, 0))
    if lasting and state.rows >= AT_LEAST:
        with suppress(OSError):  # a folder that cannot be written: it is made again next time
            write_file(file, [_as_bytes(made)])
    made.kept = lasting
    return made


def _made(reader: RunReader, columns: Sequence[DrawnColumn], after: int) -> Buckets:
    """Return the buckets of the blocks after one, by its id."""
    rows = reader.rows("SELECT * FROM sample_block WHERE id > ? ORDER BY id", (after,))
    of = _Blocks(reader, columns)
    made: list[Buckets] = []
    with ThreadPoolExecutor(THREADS) as pool:
        while chunk := list(islice(rows, AT_ONCE)):
            made += pool.map(of.eights, [chunk[at : at + TOGETHER] for at in range(0, len(chunk), TOGETHER)])
    return _joined(made) if made else _nothing(len(columns))


class _Blocks:
    """Makes buckets of blocks; its method may be called in several threads."""

    def __init__(self, reader: RunReader, columns: Sequence[DrawnColumn]) -> None:
        self._path = reader.path
        self._quantities = reader.quantities()
        self._conditions = reader.conditions() if any(column.axis for column in columns) else []
        self._columns = columns

    def eights(self, rows: Sequence[Row]) -> Buckets:
        """Return the blocks' buckets of the first level; the last of a block may have fewer samples. Raises StoreError.
        """
        tables = [self._table(row) for row in rows]
        found = self._drawn(np.concatenate(tables, axis=1))
        counts = [table.shape[1] for table in tables]
        ends = accumulate(counts)
        firsts = [at for end, count in zip(ends, counts, strict=True) for at in range(end - count, end, FACTOR)]
        first: NDArray[np.intp] = np.array(firsts, dtype=np.intp)
        return Buckets(
            found.t_s[first], np.fmin.reduceat(found.low, first, axis=1), np.fmax.reduceat(found.high, first, axis=1)
        )

    def samples(self, row: Row) -> Buckets:
        """Return a block's samples, each a bucket of its own. Raises StoreError."""
        return self._drawn(self._table(row))

    def _table(self, row: Row) -> NDArray[np.float64]:
        try:
            return unpack_array(blob(row, "data"), whole(row, "rows"), len(self._quantities.names))
        except ValueError as error:
            raise StoreError(f"{self._path}, block {row['id']}: {error}") from error

    def _drawn(self, table: NDArray[np.float64]) -> Buckets:
        samples = dict(zip(self._quantities.names, table, strict=True))
        values = drawn(self._columns, samples, self._quantities, self._conditions).astype(np.float32)
        return Buckets(samples[TIME].copy(), values, values)


def _joined(parts: Sequence[Buckets]) -> Buckets:
    found = Buckets(*(np.concatenate(pieces, axis=-1) for pieces in zip(*parts, strict=True)))
    if len(found.t_s) > 1 and (np.diff(found.t_s) < 0.0).any():  # parts that ran side by side
        order = np.argsort(found.t_s, kind="stable")
        return Buckets(found.t_s[order], found.low[:, order], found.high[:, order])
    return found


# -- its file --------------------------------------------------------------------------------------------------------


def _head(columns: Sequence[DrawnColumn], state: SamplesState) -> str:
    """Return what a file must begin with to belong to a record's samples."""
    return json.dumps({"made_by": MADE_BY, "columns": [column.key for column in columns], "state": state})


def _as_bytes(made: Pyramid) -> bytes:
    file = BytesIO()
    for array in (np.frombuffer(_head(made.columns, made.state).encode(), np.uint8), *made.first):
        np.save(file, array, allow_pickle=False)
    return file.getvalue()


def _read(file: Path, columns: tuple[DrawnColumn, ...], state: SamplesState) -> Pyramid | None:
    """Return the pyramid in a file; None where it is missing, damaged, or of other samples."""
    try:
        data = BytesIO(file.read_bytes())
        head = np.load(data, allow_pickle=False).tobytes().decode()
        if head != _head(columns, state):
            return None
        first = Buckets(*(np.load(data, allow_pickle=False) for _ in Buckets._fields))
    except (OSError, ValueError, EOFError):
        return None
    shape = (len(columns), len(first.t_s))
    return Pyramid(columns, state, first, kept=True) if first.low.shape == first.high.shape == shape else None
