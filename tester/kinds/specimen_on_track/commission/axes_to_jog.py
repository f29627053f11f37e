"""The axes of this machine for jogging (tester.machine.commission.jog_axis): ways and speeds are [A]."""

from __future__ import annotations

from typing import Final

from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused
from tester.machine.commission.jog_axis import JoggedAxis, jog_axis
from tester.machine.commission.jogging import JogSpeeds
from tester.machine.commission.quiet_seat import JogSeat

SLOW_M_S, SLOW_M = 0.002, 0.002
FAST_M_S, WAY_M = 0.01, 0.1
"""First jog and measured jog of a linear track: 100 mm by a ruler with half millimetres are known to 0.3 %."""
DISC_SLOW_M_S, DISC_SLOW_M, DISC_FAST_M_S = 0.02, 0.02, 0.05
"""The same of a disc; its measured way is a revolution."""
LIFT: Final = JoggedAxis(
    "lift", JogSpeeds(0.5, -0.5, 2.0, -4.0), "mm", "a dial gauge on the raised arm", "down, towards the track",
    0.02, 0.01, True, factor=-1.0,
)  # fmt: skip


def track_axis(rig: TrackConfig) -> JoggedAxis:
    """Return the track of a rig."""
    metres, most = rig.metres, rig.limits.track_speed_m_s
    positive = "forward, the way in which the specimen is dragged by a force above 0"
    if rig.linear:
        speeds = JogSpeeds(SLOW_M_S / metres, SLOW_M / metres, min(FAST_M_S, most) / metres, WAY_M / metres)
        return JoggedAxis("track", speeds, "mm", "a ruler beside the track", positive, 0.01, 0.25, True,
                          factor=1e3 * metres)  # fmt: skip
    speeds = JogSpeeds(DISC_SLOW_M_S / metres, DISC_SLOW_M / metres, min(DISC_FAST_M_S, most) / metres, 0.0)
    return JoggedAxis("track", speeds, "deg", "a protractor, or marks on the disc and beside it", positive, 0.02, 0.5,
                      False, factor=1e3 * metres, disc=True)  # fmt: skip


def jog_track(seat: JogSeat, notes: Notes) -> Dialogue:
    """Jog the track for direction and scale; raises StepRefused."""
    rig = TrackConfig.of(seat.believed)
    axis = track_axis(rig)
    if rig.linear:
        place_mm = axis.shown(seat.jogging.drive("track").actual)
        most_mm = rig.limits.travel_high_mm - 1e3 * WAY_M
        if not rig.limits.travel_low_mm <= place_mm <= most_mm:
            raise StepRefused(
                f"the track is at {place_mm:.1f} mm by its drive: move it by hand, its drive off, to between"
                f" {rig.limits.travel_low_mm:g} and {most_mm:g} mm (limits.travel), so that {1e3 * WAY_M:g} mm are free"
            )
    yield from jog_axis(axis, seat, notes)
