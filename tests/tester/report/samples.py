"""Made-up charts whose pictures can be compared."""

from __future__ import annotations

from typing import Final

from tester.analysis.reference_watch import ControlChart, ControlPoint
from tester.report.chart import Chart, ChartPanel, ChartSurface, Figure, Series
from tester.report.charts import control_chart

NAN = float("nan")
LOADS = (100.0, 200.0, 300.0, 400.0)

CHART: Final = Chart(
    "load",
    "friction coefficient over load at each temperature",
    "load (N)",
    "friction coefficient",
    (
        ChartPanel(
            "1#, 300 mm/s",
            (
                Series("25 °C", LOADS, (0.88, 0.73, 0.63, 0.52), "measured", 0, (0.03, 0.03, 0.02, 0.05)),
                Series("", LOADS[:2], (0.9, 0.7), "published", 0),
                Series("55 °C", LOADS, (1.02, 0.85, 0.74, 0.61), "measured", 1, (0.04, NAN, 0.02, 0.02)),
                Series("", (100.0, 400.0), (1.0, 0.6), "law", 1),
            ),
        ),
        ChartPanel("2#, 300 mm/s", (Series("55 °C", LOADS, (0.94, 0.68, 0.52, 0.50), "measured", 1),)),
    ),
    "bars: expanded uncertainty U (95 %); hollow: as published; lines: law paper",
)
SURFACE: Final = ChartSurface(
    "surface",
    "friction coefficient over load and slip velocity",
    "load (N)",
    "slip velocity (mm/s)",
    "friction coefficient",
    (("1#, 25 degC", (100.0, 200.0), (0.0, 100.0, 300.0), ((NAN, 0.39), (NAN, 0.51), (0.88, 0.73))),),
    "empty: not measured",
)
REPEATS: Final = Chart(
    "repeats",
    "repeats of 1#, 300 mm/s, 200 N, 25 degC: 0.730\u00a0±\u00a00.028",
    "rig time (min)",
    "friction coefficient",
    (
        ChartPanel(
            "",
            (
                Series("in the mean", (1.0, 2.5), (0.73, 0.735), "measured", 0, (0.004, 0.003), (0.4, 0.6)),
                Series("left out", (4.0,), (0.78,), "left out", 1, (0.01,), (0.3,)),
            ),
        ),
    ),
    "along: from begin to end of each repeat",
    from_zero=False,
)
REFERENCES: Final = tuple(
    ControlPoint(i, 4 * i, 600.0 * i, mu, 0.02, mu < 0.74) for i, mu in enumerate((0.70, 0.71, 0.69, 0.77, 0.70), 1)
)
CONTROL: Final = control_chart([ControlChart("1#", 0.70, 0.66, 0.74, REFERENCES)])
OVERVIEW: Final = Chart(
    "overview",
    "the run: 3 conditions in order of time",
    "rig time (min)",
    "coefficient",
    (
        ChartPanel(
            "",
            (
                Series("1#", (5.0, 15.0, 27.0), (0.9, 0.73, 0.6), "measured", 0, (0.04, 0.03, 0.05), (4.0, 5.0, 6.0)),
                Series("make-up repeat", (19.0,), (0.74,), "published", 1),
                Series("repeat left out", (12.0,), (0.82,), "left out", 2),
            ),
            "coefficient",
        ),
        ChartPanel(
            "",
            (Series("", (5.0, 15.0, 27.0), (100.0, 200.0, 400.0), "measured", 0, widths=(4.0, 5.0, 6.0)),),
            "load (N)",
        ),
    ),
    "bars: U (95 %) of what was mounted",
    from_zero=False,
    stacked=True,
)
FIGURES: Final[dict[str, Figure]] = {one.name: one for one in (CHART, SURFACE, REPEATS, CONTROL, OVERVIEW)}
