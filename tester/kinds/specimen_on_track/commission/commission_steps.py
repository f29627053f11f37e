"""The steps of this machine's commissioning, in their order, as data."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Final

from sim.physics.track_bells import RUBBERS
from tester.kinds.specimen_on_track.commission import air, first, force, height, load, travel, zero
from tester.kinds.specimen_on_track.commission.axes_to_jog import LIFT, jog_track, track_axis
from tester.kinds.specimen_on_track.commission.seats import TrackSeat, jog_seat
from tester.kinds.specimen_on_track.commission.twin import TrackPerson
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.commission_step import CommissionStep, StepReading
from tester.machine.commission.hung_weights import calibrate
from tester.machine.commission.jog_axis import jog_axis
from tester.machine.commission.person import CommissionPart
from tester.machine.commission.quiet_seat import JogSeat, QuietSeat
from tester.machine.commission.step_readings import identify, of_armed, of_axis, of_bus, of_cell

_BUS: Final = ("can", "lines", "devices")
_CELL: Final = ("devices.load_cell", "lines.load_cell")
_ALL: Final = (*_BUS, "axes", "track", "weights", "limits", "gates", "interlocks", "arming", "arm")
_FORCE: Final = (("force", "force_n", "N", 2),)
_TRACK: Final = (("track", "track_mm", "mm", 1), ("track's way", "way_m", "m", 3))
_AIR: Final = (("air", "air_c", "°C", 1), ("chamber", "chamber_percent", "%", 0))


def _of_track(seat: JogSeat) -> Sequence[StepReading]:
    """Return the track's readings."""
    return of_axis(track_axis(TrackConfig.of(seat.believed)))(seat)


def _of_air(seat: TrackSeat | QuietSeat) -> Sequence[StepReading]:
    """Return the air's readings where the rig has a chamber."""
    return of_armed(_AIR)(seat) if isinstance(seat, TrackSeat) else ()


STEPS: Final = (
    CommissionStep("identify", "who is on the wires", (*_BUS, "axes"), (), jog_seat, identify, readings=of_bus),
    CommissionStep("jog track", "direction and scale of the track", ("axes.track", "track"), ("identify",), jog_seat,
         jog_track, readings=_of_track, required=True),
    CommissionStep("jog lift", "direction and scale of the lift", ("axes.lift", "arm"), ("identify",), jog_seat,
         partial(jog_axis, LIFT), readings=of_axis(LIFT), required=True),
    CommissionStep("travel", "ends of the travel, and their switches",
         ("limits.travel_high", "limits.travel_low", "limits.track_speed", "interlocks.beyond", "axes.track", "track"),
         ("jog track",), jog_seat, travel.travel, readings=_of_track, required=True),
    CommissionStep("force", "friction force with hung weights", (*_CELL, "limits.force"), ("identify",), jog_seat,
         partial(calibrate, force.PLAN), readings=of_cell),
    CommissionStep("load", "load by weighing the arm", ("weights", "arm"), ("identify",), jog_seat, load.weigh,
         readings=of_cell),
    CommissionStep("height", "sensor of the arm's height by gauge blocks",
         ("devices", "lines", "arm", "interlocks"), ("identify",), jog_seat, height.gauge,
         readings=of_bus),
    CommissionStep("zero", "force with the arm raised while the track moves",
         ("axes", "limits", "track", "weights", *_CELL), ("jog track", "jog lift", "travel", "force"), TrackSeat,
         zero.zero, readings=of_armed(_FORCE, _TRACK)),
    CommissionStep("air", "chamber and thermometers", ("devices", "lines", "ambient", "limits"), ("identify",),
         air.air_seat, air.air, readings=_of_air),
    CommissionStep("lease", "the chamber's lease, provoked", ("devices", "lines"), ("identify",), jog_seat, air.lease,
         readings=of_bus),
    CommissionStep("first", "a first condition three times", _ALL, ("zero", "load", "air"), alone=first.coefficient),
)  # fmt: skip
"""In order of dependence."""

COMMISSIONS: Final = CommissionPart(STEPS, tuple(RUBBERS), TrackPerson)
