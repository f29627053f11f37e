"""The sensor of the arm's height: zero, sign and scale by gauge blocks under the specimen.

Where friction may be too low to show contact, this sensor shows it: a wrong zero or scale would hide a lost specimen.
"""

from __future__ import annotations

from functools import partial
from math import isfinite, nan
from typing import Final

from tester.inputs.rig.config import values_of
from tester.kinds.specimen_on_track.interlocks.witness import THICKNESS_MM
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, choose, mean_of
from tester.machine.commission.quiet_seat import JogSeat
from tester.machine.commission.stages import in_stages, judged

BLOCKS_MM: Final = (0.0, 1.0, 2.0)
"""Gauge blocks [A]: inside the travel that matters, `wear` and `thickness` to either side of the zero."""
SCALE_SHARE: Final = 0.05
"""Tolerance of the scale [A]: of the 1 mm that shows a lost specimen it takes 0.05 mm."""
DEAD_SHARE: Final = 0.02
"""A reading that follows less of a block is dead [A]."""
INCH_MM: Final = 25.4
AVERAGE_S: Final = 2.0
"""Averaging time of a height, s [A]: its noise of 3 um leaves less than 1 um."""
ZERO_SHARE: Final = 0.5
"""Share of ``interlocks.thickness`` that the zero may take [A]: specimens and heat take the rest."""


def gauge(seat: JogSeat, notes: Notes) -> Dialogue:
    """Compare the sensor with gauge blocks; raises StepRefused."""
    rig = TrackConfig.of(seat.believed)
    if seat.devices.height is None:
        notes.text = "no sensor of the arm's height"
        return
    gauged = _Gauged(rig, seat, notes)
    points = [partial(gauged.point, block_mm) for block_mm in BLOCKS_MM]
    yield from in_stages(notes, *points, judged(points[0], gauged.judge))


class _Gauged:
    """The stages of the comparison."""

    def __init__(self, rig: TrackConfig, seat: JogSeat, notes: Notes) -> None:
        """Nothing is read yet."""
        self.notes = notes
        self.sensor = seat.devices.height
        self.zero_most_mm = ZERO_SHARE * values_of(rig.interlocks, rig.table.parameters)[THICKNESS_MM]
        self.read_mm: dict[float, float] = {}

    def point(self, block_mm: float) -> Dialogue:
        """Read the height with the arm down on a block."""
        under = f"a gauge block of {block_mm:g} mm" if block_mm else "nothing"
        text = f"no weights; a new specimen in its holder, the arm down on the track with {under} between them; done?"
        yield from choose(f"block {block_mm}", text, "yes")
        self.read_mm[block_mm] = read_mm = yield from mean_of(self._reading_mm, AVERAGE_S)
        if not isfinite(read_mm):
            raise StepRefused("height sensor: no valid reading; its range, its cable, or its target")
        self.notes.read(f"block of {block_mm:g} mm", {"height_mm": read_mm})

    def _reading_mm(self) -> float:
        return self.sensor.values[0] if self.sensor.valid else nan

    def judge(self) -> None:
        """Judge sign, scale and zero, and record them; raises StepRefused."""
        zero_mm, most_mm = self.read_mm[0.0], BLOCKS_MM[-1]
        scale = (self.read_mm[most_mm] - zero_mm) / most_mm
        shown = ", ".join(f"{read_mm:+.2f} mm on {block_mm:g} mm" for block_mm, read_mm in self.read_mm.items())
        if abs(scale) < DEAD_SHARE:
            raise StepRefused(f"height sensor: it does not follow the arm ({shown}): its target, channel or cable")
        if scale < 0.0:
            raise StepRefused(f"height sensor: it falls when the arm rises ({shown}): turn its sign in its profile")
        if abs(scale - 1.0) > SCALE_SHARE:
            inches = any(abs(scale / unit - 1.0) <= SCALE_SHARE for unit in (INCH_MM, 1.0 / INCH_MM))
            why = "inches for millimetres" if inches else "the scale in its profile, or a lever between arm and sensor"
            raise StepRefused(f"height sensor: it shows {scale:.3f} mm for each mm ({shown}): {why}")
        if abs(zero_mm) > self.zero_most_mm:
            raise StepRefused(
                f"height sensor: its zero is {zero_mm:+.2f} mm off, at most {self.zero_most_mm:g} mm"
                " (half of interlocks.thickness): set it with a new specimen on the track"
            )
        self.notes.values = {"zero_mm": round(zero_mm, 4), "scale": round(scale, 4)}
        self.notes.text = f"zero {zero_mm:+.3f} mm, {scale:.3f} mm for each mm of gauge blocks"
