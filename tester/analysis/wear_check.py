"""One check of a wheel's diameter, as it is measured and stored."""

from __future__ import annotations

from dataclasses import dataclass

from tester.analysis.results import NAN

NO_CONDITION = 0


@dataclass(frozen=True, slots=True)
class WearCheck:
    """One check of a wheel's diameter.

    ``method``: roll (the press's position under a light load) or person (a number in an answer). ``reference_s``: time
    of the series' first check, rig seconds. ``before``, ``after``: the conditions on either side, 0 for none.
    """

    piece: int
    """Number of the checked piece."""
    method: str
    t_s: float
    reference_s: float
    before: int
    after: int
    diameter_mm: float
    """Cold, at the rig file's ``wear.reference``."""
    u_mm: float
    """Standard uncertainty of the diameter, of this check alone."""
    rubber_c: float
    """Mean temperature of the rubber: the average of hub and surface."""
    u_growth_mm_k: float
    """Standard uncertainty of the correction for thermal growth of the diameter, per kelvin."""
    press_mm: float
    """Means over whole turns; NaN where a person measured."""
    load_n: float
    sliding_m: float
    """Distance slid since the wheel was new."""
    exposure_n_m: float
    """Load times distance slid since the wheel was new."""
    width_mm: float
    u_rate_percent: float
    """Standard uncertainty of a rate from exposure and width, relative."""
    used: int
    """1; 0: rejected (larger than the check before, or no rubber left)."""
    expected_mm: float = NAN
    """The diameter assumed until then, cold; NaN in a record without it."""
