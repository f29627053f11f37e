"""A master curve with its peaks, neighbours and verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.physics.materials import Rubber
from sim.physics.wlf import PoleError
from tester.analysis.master_curve.collapse import RESAMPLES, Collapse, collapse, shifts
from tester.analysis.master_curve.overlap import TemperaturePair, pairs_of
from tester.analysis.master_curve.peaks import Peak, peaks_of
from tester.analysis.master_curve.points import MasterError, MasterPoint, set_of
from tester.analysis.master_curve.rules import Mechanism, Rule, rules_of
from tester.analysis.master_curve.shift_choice import ShiftChoice, choice_of
from tester.analysis.master_curve.verdict import LEAST_TEMPERATURES, MasterJudgement, judge


@dataclass(frozen=True, slots=True)
class MasterRow:
    """A row of the table: x = log10(aT v / 1 m/s) at the reference temperature, degC, m/s; ``off``: in ln mu."""

    x: float
    mu: float
    temperature_c: float
    speed_m_s: float
    off: float


@dataclass(frozen=True, slots=True)
class Master:
    """A master curve of conditions of one compound, at a reference temperature in degC."""

    reference_c: float
    collapse: Collapse
    pairs: tuple[TemperaturePair, ...]
    judged: MasterJudgement
    peaks: tuple[Peak, ...]
    bumps: int = 0
    """Maxima of the curve that may be due to its scatter."""
    rules: tuple[Rule, ...] = ()
    glass_c: float | None = None
    """Glass transition by the compound's file."""
    choice: ShiftChoice | None = None
    """WLF or Arrhenius, where Ts was searched over three temperatures or more."""

    @property
    def points(self) -> tuple[MasterPoint, ...]:
        """Return the conditions, in order of temperature and speed."""
        return self.collapse.of.points

    @property
    def back(self) -> float:
        """Return log10 aT of the reference temperature at Ts: x at Ts less x at the reference."""
        return float(shifts(np.array([self.reference_c]), self.collapse.ts_c)[0])

    def rows(self) -> tuple[MasterRow, ...]:
        """Return the rows of the table, in order of temperature and speed."""
        collapsed = self.collapse
        return tuple(
            MasterRow(float(x) - self.back, point.mu, point.temperature_c, point.speed_m_s, float(off))
            for x, off, point in zip(collapsed.x, collapsed.residual, self.points, strict=True)
        )


def master_of(
    points: Sequence[MasterPoint],
    reference_c: float,
    ts_c: float | None = None,
    rubber: Rubber | None = None,
    glass_c: float | None = None,
    resamples: int = RESAMPLES,
    only: Mechanism | None = None,
) -> Master:
    """Return the master curve of conditions; ``ts_c``: Ts of the shift, None: it is searched; ``rubber``: its moduli;
    ``glass_c``: its glass transition, where they are known; ``only``: the mechanism of a curve's only maximum.

    Raises MasterError where there is none: too few conditions, a temperature beyond the pole of the shift.
    """
    try:
        collapsed = collapse(set_of(points), ts_c, resamples)
        pairs = pairs_of(collapsed)
        peaks, bumps = peaks_of(collapsed, reference_c)
        rules = rules_of(rubber.modulus, reference_c, peaks, only) if rubber is not None else ()
    except PoleError as error:
        raise MasterError(f"no shift: {error}") from error
    several = collapsed.searched and len(collapsed.of.blocks_c) >= LEAST_TEMPERATURES
    choice = choice_of(collapsed) if several else None
    return Master(reference_c, collapsed, pairs, judge(collapsed, pairs), peaks, bumps, rules, glass_c, choice)
