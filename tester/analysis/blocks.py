"""Blocks of one whole turn: the unit in which samples are counted and averaged.

Runout of the wheel modulates the load once a revolution, so only means over whole revolutions are free of it. On a
machine without a turning part, a block is a length of travel or of time. The table of channels defines both: the
channel that counts (``Roles.turn``) and the size of a block on it (``Roles.block``).

A *stretch* is a series of accepted samples (gate 0, in a burst) of the same burst and repeat in which no step of that
position exceeds ``MAX_STEP`` of a block. The position p0 of its first sample is its origin; block k holds the samples
with k <= abs(p - p0) / block < k + 1, and exists once an accepted sample of the same stretch lies beyond its end. The
remainder at the end of a stretch, less than a block, is not counted. Blocks are anchored to the stretch's origin, so
rounding to whole samples does not accumulate.

Two implementations of this definition: ``BlockCounter`` takes sample by sample in the scan (plain Python),
``blocks_from_samples`` works on stored arrays (NumPy).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot
from typing import TYPE_CHECKING, Final

from tester.analysis.trace import Trace, columns_of
from tester.base.quantities import BURST, GATE, KEY, TIME, Means, Quantities

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MAX_STEP: Final = 0.25
"""A wider step of the position, in blocks, ends a stretch: samples that far apart do not resolve the ripple of the
runout. At 20 Hz and 1.1 m/s, the slowest sampling in contact and the fastest wheel of 88 mm, a step is 0.20
revolutions."""


@dataclass(slots=True)
class Block:
    """Means over one whole accepted block; immutable by convention.

    ``started_s`` and ``ended_s`` are rig seconds of its first sample and of the first sample after it, ``position`` the
    counted position at its start, ``mu`` the resultant coefficient hypot(along, across) / normal of its mean forces.
    """

    burst: int
    samples: int
    started_s: float
    ended_s: float
    position: float
    mu: float
    means: Means


def resultant(along_n: float, across_n: float, normal_n: float) -> float:
    """Return the resultant coefficient of mean forces, N; NaN without a load."""
    return hypot(along_n, across_n) / normal_n if normal_n > 0.0 else float("nan")


def _block(burst: int, samples: int, t0: float, t1: float, position: float, means: Means) -> Block:
    return Block(burst, samples, t0, t1, position, resultant(means.along, means.across, means.normal), means)


class BlockCounter:
    """Collects the blocks of one repeat, sample by sample.

    Its input is the rows that are recorded, so a count from the stored rows equals the count of the run.
    """

    __slots__ = (
        "_at", "_averaged", "_block", "_burst", "_burst_at", "_counted_at", "_gate_at", "_key", "_key_at", "_limit",
        "_origin", "_rows", "_step", "_table", "_time_at", "_traced", "blocks", "seconds", "trace", "transient",
    )  # fmt: skip

    def __init__(self, quantities: Quantities) -> None:
        """Start with no blocks."""
        self.blocks: list[Block] = []
        self.seconds = 0.0
        """Accepted seconds in ``blocks``."""
        self.transient: int | None = None
        """Number of leading blocks that are transient, once there are enough of them to tell."""
        self.trace = Trace(quantities)
        """The samples in ``blocks``."""
        self._traced = [quantities.index(name) if name else -1 for name in columns_of(quantities)]
        self._table = quantities
        self._time_at = quantities.index(TIME)
        self._gate_at = quantities.index(GATE)
        self._burst_at = quantities.index(BURST)
        self._key_at = quantities.index(KEY)
        self._counted_at = quantities.index(quantities.roles.turn)
        self._averaged: list[int] = [quantities.index(quantity.name) for quantity in quantities.averaged]
        self._block = quantities.roles.block
        self._step = MAX_STEP * quantities.roles.block
        self._rows: list[tuple[float, ...]] = []
        self._burst = 0.0
        self._key = 0.0
        self._origin = 0.0
        self._at = 0.0
        self._limit = 1.0

    def add(self, sample: tuple[float, ...]) -> Block | None:
        """Take in one sample (a value for each recorded channel) and return the block that it completed, if any.

        Pass every scan, including those with closed gates: they end a stretch.
        """
        rows = self._rows
        burst, key = sample[self._burst_at], sample[self._key_at]
        # A closed gate ends the stretch, and drops its incomplete block.
        if sample[self._gate_at] != 0.0 or burst == 0.0:
            if rows:
                rows.clear()
            return None
        at = sample[self._counted_at]
        if (
            not rows
            or burst != self._burst
            or key != self._key
            or not -self._step <= at - self._at <= self._step
        ):
            rows.clear()
            rows.append(sample)
            self._burst = burst
            self._key = key
            self._origin = self._at = at
            self._limit = 1.0
            return None
        self._at = at
        if abs(at - self._origin) / self._block < self._limit:
            rows.append(sample)
            return None
        self._limit += 1.0
        return self._close(sample)

    def _close(self, sample: tuple[float, ...]) -> Block:
        rows = self._rows
        count = len(rows)
        columns = list(zip(*rows, strict=True))
        means = Means(self._table, [sum(columns[i]) / count for i in self._averaged])
        started_s, ended_s = columns[self._time_at][0], sample[self._time_at]
        block = _block(int(self._burst), count, started_s, ended_s, columns[self._counted_at][0], means)
        self.blocks.append(block)
        self.seconds += block.ended_s - block.started_s
        self._keep(columns, self._limit <= 2.0)
        rows.clear()
        rows.append(sample)
        return block

    def _keep(self, columns: list[tuple[float, ...]], begins: bool) -> None:
        """Keep a block's samples. ``begins``: the block is the first of its stretch."""
        trace = self.trace
        if begins:
            trace.starts.append(len(trace.time_s))
        time_at, position_at, along_at, across_at, normal_at = self._traced
        trace.time_s.extend(columns[time_at])
        trace.position.extend(columns[position_at])
        trace.along.extend(columns[along_at])
        trace.across.extend(columns[across_at] if across_at >= 0 else (0.0,) * len(columns[0]))
        trace.normal.extend(columns[normal_at])


