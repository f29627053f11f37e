"""The conditions of a specimen on a track as a master curve takes them, unless friction warms the contact.

A row whose contact friction warms beyond its band of temperature is not at the temperature that is on record
(``heat.rise`` of the rig times the power of friction). A run with such a row is refused as a whole: which rows are
wrong by a little less is not known.
"""

from __future__ import annotations

from math import hypot
from pathlib import Path
from typing import Final

from tester.analysis.fit.fit_law import FitPoint
from tester.analysis.master_curve.points import MasterPart, MasterPoint, MasterRun, MasterSource
from tester.kinds.specimen_on_track.axes import INTERFACES, held_by
from tester.kinds.specimen_on_track.fit.friction_heat import BEYOND_BAND, beyond_band, rise_of, warmed_k
from tester.kinds.specimen_on_track.fit.run_data import INTERFACE, LOAD, SPEED, TEMPERATURE, points_of
from tester.results.run_results import RunResults, results_of
from tester.store.run_reader import RunReader


class TrackMasters:
    """Conditions of a specimen on a track."""

    def run(self, folder: Path) -> MasterRun:
        """Return the conditions of a run; raises StoreError where it cannot be read, InvalidSource for its rig file."""
        with RunReader(folder) as reader:
            results = results_of(reader)
        found = points_of(folder.name, results)
        return MasterRun(tuple(_point(one) for one in found.points), found.left_out, _heated(results))

    def packaged(self, name: str) -> MasterRun:
        """Raise KeyError: no conditions of a track ship with the program."""
        raise KeyError(name)


def _heated(results: RunResults) -> str:
    """Return which rows friction warms beyond their band, "" where none is."""
    rise_k_w = rise_of(results.run.info)
    rows = [one for one in results.conditions() if beyond_band(one, rise_k_w)]
    if not rows:
        return ""
    worst = max(rows, key=lambda one: warmed_k(one, rise_k_w))
    held = held_by(worst.info.setpoint)
    return (
        f"{BEYOND_BAND} in {len(rows)} rows: by {warmed_k(worst, rise_k_w):.1f} K at {1e3 * held.track_m_s:g} mm/s and"
        f" {held.temperature_c:g} degC, band {worst.info.temperature_band_k:g} K (heat.rise of the rig times the power"
        " of friction)"
    )


def _point(one: FitPoint) -> MasterPoint:
    thermometer = next(common.standard for common in one.source.common if common.variable == TEMPERATURE)
    gain = hypot(*(c.standard for c in one.source.common if c.variable is None and c.piece in (0, one.piece)))
    held = {"interface": INTERFACES[round(one.nominal[INTERFACE])], "load": f"{one.nominal[LOAD]:g} N"}
    return MasterPoint(
        one.label, one.group, one.measured[SPEED], one.measured[TEMPERATURE], one.nominal[TEMPERATURE], one.value,
        MasterSource(one.source.name, gain, thermometer), held,
    )  # fmt: skip


MASTERS: Final[MasterPart] = TrackMasters()
