"""The wheel's readings for the person's screen (tester.machine.commission.step_readings)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from tester.kinds.wheel_on_belt.commission.armed import WheelSeat
from tester.machine.commission.commission_step import StepReading
from tester.machine.commission.quiet_seat import QuietSeat
from tester.machine.commission.step_readings import STATES

SPEEDS: Final = (("wheel", "wheel_speed_m_s", "m/s", 3), ("belt", "belt_speed_m_s", "m/s", 3))
FORCES: Final = (("Fx", "force_x_n", "N", 1), ("Fy", "force_y_n", "N", 1), ("Fz", "force_z_n", "N", 1))
HEAT: Final = (("surface", "surface_c", "°C", 1), ("hub", "hub_c", "°C", 1), ("heat", "heat_percent", "%", 0))
PRESS: Final = (("press", "press_mm", "mm", 2),)


def of_trial(seat: QuietSeat) -> Sequence[StepReading]:
    """Return the speeds of wheel and belt, and the press's position, as their drives report them."""
    axes = seat.devices.axes
    radius_m = 0.5e-3 * seat.rig.geometry.wheel_diameter_mm
    shown = ((axes.wheel, radius_m, "m/s", 3), (axes.belt, 1.0, "m/s", 3), (axes.press, 1.0, "mm", 2))
    return tuple(
        StepReading(drive.config.name, scale * drive.actual, unit, decimals, STATES.get(drive.state, "no power"))
        for drive, scale, unit, decimals in shown
    )


def of_positions(seat: WheelSeat) -> Sequence[StepReading]:
    """Return the positions of the positioned axes."""
    return tuple(StepReading(name, value, "deg", 2) for name, value in seat.ctx.readings.positions.items())