def blocks_from_samples(
    columns: Mapping[str, NDArray[np.float64]], quantities: Quantities, trace: Trace | None = None
) -> list[Block]:
    """Return the blocks in stored samples, arrays of equal length by channel, in order of time.

    ``trace``, where one is given, takes in the samples of the blocks.
    """
    import numpy as np

    size = quantities.roles.block
    accepted = (columns[GATE] == 0.0) & (columns[BURST] != 0.0)
    at, burst, key = columns[quantities.roles.turn], columns[BURST], columns[KEY]
    # A sample continues a stretch when it and the one before are accepted and nothing broke between them.
    joined = np.zeros(len(at), dtype=bool)
    joined[1:] = (
        accepted[1:]
        & accepted[:-1]
        & (burst[1:] == burst[:-1])
        & (key[1:] == key[:-1])
        & (np.abs(np.diff(at)) <= MAX_STEP * size)
    )
    origins = np.flatnonzero(accepted & ~joined)
    ends = np.append(origins, len(at))[1:]
    times = columns[TIME]
    averaged = np.stack([columns[quantity.name] for quantity in quantities.averaged])
    blocks: list[Block] = []
    for first, end in zip(origins.tolist(), ends.tolist(), strict=True):
        stop = first + 1 + int(np.argmin(np.append(joined[first + 1 : end], False)))
        # A reading that steps back over a boundary does not reopen the block behind it.
        turn = np.maximum.accumulate(np.floor(np.abs(at[first:stop] - at[first]) / size))
        edges = first + np.flatnonzero(np.diff(turn, prepend=-1.0))
        if trace is not None and len(edges) > 1:
            _take_in(trace, columns, quantities, int(edges[0]), int(edges[-1]))
        for a, b in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            means = Means(quantities, averaged[:, a:b].mean(axis=1).tolist())
            blocks.append(_block(int(burst[a]), b - a, float(times[a]), float(times[b]), float(at[a]), means))
    return blocks


def _take_in(
    trace: Trace, columns: Mapping[str, NDArray[np.float64]], quantities: Quantities, first: int, end: int
) -> None:
    """Append a stretch of samples to a trace."""
    trace.starts.append(len(trace.time_s))
    into = (trace.time_s, trace.position, trace.along, trace.across, trace.normal)
    for column, name in zip(into, columns_of(quantities), strict=True):
        column.extend(columns[name][first:end].tolist() if name else [0.0] * (end - first))
