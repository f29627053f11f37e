"""Master curves among a run's figures: one of each compound, interface and load that can have one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tester.analysis.master_curve.fitted_curve import master_of
from tester.analysis.master_curve.points import MasterError, MasterPoint
from tester.kinds.kind import Kind
from tester.report.law_charts import master_chart

if TYPE_CHECKING:
    from tester.report.chart import Chart

REFERENCE_C = 20.0
"""Where the curves stand, as ``tester master`` has it unless told."""


def master_charts(kind: Kind, folder: Path) -> list[Chart]:
    """Return a run's master curves, none where its kind has none, where friction heated it or they cannot be told.

    ``tester master`` says why; a figure's title has the verdict. Raises StoreError for a run that cannot be read.
    """
    if kind.masters is None:
        return []
    run = kind.masters().run(folder)
    alike: dict[tuple[object, ...], list[MasterPoint]] = {}
    for point in () if run.refusal else run.points:
        alike.setdefault((point.compound, *point.held.items()), []).append(point)
    charts: list[Chart] = []
    for points in alike.values():
        try:
            charts.append(master_chart(master_of(points, REFERENCE_C)))
        except MasterError:
            continue
    if len(charts) == 1:
        return charts
    return [replace(one, name=f"{one.name}-{number}") for number, one in enumerate(charts, start=1)]
