"""Inputs of a master curve: a kind's conditions, and their arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tester.base.arrays import Array, Places
from tester.base.trouble import TroubleError


class MasterError(TroubleError, ValueError):
    """The conditions allow no master curve; the message gives the reason and a remedy."""


@dataclass(frozen=True, slots=True)
class MasterSource:
    """A run, with the errors that its conditions share.

    ``gain``: relative standard uncertainty of a factor common to all its coefficients; ``thermometer_k``: standard
    uncertainty of an error common to all its temperatures.
    """

    name: str
    gain: float = 0.0
    thermometer_k: float = 0.0


@dataclass(frozen=True, slots=True)
class MasterPoint:
    """One measured condition: ``speed_m_s`` and ``mu`` above 0, ``block_c`` is the nominal temperature.

    ``held``: the other setpoints, in words by the name of their axis; all conditions of a master curve share them.
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
    """The conditions of a run, those left out with the reason, and why the whole run is unsuitable.

    ``refusal`` is "" for a suitable run.
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
    """Standard uncertainty common to all temperatures; of several sources the largest, as they may share a
    thermometer."""

    @property
    def in_block(self) -> Array:
        """Return a column of 1 and 0 for each temperature, shape (n, blocks)."""
        return np.asarray(self.block[:, None] == np.arange(len(self.blocks_c)), dtype=np.float64)


def set_of(points: Sequence[MasterPoint]) -> MasterSet:
    """Return the arrays of conditions, in order of temperature and speed. Raises MasterError for none."""
    if not points:
        raise MasterError("no condition is left to make a master curve of")
    ordered = tuple(sorted(points, key=lambda condition: (condition.block_c, condition.speed_m_s)))
    blocks = sorted({condition.block_c for condition in ordered})
    sources = list(dict.fromkeys(condition.source for condition in ordered))
    return MasterSet(
        ordered,
        np.log10(np.array([condition.speed_m_s for condition in ordered])),
        np.array([condition.temperature_c for condition in ordered]),
        np.log(np.array([condition.mu for condition in ordered])),
        np.array([blocks.index(condition.block_c) for condition in ordered], dtype=np.intp),
        tuple(blocks),
        np.array([sources.index(condition.source) for condition in ordered], dtype=np.intp),
        np.array([source.gain for source in sources]),
        max(condition.thermometer_k for condition in sources),
    )


def _none_packaged(name: str) -> MasterRun:
    raise KeyError(name)


@dataclass(frozen=True, slots=True)
class MasterPart:
    """A kind's contribution to master curves."""

    run: Callable[[Path], MasterRun]
    """Returns the conditions of a run; raises StoreError where it cannot be read."""
    packaged: Callable[[str], MasterRun] = _none_packaged
    """Returns conditions that ship with the program; raises KeyError."""
