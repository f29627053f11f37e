"""The refusal of a master curve for a wheel on a belt, with the figures of each set of conditions.

A wheel under hundreds of newtons at tenths of a metre a second heats its surface by friction. A repeat is then a
stretch of a warming surface, within a band of temperature, and the rubber below has another temperature. Measurements
confirm it: mu of these rubbers has a maximum over temperature at every speed, and below this maximum it also rises
with speed. No shift of time against temperature allows that (``tester.analysis.master_curve.verdict``).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from statistics import median
from typing import Final

from tester.analysis.fit.fit_law import FitPoint, Sourced
from tester.analysis.master_curve.points import MasterPart, MasterPoint, MasterRun, MasterSource
from tester.analysis.master_curve.verdict import signs_of
from tester.base.axes import SURFACE
from tester.kinds.wheel_on_belt.fit.data import appendix
from tester.kinds.wheel_on_belt.fit.laws import LOAD, SLIP, TEMPERATURE
from tester.kinds.wheel_on_belt.fit.run_data import subject_of

COOL_W: Final = 1.0
"""Power of friction below which a surface is assumed to keep its temperature [A]: a slow block has less."""


def _run(folder: Path) -> MasterRun:
    from tester.kinds.wheel_on_belt.fit.run_data import run_points

    return _refused(run_points(folder))


def _packaged(name: str) -> MasterRun:
    return _refused(appendix(name))


def _refused(sourced: Sourced) -> MasterRun:
    """Return conditions with the reason against their master curve."""
    sliding = [point for point in sourced.points if point.measured[SLIP] > 0.0]
    rolling = [(point.label, "rolls without slip") for point in sourced.points if not point.measured[SLIP] > 0.0]
    points = tuple(_point(point) for point in sliding)
    powers = [point.value * point.measured[LOAD] * point.measured[SLIP] for point in sliding]
    hot = [power for power in powers if power > COOL_W]
    refusal = ""
    if hot:
        reasons = [
            f"friction heats the surface of the wheel with {median(hot):.0f} W (up to {max(hot):.0f} W), so a condition"
            " is a stretch of a warming surface and its temperature not that of the rubber"
        ]
        signs = signs_of(points)
        if signs.same:
            reasons.append(
                f"mu changes the same way with speed and with temperature in {signs.same} of {signs.cells} places where"
                " both are clear, which no shift of time against temperature allows"
            )
        refusal = "; ".join(reasons)
    return MasterRun(points, (*sourced.left_out, *rolling), refusal)


def _point(point: FitPoint) -> MasterPoint:
    subject = subject_of(point.group)
    belt = {SURFACE: subject.surface} if subject.surface else {}
    held: Mapping[str, str] = {**belt, "load": f"{point.nominal[LOAD]:g} N"}
    return MasterPoint(
        point.label, subject.compound, point.measured[SLIP], point.measured[TEMPERATURE], point.nominal[TEMPERATURE],
        point.value, MasterSource(point.source.name), held,
    )  # fmt: skip


MASTERS: Final = MasterPart(_run, _packaged)
