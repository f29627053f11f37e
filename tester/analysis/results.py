"""Results of the analysis as plain values, shared with the store: repeats, conditions, checks after a soak.

Units are in the names. NaN marks a missing value; the store keeps it as NULL.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from typing import Final

from tester.analysis.flags import DOUBTS, flags_in
from tester.base.quantities import Means

NAN = float("nan")
NO_MEANS: Final = Means()
"""Means of a repeat without measurements."""


class RepeatStatus(StrEnum):
    """How a repeat ended. Only VALID repeats enter a mean; a VOID one is repeated under the same number.

    A repeat that was committed VALID may become REFUSED when its condition is judged; a make-up repeat replaces it.
    """

    OPEN = "open"
    """Begun and not committed: in progress, or cut off."""
    VALID = "valid"
    REFUSED = "refused"
    """It drifts, or differs from its siblings; it keeps its figures, and the reason."""
    TOO_FEW = "too few revolutions"
    CANNOT_HOLD = "temperature cannot be held"
    NOT_REACHED = "not reached"
    VOID = "void"
    """Interrupted in contact; a further attempt replaces it."""


class ConditionStatus(StrEnum):
    """Whether a condition has a trustworthy value, and if not, why."""

    OK = "ok"
    PENDING = "not measured"
    INSUFFICIENT = "insufficient"
    CANNOT_HOLD = "temperature cannot be held"
    NOT_REACHED = "not reached"
    SKIPPED = "skipped"


@dataclass(frozen=True, slots=True)
class Swing:
    """Swing of friction within a revolution, apart from the wheel's orders (``tester.analysis.swing``).

    ``percent``: amplitude in per cent of the mean, 0 where there is none; ``hz``: frequency; ``skewness``: of the
    differences between neighbouring samples. NaN where unknown. ``seen_percent``: lower limit of the amplitude of a
    swing too fast for the samples to show all of it.
    """

    percent: float = NAN
    hz: float = NAN
    skewness: float = NAN
    seen_percent: float = NAN


@dataclass(frozen=True, slots=True)
class RepeatResult:
    """One repeat's coefficient and the channels measured with it.

    The coefficients are ratios of means (module ``reduce``); times are rig seconds. ``uncertainty`` is the standard
    uncertainty of ``mu_resultant`` from ``batches`` batch means, ``fluctuation_percent`` the batch means' standard
    deviation in per cent of it. ``drift_percent`` and ``bound_percent`` (90 %) are per window, in per cent of the
    coefficient: of the repeat alone until its condition is judged, then with the condition's sensitivity to
    temperature. ``change_percent`` is the greatest change of level within it, in per cent of the coefficient, including
    the revolutions left out as transient.
    """

    status: RepeatStatus
    reason: str = ""
    flags: str = ""
    """Words of ``tester.analysis.flags`` (``joined``)."""
    mu_resultant: float = NAN
    mu_longitudinal: float = NAN
    mu_lateral: float = NAN
    uncertainty: float = NAN
    fluctuation_percent: float = NAN
    batches: int = 0
    drift_percent: float = NAN
    bound_percent: float = NAN
    change_percent: float = NAN
    swing_percent: float = NAN
    """Amplitude of the swing of friction within a revolution, in per cent of it (``Swing``), ..."""
    swing_hz: float = NAN
    """... its frequency, ..."""
    swing_skewness: float = NAN
    """... and the skewness of its differences between neighbouring samples."""
    revolutions: int = 0
    """Whole accepted revolutions behind the coefficient."""
    truncated: int = 0
    """Whole accepted revolutions left out as transient."""
    window_s: float = NAN
    """Accepted seconds behind the coefficient."""
    bursts: int = 0
    means: Means = NO_MEANS
    """Means of the averaged channels, over the blocks that count."""
    started_s: float = NAN
    ended_s: float = NAN

    @property
    def valid(self) -> bool:
        """Return whether the coefficient may enter a mean."""
        return self.status is RepeatStatus.VALID

    @property
    def drifts(self) -> bool:
        """Return whether the repeat was refused for its drift; it then has a coefficient."""
        return self.status is RepeatStatus.REFUSED and isfinite(self.drift_percent) and self.mu_resultant > 0.0


def greatest_swing(swings: Iterable[tuple[float, float]]) -> tuple[float, float]:
    """Return the greatest of several swings, each per cent of the mean and Hz; an unknown one ranks last.

    Needs at least one.
    """
    return max(swings, key=lambda swing: swing[0] if swing[0] >= 0.0 else -1.0)


@dataclass(frozen=True, slots=True)
class Judgement:
    """The drift of a condition from all its repeats; NaN where it was not judged (0 mm/s).

    Drift, standard error and bound (90 %) in per cent of the coefficient a window, the sensitivity in %/K.
    ``repeat_windows``: mean number of windows that a repeat collected. ``trend_percent``: change of the coefficient
    from the first repeat to the last along the sliding distance. ``flags``: NOT_SHOWN, CARRY_OVER, IMPRECISE.
    """

    drift_percent: float = NAN
    drift_error_percent: float = NAN
    drift_bound_percent: float = NAN
    per_kelvin_percent: float = NAN
    repeat_windows: float = NAN
    trend_percent: float = NAN
    flags: str = ""

    @property
    def made(self) -> bool:
        """Return whether the drift was judged."""
        return isfinite(self.drift_percent)


NOT_JUDGED: Final = Judgement()


@dataclass(frozen=True, slots=True)
class Burst:
    """One contact within a repeat: accepted whole revolutions, rig seconds, surface temperature in degC."""

    number: int
    revolutions: int
    started_s: float
    ended_s: float
    surface_first_c: float
    surface_last_c: float


@dataclass(frozen=True, slots=True)
class SoakCheck:
    """Reading of the surface's thermometer at the end of a condition's soak, and its expected value.

    Temperatures in degC: ``surface_c`` by the thermometer, ``hub_c`` by the heater's sensor, ``model_c`` of the surface
    by a model of the heat flow from the hub. ``allowed_k``: largest difference that the uncertainties of
    sensors and model explain, K.
    """

    condition: int
    t_s: float
    surface_c: float
    model_c: float
    hub_c: float
    allowed_k: float

    @property
    def off_k(self) -> float:
        """Return the thermometer's reading less its expected value, K."""
        return self.surface_c - self.model_c

    @property
    def agrees(self) -> bool:
        """Return whether the difference is within its limit."""
        return abs(self.off_k) <= self.allowed_k


NOT_TRUSTED: Final = "!"
"""Mark of a number without a trustworthy value."""
WITH_CARE: Final = "?"
"""Mark of a value that carries a flag of DOUBTS."""


def mark_of(status: ConditionStatus | str, flags: str) -> str:
    """Return the mark of a condition's number: ``!`` not to be trusted, ``?`` with care, "" trusted.

    ``flags`` as in a condition's result, one text.
    """
    if status != ConditionStatus.OK:
        return NOT_TRUSTED
    return WITH_CARE if any(flag in DOUBTS for flag in flags_in(flags)) else ""
