"""The track's rig during commissioning: jogged without scales, or armed as before every run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from tester.inputs.recipe.plan import Plan
from tester.inputs.rig import Rig
from tester.kinds.specimen_on_track.commission.axes_to_jog import LIFT, track_axis
from tester.kinds.specimen_on_track.context import TrackContext
from tester.kinds.specimen_on_track.devices import TrackDevices
from tester.kinds.specimen_on_track.procedures.arming import TrackArming
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.kinds.specimen_on_track.runs import RUNS
from tester.machine.commission.armed_seat import ArmedSeat
from tester.machine.commission.jogging import TORQUE_SHARE, CellWatch, Jogging, slowed
from tester.machine.commission.moves import COMMISSIONING
from tester.machine.commission.quiet_seat import JogSeat
from tester.machine.prompts import Prompts
from tester.machine.rig_ports import Ports
from tester.machine.run_parts import RunSetup
from tester.store.recorder import NullRecorder


def jog_seat(rig: Rig, ports: Ports, hands: Any) -> JogSeat:
    """Connect the rig for jogging: little torque in its drives, the lift slow."""
    believed = TrackConfig.of(rig)
    lift, most = believed.axes.lift, round(1000 * TORQUE_SHARE)
    if lift is not None and lift.software_limits is not None:
        # Not homed, its drive counts from where it was switched on: its limits are not at the ends of its travel.
        low, high = lift.software_limits
        lift = replace(lift, software_limits=(2.0 * low - high, 2.0 * high - low))
    axes = replace(
        believed.axes,
        track=slowed(believed.axes.track, track_axis(believed).speeds, most),
        lift=slowed(lift, LIFT.speeds, most) if lift is not None else None,
    )
    bounded = replace(believed, axes=axes)
    devices = TrackDevices(bounded, ports)
    jogging = Jogging(devices, _watch(devices, believed))
    return JogSeat(believed, TrackArming(devices, bounded), jogging, believed.arming.listen_s)


def _watch(devices: TrackDevices, rig: TrackConfig) -> CellWatch:
    most = rig.arming.unloaded_n

    def touches(change: Sequence[float]) -> str:
        if abs(change[0]) <= most:
            return ""
        return (
            f"the load cell has changed by {change[0]:.1f} N while an axis was jogged (at most {most:g} N,"
            " arming.unloaded): the specimen touches, or something is in the way"
        )

    bounds = rig.interlocks
    return CellWatch(devices.cell, bounds.stale_cell_s + bounds.stale_cell_delay_s, touches)


class TrackSeat(ArmedSeat):
    """The track's rig during the later steps, with the arm raised."""

    def __init__(self, rig: Rig, ports: Ports, hands: Any) -> None:
        """Send nothing."""
        self.rig = believed = TrackConfig.of(rig)
        plan = Plan(COMMISSIONING, (), (), 1, kind=rig.kind)
        super().__init__(RUNS.build(RunSetup(believed, plan, ports, hands, NullRecorder(), Prompts())), plan)
        self.ctx: TrackContext = self.run.engine.ctx

    def guarded(self) -> bool:
        """Return whether guard and safety chain are closed."""
        r = self.ctx.readings
        return r.guard_closed and r.safety_chain
