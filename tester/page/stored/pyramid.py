"""Samples at every zoom: for each 8 samples, 64, 512 ... the least and the greatest value of every column.

No sample is ever left out of a picture: it lies between the two. The first level is made once a run, block by block,
and kept beside the record; what a running run has recorded since is added at each question. Only the record counts: a
file that does not belong to its present samples is made anew.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from tester.base.quantities import TIME
from tester.page.stored.drawn_columns import ColumnValues, DrawnColumn, drawn_columns
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
TOGETHER = 12_000
"""Samples whose columns are computed in one call: many blocks are short, and a call costs more than their samples."""
AHEAD = 8
"""Such calls that wait while further blocks are read: 5 MB."""
THREADS = 2
"""Threads that decompress: zlib and numpy leave the interpreter to others meanwhile."""


Real = TypeVar("Real", np.float32, np.float64)


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
        if size == FACTOR:
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


def _by_eight(values: NDArray[Real], of: np.ufunc) -> NDArray[Real]:
    """Reduce every eight columns to one, the last maybe fewer, in halves: four times as fast as ``reduceat``."""
    whole = values.shape[-1] // FACTOR * FACTOR
    halves = values[..., :whole]
    for _ in range(3):
        halves = of(halves[..., 0::2], halves[..., 1::2])
    if whole == values.shape[-1]:
        return halves
    return np.concatenate([halves, of.reduce(values[..., whole:], axis=-1, keepdims=True)], axis=-1)


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


def keep(file: Path, made: Pyramid) -> None:
    """Write a run's file, if it is worth it."""
    if made.state.rows >= AT_LEAST:
        with suppress(OSError):  # a folder that cannot be written: it is made again next time
            write_file(file, _pieces(made))


def pyramid_of(
    reader: RunReader, before: Pyramid | None, *, lasting: bool, keep: Callable[[Path, Pyramid], object] = keep
) -> Pyramid:
    """Return the pyramid of a run's present samples. Raises StoreError.

    ``before``: an earlier one of the same run, to which only new blocks are added; ``lasting``: the run is over, so
    that the file beside its record is read, or written by ``keep`` where it is missing.
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
    if lasting:
        keep(file, made)
    made.kept = lasting
    return made


def _made(reader: RunReader, columns: Sequence[DrawnColumn], after: int) -> Buckets:
    """Return the buckets of the blocks after one, by its id."""
    rows = reader.rows("SELECT id, rows, data FROM sample_block WHERE id > ? ORDER BY id", (after,))
    of = _Blocks(reader, columns)
    made: list[Buckets] = []
    waiting: deque[Future[Buckets]] = deque()
    with ThreadPoolExecutor(THREADS) as pool:
        for chunk in _chunks(rows):
            waiting.append(pool.submit(of.eights, chunk))
            if len(waiting) > AHEAD:
                made.append(waiting.popleft().result())
    made += [one.result() for one in waiting]
    return _joined(made) if made else _nothing(len(columns))


def _chunks(rows: Iterable[Row]) -> Iterator[list[Row]]:
    """Yield the blocks in groups of at least ``TOGETHER`` samples; the last may have fewer."""
    chunk: list[Row] = []
    count = 0
    for row in rows:
        chunk.append(row)
        count += whole(row, "rows")
        if count >= TOGETHER:
            yield chunk
            chunk, count = [], 0
    if chunk:
        yield chunk


class _Blocks:
    """Makes buckets of blocks; its method may be called in several threads."""

    def __init__(self, reader: RunReader, columns: Sequence[DrawnColumn]) -> None:
        self._path = reader.path
        self._names = reader.quantities().names
        conditions = reader.conditions() if any(column.axis for column in columns) else []
        self._values = ColumnValues(columns, reader.quantities(), conditions)

    def eights(self, rows: Sequence[Row]) -> Buckets:
        """Return the blocks' buckets of the first level; the last of a block may have fewer samples. Raises StoreError.
        """
        table = _in_eights([self._table(row) for row in rows])
        least, greatest = _by_eight(table, np.fmin), _by_eight(table, np.fmax)
        samples = dict(zip(self._names, table, strict=True))
        columns = self._values.columns
        low = np.empty((len(columns), least.shape[1]), np.float32)
        high = np.empty_like(low)
        for place, column in enumerate(columns):
            if column.recorded:  # scaled once reduced: an eighth of the work
                at, scale = self._names.index(column.recorded), column.channel.scale
                ends = least[at] * scale, greatest[at] * scale
                low[place], high[place] = ends if scale >= 0.0 else ends[::-1]
            else:
                values = self._values.computed(column, samples)
                low[place], high[place] = _by_eight(values, np.fmin), _by_eight(values, np.fmax)
        return Buckets(samples[TIME][::FACTOR].copy(), low, high)

    def samples(self, row: Row) -> Buckets:
        """Return a block's samples, each a bucket of its own. Raises StoreError."""
        samples = dict(zip(self._names, self._table(row), strict=True))
        values = self._values.values(samples).astype(np.float32)
        return Buckets(samples[TIME].copy(), values, values)

    def _table(self, row: Row) -> NDArray[np.float64]:
        try:
            return unpack_array(blob(row, "data"), whole(row, "rows"), len(self._names))
        except ValueError as error:
            raise StoreError(f"{self._path}, block {row['id']}: {error}") from error


def _in_eights(blocks: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the blocks beside each other, each filled up to a multiple of eight samples by its last sample."""
    widths = [-(-block.shape[1] // FACTOR) * FACTOR for block in blocks]
    table = np.empty((len(blocks[0]), sum(widths)))
    at = 0
    for block, width in zip(blocks, widths, strict=True):
        end = at + block.shape[1]
        table[:, at:end] = block
        at += width
        if end < at:
            table[:, end:at] = block[:, -1:]
    return table


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


def _pieces(made: Pyramid) -> Iterator[bytes | memoryview]:
    """Yield a file in pieces, each array as it is in memory."""
    for array in (np.frombuffer(_head(made.columns, made.state).encode(), np.uint8), *made.first):
        head, whole = BytesIO(), np.ascontiguousarray(array)
        np.lib.format.write_array_header_1_0(head, np.lib.format.header_data_from_array_1_0(whole))
        yield head.getvalue()
        yield whole.data


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
