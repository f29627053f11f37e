"""Blocks of one whole wheel revolution: the unit in which samples are counted and averaged.

Wheel runout modulates the load once a revolution, so only means over whole revolutions are
free of it.

A *stretch* is a series of accepted samples (gate 0, in a burst) of the same burst and repeat in which no
step of the wheel angle exceeds ``MAX_STEP_REV``. The angle a0 of its first sample is its origin; block k
holds the samples with k <= |angle - a0| < k + 1, and exists once an accepted sample of the same stretch
lies beyond its end. What is left at the end of a stretch, less than a revolution, is not counted. Blocks
are anchored to the stretch's origin, so rounding to whole samples does not accumulate.

Two implementations of this one definition: ``RevolutionCounter`` is fed sample by sample in the scan (plain
Python), ``blocks_from_samples`` works on stored arrays (NumPy).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import hypot
from typing import TYPE_CHECKING, Final

from tester.process import SAMPLE_COLUMNS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MAX_STEP_REV: Final = 0.25
"""A wider step of the wheel angle, in revolutions, ends a stretch: the ripple of the runout would not be
sampled. At 20 Hz and 1.1 m/s, the slowest sampling in contact and the fastest wheel, a step is 0.20."""

_TIME: Final = SAMPLE_COLUMNS.index("time_s")
_ANGLE: Final = SAMPLE_COLUMNS.index("wheel_angle_rev")
_GATE: Final = SAMPLE_COLUMNS.index("gate")
_BURST: Final = SAMPLE_COLUMNS.index("burst")
_KEY: Final = SAMPLE_COLUMNS.index("repeat_key")

AVERAGED: Final[tuple[str, ...]] = (
    "force_x_n",
    "force_y_n",
    "force_z_n",
    "moment_z_nm",
    "drive_torque_nm",
    "wheel_speed_m_s",
    "belt_speed_m_s",
    "slip_m_s",
    "sideslip_deg",
    "camber_deg",
    "surface_c",
    "hub_c",
)
"""Columns of a sample that a block averages; fields of the same name in Block."""

_AVERAGED: Final = tuple(SAMPLE_COLUMNS.index(name) for name in AVERAGED)


@dataclass(slots=True)
class Block:
    """Means over one whole accepted revolution; not changed once made.

    ``started_s`` and ``ended_s`` are rig seconds of its first sample and of the first sample after it,
    ``angle_rev`` the cumulative wheel angle at its start, ``mu`` the resultant coefficient hypot(mean Fx,
    mean Fy) / mean Fz.
    """

    burst: int
    samples: int
    started_s: float
    ended_s: float
    angle_rev: float
    mu: float
    force_x_n: float
    force_y_n: float
    force_z_n: float
    moment_z_nm: float
    drive_torque_nm: float
    wheel_speed_m_s: float
    belt_speed_m_s: float
    slip_m_s: float
    sideslip_deg: float
    camber_deg: float
    surface_c: float
    hub_c: float


def resultant(force_x_n: float, force_y_n: float, force_z_n: float) -> float:
    """Return the resultant coefficient sqrt(Fx^2 + Fy^2) / Fz of mean forces; NaN without a load."""
    return hypot(force_x_n, force_y_n) / force_z_n if force_z_n > 0.0 else float("nan")


def _block(burst: int, samples: int, t0: float, t1: float, angle: float, means: Sequence[float]) -> Block:
    return Block(burst, samples, t0, t1, angle, resultant(means[0], means[1], means[2]), *means)


class RevolutionCounter:
    """Collects the blocks of one repeat, sample by sample.

    Fed with the rows that are recorded, so that what is counted live is what the store can be asked about
    later.
    """

    __slots__ = ("_angle", "_burst", "_key", "_limit", "_origin", "_rows", "blocks", "seconds")

    def __init__(self) -> None:
        """Start with no blocks."""
        self.blocks: list[Block] = []
        self.seconds = 0.0
        """Accepted seconds in ``blocks``."""
        self._rows: list[tuple[float, ...]] = []
        self._burst = 0.0
        self._key = 0.0
        self._origin = 0.0
        self._angle = 0.0
        self._limit = 1.0

    def add(self, sample: tuple[float, ...]) -> Block | None:
        """Take in one sample (columns of SAMPLE_COLUMNS) and return the block that it completed, if any.

        Every scan is to be given, also those whose gates are closed: they end a stretch.
        """
        rows = self._rows
        if sample[_GATE] != 0.0 or sample[_BURST] == 0.0:
            if rows:
                rows.clear()
            return None
        angle = sample[_ANGLE]
        if (
            not rows
            or sample[_BURST] != self._burst
            or sample[_KEY] != self._key
            or not -MAX_STEP_REV <= angle - self._angle <= MAX_STEP_REV
        ):
            rows.clear()
            rows.append(sample)
            self._burst = sample[_BURST]
            self._key = sample[_KEY]
            self._origin = self._angle = angle
            self._limit = 1.0
            return None
        self._angle = angle
        if abs(angle - self._origin) < self._limit:
            rows.append(sample)
            return None
        self._limit += 1.0
        return self._close(sample)

    def _close(self, sample: tuple[float, ...]) -> Block:
        rows = self._rows
        count = len(rows)
        columns = list(zip(*rows, strict=True))
        means = [sum(columns[i]) / count for i in _AVERAGED]
        block = _block(int(self._burst), count, columns[_TIME][0], sample[_TIME], columns[_ANGLE][0], means)
        self.blocks.append(block)
        self.seconds += block.ended_s - block.started_s
        rows.clear()
        rows.append(sample)
        return block


def blocks_from_samples(columns: Mapping[str, NDArray[np.float64]]) -> list[Block]:
    """Return the blocks in stored samples, arrays of equal length by SAMPLE_COLUMNS, in order of time."""
    import numpy as np

    accepted = (columns["gate"] == 0.0) & (columns["burst"] != 0.0)
    angle, burst, key = columns["wheel_angle_rev"], columns["burst"], columns["repeat_key"]
    # A sample continues a stretch when it and the one before are accepted and nothing broke between them.
    joined = np.zeros(len(angle), dtype=bool)
    joined[1:] = (
        accepted[1:]
        & accepted[:-1]
        & (burst[1:] == burst[:-1])
        & (key[1:] == key[:-1])
        & (np.abs(np.diff(angle)) <= MAX_STEP_REV)
    )
    origins = np.flatnonzero(accepted & ~joined)
    ends = np.append(origins, len(angle))[1:]
    times = columns["time_s"]
    averaged = np.stack([columns[name] for name in AVERAGED])
    blocks: list[Block] = []
    for first, end in zip(origins.tolist(), ends.tolist(), strict=True):
        stop = first + 1 + int(np.argmin(np.append(joined[first + 1 : end], False)))
        # A reading that steps back over a boundary does not reopen the block behind it.
        turn = np.maximum.accumulate(np.floor(np.abs(angle[first:stop] - angle[first])))
        edges = first + np.flatnonzero(np.diff(turn, prepend=-1.0))
        for a, b in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            means = averaged[:, a:b].mean(axis=1).tolist()
            blocks.append(_block(int(burst[a]), b - a, float(times[a]), float(times[b]), float(angle[a]), means))
    return blocks
