"""Adhesion, hysteresis and their sum as a law has them, over one quantity: a chart without a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tester.report.chart import Chart, ChartPanel, Series
from tester.report.charts import Y_LABEL


def components_chart(
    at: Callable[[float], tuple[float, float]], x: Sequence[float], x_label: str, title: str, note: str
) -> Chart:
    """Return the chart of a law's parts at values of one quantity (``x``, above 0, which are set out by ratios).

    ``at`` returns adhesion and hysteresis.
    """
    found = [at(one) for one in x]
    lines = {
        "adhesion": tuple(one for one, _ in found),
        "hysteresis": tuple(one for _, one in found),
        "sum": tuple(sum(one) for one in found),
    }
    series = tuple(Series(name, tuple(x), y, "law", style) for style, (name, y) in enumerate(lines.items()))
    return Chart("components", title, x_label, Y_LABEL, (ChartPanel("", series),), note, log_x=True)
