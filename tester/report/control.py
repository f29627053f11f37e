"""The control chart: one condition, measured again and again, shows what the machine does meanwhile."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from tester.analysis.results import NAN
from tester.report.chart import Chart, ChartPanel, Series

LABEL = "friction coefficient"


@dataclass(frozen=True, slots=True)
class ControlPoint:
    """A coefficient of the reference condition.

    ``order``: its turn in the run, counted from 1; ``u`` expanded (95 %), NaN where it is not known; ``low`` and
    ``high``: the limits between which it is in control, NaN where there are none.
    """

    order: int
    mu: float
    u: float = NAN
    low: float = NAN
    high: float = NAN

    @property
    def limited(self) -> bool:
        """Return whether there are limits."""
        return isfinite(self.low) and isfinite(self.high)

    @property
    def inside(self) -> bool:
        """Return whether it is known to be in control: within its limits, or without any."""
        return isfinite(self.mu) and (not self.limited or self.low <= self.mu <= self.high)


def control_chart(points: Sequence[ControlPoint]) -> Chart:
    """Return the chart of a reference condition over its turn; those out of control are drawn as crosses."""
    inside = [one for one in points if one.inside]
    outside = [one for one in points if not one.inside and isfinite(one.mu)]
    series = [
        _series(label, listed, look, style)
        for label, listed, look, style in (
            ("in control", inside, "measured", 0),
            ("out of control", outside, "left out", 1),
        )
        if listed
    ]
    limited = [one for one in points if one.limited]
    along = tuple(float(one.order) for one in limited)
    if limited:
        series.append(Series("limits", along, tuple(one.low for one in limited), "limit", 1))
        series.append(Series("", along, tuple(one.high for one in limited), "limit", 1))
    return Chart(
        "control",
        "reference condition in the order in which it was measured",
        "turn of the reference condition",
        LABEL,
        (ChartPanel("", tuple(series)),),
        "bars: expanded uncertainty U (95 %); dashed: limits",
        from_zero=False,
    )


def _series(label: str, points: Sequence[ControlPoint], look: str, style: int) -> Series:
    return Series(
        label,
        tuple(float(one.order) for one in points),
        tuple(one.mu for one in points),
        "measured" if look == "measured" else "left out",
        style,
        tuple(one.u for one in points),
        names=tuple(f"turn {one.order}: {one.mu:.3f}\u00a0±\u00a0{one.u:.3f}" for one in points),
    )
