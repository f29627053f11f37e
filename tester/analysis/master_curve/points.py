"""What a master curve is made of: measured conditions, and the arrays that stand for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Places = NDArray[np.intp]


class MasterError(ValueError):
    """No master curve can be made of conditions; the message says why, and what would do."""


@dataclass(frozen=True, slots=True)
class MasterSource:
    """A run: what its conditions share.

    ``gain``: standard uncertainty of a factor of all its coefficients, a share; ``thermometer_k``: of an error of all
    its temperatures.
    """

    name: str
    gain: float = 0.0
    thermometer_k: float = 0.0


@dataclass(frozen=True, slots=True)
class MasterPoint:
    """One measured condition: ``speed_m_s`` and ``mu`` above 0, ``block_c`` is the temperature that was asked for.

    ``held``: what else was held, in words by the name of its axis; a master curve is of conditions that share it.
    """

    label: str
    compound: str
    speed_m_s: float
    temperature_c: float
    block_c: float
    mu: float
    source: MasterSource
    held: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True, slots=True)
class MasterRun:
    """The conditions of a run, what was left out of it with the reason, and why none of it may go on a master curve.

    ``refusal`` is "" for a run that may.
    """

    points: tuple[MasterPoint, ...]
    left_out: tuple[tuple[str, str], ...] = ()
    refusal: str = ""


@dataclass(frozen=True, slots=True)
class MasterSet:
    """Conditions as arrays of shape (n,): log10 of the speed in m/s, degC, ln mu, place among ``blocks_c``."""

    points: tuple[MasterPoint, ...]
    log_v: Array
    celsius: Array
    log_mu: Array
    block: Places
    blocks_c: tuple[float, ...]
    source: Places
    gains: Array
    """Standard uncertainty of the factor of each source, shape (sources,)."""
    thermometer_k: float
    """Of an error of all temperatures; of several sources the largest, for one thermometer may have served all."""

    @property
    def in_block(self) -> Array:
        """Return a column of 1 and 0 for each temperature, shape (n, blocks)."""
        return np.asarray(self.block[:, None] == np.arange(len(self.blocks_c)), dtype=np.float64)


def set_of(points: Sequence[MasterPoint]) -> MasterSet:
    """Return the arrays of conditions, in order of temperature and speed. Raises MasterError for none."""
    if not points:
        raise MasterError("no condition is left to make a master curve of")
    ordered = tuple(sorted(points, key=lambda one: (one.block_c, one.speed_m_s)))
    blocks = sorted({one.block_c for one in ordered})
    sources = list(dict.fromkeys(one.source for one in ordered))
    return MasterSet(
        ordered,
        np.log10(np.array([one.speed_m_s for one in ordered])),
        np.array([one.temperature_c for one in ordered]),
        np.log(np.array([one.mu for one in ordered])),
        np.array([blocks.index(one.block_c) for one in ordered], dtype=np.intp),
        tuple(blocks),
        np.array([sources.index(one.source) for one in ordered], dtype=np.intp),
        np.array([one.gain for one in sources]),
        max(one.thermometer_k for one in sources),
    )
