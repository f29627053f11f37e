"""Charts of laws, as data: a master curve, and the parts of a coefficient over one quantity."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from tester.analysis.master_curve.fitted_curve import Master
from tester.report.chart import Chart, ChartPanel, Look, Series
from tester.report.charts import Y_LABEL

PLACES: Final = 300
"""Points of the drawn curve."""
STYLES: Final = 8
"""Number of distinct colours and marks of a drawing."""


def master_chart(master: Master) -> Chart:
    """Return the figure: on the left the measured values, on the right the same over aT v with the spline.

    Each temperature has a colour and a mark of its own; from the ninth on the marks are hollow.
    """
    of, rows = master.collapse.of, master.rows()
    measured: list[Series] = []
    collapsed: list[Series] = []
    for i, block_c in enumerate(of.blocks_c):
        rows_of = [row for row, block in zip(rows, of.block, strict=True) if block == i]
        mu = tuple(row.mu for row in rows_of)
        label = f"{block_c:g} °C"
        look: Look = "published" if i // STYLES % 2 else "measured"
        measured.append(Series("", tuple(row.speed_m_s for row in rows_of), mu, look, i))
        collapsed.append(Series(label, tuple(float(10.0**row.x) for row in rows_of), mu, look, i))
    x = np.linspace(float(np.min(master.collapse.x)), float(np.max(master.collapse.x)), PLACES)
    curve_x = tuple(float(10.0**at) for at in x - master.back)
    curve_mu = tuple(float(mu) for mu in np.exp(master.collapse.curve.at(x)))
    collapsed.append(Series("spline", curve_x, curve_mu, "limit", 0))
    first = master.points[0]
    others = "".join(f", {words}" for words in first.held.values())
    c = master.collapse
    ts = f"Ts {c.ts_c:.1f} °C" + ("" if c.searched else ", given")
    return Chart(
        name="master",
        title=f"{first.compound}{others}: {master.judged.verdict.value}",
        x_label="v /m·s⁻¹",
        y_label="friction coefficient",
        panels=(
            ChartPanel("measured", tuple(measured)),
            ChartPanel(
                f"shifted by WLF, {ts}", tuple(collapsed), x_label=f"aT v /m·s⁻¹ at {master.reference_c:g} °C",
                joined=False,
            ),
        ),
        note=f"scatter about the curve {100.0 * c.scatter_rms:.1f} % of mu",
        own_x=True,
        log_x=True,
    )


def masters_chart(masters: Sequence[Master]) -> Chart:
    """Return the figure of several master curves over aT v, each with its spline, colour and mark."""
    series: list[Series] = []
    for i, master in enumerate(masters):
        first, rows = master.points[0], master.rows()
        look: Look = "published" if i // STYLES % 2 else "measured"
        label = ", ".join((first.compound, *first.held.values()))
        series.append(Series(label, tuple(float(10.0**row.x) for row in rows), tuple(row.mu for row in rows), look, i))
        x = np.linspace(float(np.min(master.collapse.x)), float(np.max(master.collapse.x)), PLACES)
        mu = tuple(float(value) for value in np.exp(master.collapse.curve.at(x)))
        series.append(Series("", tuple(float(10.0**at) for at in x - master.back), mu, "limit", 0))
    return Chart(
        name="masters",
        title="master curves",
        x_label=f"aT v /m·s⁻¹ at {masters[0].reference_c:g} °C",
        y_label="friction coefficient",
        panels=(ChartPanel("", tuple(series), joined=False),),
        log_x=True,
    )


def components_chart(
    at: Callable[[float], tuple[float, float]], x: Sequence[float], x_label: str, title: str, note: str
) -> Chart:
    """Return the chart of a law's parts at values of one quantity (``x``, above 0, drawn on a logarithmic axis).

    ``at`` returns adhesion and hysteresis.
    """
    parts = [at(value) for value in x]
    lines = {
        "adhesion": tuple(value for value, _ in parts),
        "hysteresis": tuple(value for _, value in parts),
        "sum": tuple(sum(value) for value in parts),
    }
    series = tuple(Series(name, tuple(x), y, "law", style) for style, (name, y) in enumerate(lines.items()))
    return Chart("components", title, x_label, Y_LABEL, (ChartPanel("", series),), note, log_x=True)
