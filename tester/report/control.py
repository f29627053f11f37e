"""The control chart: one condition, measured again and again, shows what the machine does meanwhile."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from tester.analysis.reference import ControlChart, ControlPoint
from tester.base.words import coefficient
from tester.report.chart import Chart, ChartPanel, Series

LABEL = "friction coefficient"


def control_chart(charts: Sequence[ControlChart]) -> Chart:
    """Return the charts of the references, one a compound, over their turn; those out of limits are crosses."""
    panels = tuple(ChartPanel(one.compound if len(charts) > 1 else "", _series(one)) for one in charts)
    return Chart(
        "control",
        "reference condition in the order in which it was measured",
        "turn of the reference condition",
        LABEL,
        panels,
        "bars: expanded repeatability (95 %); dashed: limits about the first",
        from_zero=False,
    )


def _series(chart: ControlChart) -> tuple[Series, ...]:
    valued = [one for one in chart.points if isfinite(one.mu)]
    inside = [one for one in valued if one.within]
    outside = [one for one in valued if not one.within]
    along = tuple(float(one.number) for one in chart.points)
    return (
        *([_points("in control", inside, 0)] if inside else []),
        *([_points("out of control", outside, 1)] if outside else []),
        Series("limits", along, (chart.low,) * len(along), "limit", 1),
        Series("", along, (chart.high,) * len(along), "limit", 1),
    )


def _points(label: str, points: Sequence[ControlPoint], style: int) -> Series:
    return Series(
        label,
        tuple(float(one.number) for one in points),
        tuple(one.mu for one in points),
        "left out" if style else "measured",
        style,
        tuple(one.expanded for one in points),
        names=tuple(
            f"turn {one.number}: {coefficient(one.mu)}\u00a0±\u00a0{coefficient(one.expanded)}" for one in points
        ),
    )
