"""The wheel's rig with untested scales (tester.machine.commission.quiet_seat)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import hypot
from typing import Any, Final

from drivers.axis import AxisConfig
from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.arming import WheelArming
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.commission.jogging import TORQUE_SHARE, CellWatch, Jogging, JogSpeeds, slowed
from tester.machine.commission.quiet_seat import JogSeat
from tester.machine.rig_ports import Ports

PRESS_LOAD_N: Final = 60.0
"""Load that the press must still be able to produce, N [A]: its spring pulls back with 40 N."""
RELAY: Final = {name: f"; by a standstill relay: the scale of the {name} axis is wrong" for name in ("wheel", "belt")}
"""Why a jogged drive loses its torque: the relay acts from 0.1 m/s on, twice the speed of a jog at the right scale."""


def jog_rig(rig: RigConfig, speeds: Mapping[str, JogSpeeds]) -> RigConfig:
    """Return a rig with little torque in its drives and with slow positioned axes."""
    axes: dict[str, AxisConfig | None] = {}
    for name, axis in rig.axes.driven().items():
        most = round(1000 * TORQUE_SHARE)
        if name == "press" and axis.screw is not None:
            most = max(1, round(1000.0 * axis.screw.torque_nm(PRESS_LOAD_N) / axis.rated_torque_nm))
        axes[name] = slowed(axis, speeds[name], most)
    return replace(rig, axes=replace(rig.axes, **axes))


def jog_seat(speeds: Mapping[str, JogSpeeds], rig: Rig, ports: Ports, hands: Any) -> JogSeat:
    """Connect the rig for jogging."""
    believed = RigConfig.of(rig)
    bounded = jog_rig(believed, speeds)
    devices = Devices(bounded, ports)
    jogging = Jogging(devices, _watch(devices, believed), RELAY)
    return JogSeat(believed, WheelArming(devices, bounded), jogging, believed.arming.listen_s)


def _watch(devices: Devices, rig: RigConfig) -> CellWatch:
    most = rig.arming.unloaded_n

    def touches(change: Sequence[float]) -> str:
        x, y, z = change[:3]
        if hypot(x, y) <= most and abs(z) <= most:
            return ""
        return (
            f"the load cell has changed by Fz {z:.0f} N, friction {hypot(x, y):.0f} N while an axis was jogged"
            f" (at most {most:g} N, arming.unloaded): the wheel touches, or something is in the way"
        )

    bounds = rig.interlocks
    return CellWatch(devices.cell, bounds.stale_cell_s + bounds.stale_cell_delay_s, touches)
