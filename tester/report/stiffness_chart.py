"""Deformation over temperature (after Figure 13 of the wheel's paper, which prints no numbers)."""

from __future__ import annotations

from collections.abc import Sequence

from tester.base.words import decimal
from tester.report.chart import Chart, ChartPanel, Mark, series_of
from tester.results.stiffness_table import StiffnessRow

NOTE = "bars: expanded uncertainty U (95 %); press and frame are in the deformation"


def stiffness_chart(rows: Sequence[StiffnessRow]) -> Chart | None:
    """Return the deformation over the rubber's mean temperature: a panel for each compound, a series for each load.

    None without rows.
    """
    panels: list[ChartPanel] = []
    for compound in dict.fromkeys(row.measured.info.compound for row in rows):
        own = [row for row in rows if row.measured.info.compound == compound]
        alike: dict[int, list[StiffnessRow]] = {}
        for row in own:
            alike.setdefault(10 * round(0.1 * row.here.load_n), []).append(row)
        series = [
            series_of(f"{load_n} N", [_mark(row) for row in sorted(listed, key=_body_c)], "measured", style)
            for style, (load_n, listed) in enumerate(sorted(alike.items()))
        ]
        rubber = own[0].rubber
        softening, relaxation = rubber.softening_per_k, rubber.relaxation
        title = f"{compound}: softening {_percent(softening)} %/K, relaxation {_percent(relaxation)} % a decade"
        panels.append(ChartPanel(title, tuple(series)))
    if not panels:
        return None
    return Chart(
        "deformation", "deformation over temperature", "mean temperature of the rubber (°C)", "deformation (mm)",
        tuple(panels), NOTE,
    )  # fmt: skip


def _body_c(row: StiffnessRow) -> float:
    return row.here.body_c


def _percent(found: tuple[float, float]) -> str:
    value, expanded = found
    return f"{decimal(100.0 * value, 2)} ± {decimal(100.0 * expanded, 2)}" if value == value else "unknown"


def _mark(row: StiffnessRow) -> Mark:
    depth_mm, expanded_mm = row.here.depth_mm
    return Mark(row.here.body_c, depth_mm, expanded_mm, name=f"{row.here.load_n:.0f} N, {depth_mm:.2f} mm")
