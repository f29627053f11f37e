"""One check of a wheel's diameter, as it is measured and stored."""

from __future__ import annotations

from dataclasses import dataclass

from tester.analysis.results import NAN

NO_CONDITION = 0


@dataclass(frozen=True, slots=True)
class WearCheck:
    """One check of a wheel's diameter.

    ``method``: roll (the press's place under a light load) or person (a number in an answer). ``reference_s``: time of
    the series' first check, rig seconds. ``before``, ``after``: the conditions that it lies between, 0 for none.
    """

    piece: int
    """What was checked."""
    method: str
    t_s: float
    reference_s: float
    before: int
    after: int
    diameter_mm: float
    """Cold, at the rig file's ``wear.reference``."""
    u_mm: float
    """Standard uncertainty of the diameter, of this check by itself."""
    rubber_c: float
    """Mean temperature of the rubber: hub and surface by halves."""
    u_growth_mm_k: float
    """Standard uncertainty of the growth of the diameter that was taken off."""
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
    """1; 0: not believed (larger than the check before, or no rubber left)."""
    expected_mm: float = NAN
    """The diameter that was reckoned with until then, cold; NaN in a record that does not say."""
