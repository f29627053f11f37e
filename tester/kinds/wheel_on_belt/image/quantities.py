"""The channels of a wheel on a belt. Most parts of the system know a quantity only by its line here.

Forces are in the wheel frame: x along the wheel's plane (positive = the belt drags the wheel back), y lateral, z
normal. Speeds of the wheel are rim speeds.
"""

from __future__ import annotations

from typing import Final

from tester.base.quantities import BURST, GATE, KEY, TIME, Channel, Figure, Quantities, Roles, Screen
from tester.kinds.wheel_on_belt.image.axes import POSITIONED, Positioned

_ZERO: Final = Figure()
_COLD: Final = Figure("ambient_c", offset=-10.0)
"""Low end of a temperature's bar, degC [A]."""
_TOP: Final = 1.1
"""End of a bar, as a multiple of its limit [A]."""
_FRICTION_TOP: Final = Figure(offset=3.0)
"""Top of the coefficient's bar: the largest printed coefficient is 2.59 (doi 10.3390/polym16050596, appendix B)."""
_FORCE: Final = 600.0
"""End of the load cell's range, N [A], and of the bars of its horizontal forces."""
_MOMENT: Final = 20.0
"""End of the aligning moment's bar, N m [A]."""
_TRAVEL: Final = 30.0
"""Travel of the press, mm [A], for a rig file without its limits."""
_PEAK: Final = 3.0
"""A drive's peak torque over its rated torque [A]."""


def _within(key: str, rank: int, device: str, limit: str, *, scale: float = 1.0, both: bool = False,
            watched: bool = False, axis: str = "", setpoint: str = "", trend: str = "",
            setpoint_trend: str = "") -> Screen:  # fmt: skip
    """Return a bar from zero, or from the negative limit, to slightly beyond a limit of the rig."""
    top = Figure(limit, scale * _TOP)
    low = Figure(limit, -scale * _TOP) if both else _ZERO
    at = Figure(limit, scale)
    return Screen(key, rank, device, low, top, at, both, watched, setpoint, axis, trend, setpoint_trend)


def _between(key: str, rank: int, low: float, high: float, device: str = "load_cell") -> Screen:
    """Return a bar between two numbers."""
    return Screen(key, rank, device, Figure(offset=low), Figure(offset=high))


def _position(axis: Positioned) -> Channel:
    """Return the channel of a positioned axis."""
    screen = _within(axis.name, axis.rank, "can", f"limits.{axis.field}", both=True, axis=axis.name, trend=axis.trend)
    source = f"readings.positions[{axis.name}]"
    return Channel(axis.field, axis.symbol, axis.name.capitalize(), source, axis.mean, 2, screen=screen)


QUANTITIES: Final = Quantities(
    (
        Channel(TIME, "s", "Time", "now"),
        Channel("wheel_speed_m_s", "m/s", "Wheel speed", "readings.wheel_speed_m_s", 6, 3,
                screen=_within("wheel_speed", 7, "can", "limits.wheel_speed_m_s", axis="wheel_speed",
                               trend="wheel_speed_m_s")),
        Channel("belt_speed_m_s", "m/s", "Belt speed", "readings.belt_speed_m_s", 7, 3,
                screen=_within("belt_speed", 8, "can", "limits.belt_speed_m_s", trend="belt_speed_m_s")),
        Channel("slip_m_s", "m/s", "Slip speed", "readings.slip_m_s", 8, 1,
                column="slip_mm_s", shown_unit="mm/s", scale=1e3,
                screen=_within("slip", 3, "can", "interlocks.max_slip_m_s", scale=1e3, watched=True,
                               axis="slip_velocity", trend="slip_mm_s", setpoint_trend="slip_setpoint_mm_s")),
        *map(_position, POSITIONED),
        Channel("load_setpoint_n", "N", "Load setpoint", "demand.load_n", decimals=1),
        Channel("force_x_n", "N", "Force Fx", "readings.force_x_n", 1, 1,
                screen=_between("force_x", 12, -_FORCE, _FORCE)),
        Channel("force_y_n", "N", "Force Fy", "readings.force_y_n", 2, 1,
                screen=_between("force_y", 13, -_FORCE, _FORCE)),
        Channel("force_z_n", "N", "Load", "readings.force_z_n", 3, 1,
                screen=_within("load", 2, "load_cell", "limits.load_n", watched=True,
                               setpoint="load_setpoint_n", axis="load", trend="load_n",
                               setpoint_trend="load_setpoint_n")),
        Channel("moment_z_nm", "N m", "Moment Mz", "readings.moment_z_nm", 4, 2,
                screen=_between("moment", 14, -_MOMENT, _MOMENT)),
        Channel("drive_torque_nm", "N m", "Drive torque", "readings.drive_torque_nm", 5, 1,
                screen=Screen("torque", 15, "can", Figure("axes.wheel.rated_torque_nm", -_PEAK),
                              Figure("axes.wheel.rated_torque_nm", _PEAK))),
        Channel("surface_c", "°C", "Surface temp", "readings.surface_c", 11, 1,
                screen=Screen("surface", 4, "ir_thermometer", _COLD, Figure("limits.surface_c", offset=5.0),
                              Figure("limits.surface_c"), watched=True, axis="temperature", trend="surface_c",
                              setpoint_trend="surface_setpoint_c")),
        Channel("hub_c", "°C", "Jacket", "readings.hub_c", 12, 1,
                screen=Screen("hub", 5, "jacket", _COLD, Figure("limits.jacket_c", offset=10.0),
                              Figure("limits.jacket_c"), watched=True, setpoint="hub_setpoint_c", trend="hub_c",
                              setpoint_trend="hub_setpoint_c")),
        Channel("hub_setpoint_c", "°C", "Jacket setpoint", "setpoints.hub_c", decimals=1),
        Channel("heat_percent", "%", "Heating", "readings.heat_percent", decimals=0,
                screen=Screen("heat", 10, "jacket", _ZERO, Figure(offset=100.0), trend="heat_percent")),
        Channel("press_mm", "mm", "Press", "readings.press_mm", decimals=2,
                screen=Screen("press", 11, "can", _ZERO,
                              Figure("axes.press.software_limits.1", otherwise=_TRAVEL))),
        Channel("wheel_angle_rev", "rev", "Wheel angle", "readings.wheel_angle_rev"),
        Channel(GATE, "", "Gates closed", "gate", decimals=0, whole=True),
        Channel(BURST, "", "Burst", "burst", decimals=0, whole=True),
        Channel(KEY, "", "Repeat", "repeat_key", decimals=0, whole=True),
        Channel("friction", "", "Friction mu", "", decimals=3,
                screen=Screen("friction", 1, "load_cell", _ZERO, _FRICTION_TOP, trend="friction")),
    ),
    Roles(friction=("force_x_n", "force_y_n"), normal="force_z_n", turn="wheel_angle_rev", temperature="surface_c",
          sliding="slip_m_s", depth="press_mm", core="hub_c"),
)  # fmt: skip
"""In the order of a sample's columns, followed by channels that are shown but not recorded."""
