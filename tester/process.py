"""The process image: what one scan knows, what the recipe wants, and what is commanded.

One instance of each exists per rig. The scan overwrites the fields in place at fixed places (inputs fill
``Readings``, the executor writes ``Demand``, control writes ``Setpoints``): like a PLC's image it is
complete and consistent between two steps of a scan, and costs no allocation.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Final

SAMPLE_COLUMNS: Final[tuple[str, ...]] = (
    "time_s",
    "wheel_speed_m_s",
    "belt_speed_m_s",
    "slip_m_s",
    "sideslip_deg",
    "camber_deg",
    "load_setpoint_n",
    "force_x_n",
    "force_y_n",
    "force_z_n",
    "moment_z_nm",
    "drive_torque_nm",
    "surface_c",
    "hub_c",
    "hub_setpoint_c",
    "heat_percent",
    "press_mm",
    "wheel_angle_rev",
    "gate",
    "burst",
    "repeat_key",
)
"""Columns of a recorded sample, in order, all float64, unit in the name. ``gate`` is a mask of GATE_* (0 = accepted),
``burst`` counts within the repeat (0 = outside a burst), ``repeat_key`` is the repeat's row in the store (0 = none)."""

GATE_LOAD: Final = 1
GATE_SPEED: Final = 2
GATE_SLIP: Final = 4
GATE_TEMPERATURE: Final = 8
GATE_ALARM: Final = 16
GATE_SETTLING: Final = 32

NEVER: Final = float("-inf")
"""Time stamp of a source that has not reported yet: older than anything, hence stale."""

NAN: Final = float("nan")
"""Value of a source that has not reported yet, or of a demand that is not made."""


class Press(IntEnum):
    """What the press axis is asked to do."""

    LIFT = 0
    """Clear of the wheel, position-controlled to the lifted position."""
    LOAD = 1
    """In contact, force-controlled to ``Demand.load_n``."""


@dataclass(slots=True)
class Readings:
    """Newest value of every signal, with the time stamp of its source (seconds of the scan's clock).

    Speeds of the wheel are rim speeds with the diameter it runs with, warm and worn. Forces are in the wheel frame,
    tare applied: x along the wheel plane (positive = belt drags the wheel back), y lateral, z normal.
    """

    now_s: float = 0.0

    wheel_speed_m_s: float = NAN
    wheel_rad_s: float = NAN
    drive_torque_nm: float = NAN
    wheel_at_s: float = NEVER
    belt_speed_m_s: float = NAN
    belt_at_s: float = NEVER
    belt_torque_nm: float = NAN
    """Of the belt's drive at its roller: positive = it drives the belt on, as the wheel's torque drives the wheel."""
    press_mm: float = NAN
    press_torque_nm: float = NAN
    """Of the press's drive: what its screw makes of it is a second witness of the load (``drivers.screw``)."""
    press_at_s: float = NEVER
    sideslip_deg: float = 0.0
    sideslip_at_s: float = NEVER
    camber_deg: float = 0.0
    camber_at_s: float = NEVER
    slip_m_s: float = NAN
    """Resultant slip speed from the measured speeds and sideslip angle."""

    drives_enabled: bool = False
    """Every drive that takes part is in OPERATION_ENABLED."""
    drives_disabled: bool = True
    """No drive applies torque."""
    drive_fault: str = ""
    """First drive fault, loss or emergency, as text; empty while all are healthy."""
    bus_fault: str = ""
    """Which wire is gone (CAN adapter, serial line), as text; empty while all are there."""
    can_heard_s: float = NEVER
    """When a frame last came in over CAN."""
    foreign_master: str = ""
    """First frame on the CAN bus that only another master sends, as text; empty while we are alone."""
    device_fault: str = ""
    """First Modbus device that refuses what it is asked or says that our commands do not come; empty = none."""
    line_errors: float = 0.0
    """Largest share of failed requests among the Modbus devices, of the last few seconds, 0..1."""
    yaw_reached: bool = False
    """Sideslip and camber drives report their targets reached."""
    safety_chain: bool = False
    guard_closed: bool = False
    contactor_closed: bool = False
    inputs_at_s: float = NEVER
    """When the drive with the safety inputs last said how these three are."""

    force_x_n: float = NAN
    force_y_n: float = NAN
    force_z_n: float = NAN
    moment_z_nm: float = NAN
    cell_valid: bool = False
    cell_silent: bool = False
    """The load cell has not answered several requests in a row, and is not set up again yet."""
    cell_at_s: float = NEVER
    cell_changed_s: float = NEVER
    """When a reading of the cell last differed from the one before."""

    surface_c: float = NAN
    surface_valid: bool = False
    surface_silent: bool = False
    """The thermometer has not answered several requests in a row."""
    surface_at_s: float = NEVER
    surface_changed_s: float = NEVER
    """When a reading of the thermometer last differed from the one before."""
    hub_c: float = NAN
    heat_percent: float = NAN
    jacket_valid: bool = False
    jacket_silent: bool = False
    """The jacket's controller has not answered several requests in a row."""
    jacket_at_s: float = NEVER

    wheel_angle_rev: float = 0.0
    """Turns of the wheel since installation, integrated from the measured speed."""
    cold_mm: float = NAN
    """Wheel diameter at the reference temperature: as installed, less the estimated wear."""
    diameter_mm: float = NAN
    """Wheel diameter as it runs: the cold one and what heat has added (``tester.engine.wheel_life``)."""


@dataclass(slots=True)
class Demand:
    """What the running step wants; control bounds it and may refuse it."""

    enabled: bool = False
    """Drives powered."""
    wheel_speed_m_s: float = 0.0
    belt_speed_m_s: float = 0.0
    press: Press = Press.LIFT
    load_n: float = 0.0
    quick_touch: bool = False
    """Use the fast approach to a known contact (bursts with sideslip)."""
    sideslip_deg: float = 0.0
    camber_deg: float = 0.0
    surface_c: float = NAN
    """Surface temperature to hold; NaN = heat off."""
    freeze_heat: bool = False
    """Keep the hub setpoint as it is: friction heat of a slip pulse is not the jacket's to correct."""
    attended: bool = False
    """A person has been asked to come near: hands are at wheel, plug and thermometer."""


@dataclass(slots=True)
class Setpoints:
    """What goes to the devices at the end of a scan, already inside every limit."""

    wheel_rad_s: float = 0.0
    belt_m_s: float = 0.0
    press_mm_s: float = 0.0
    sideslip_deg: float = 0.0
    camber_deg: float = 0.0
    enable: bool = False
    quick_stop: bool = False
    hub_c: float = 25.0
    heat: bool = False
    """Jacket controller in run (True) or standby."""
    contactor: bool = False
    power_off: bool = False
    """Every power stage off at once: what is left when a drive does not stop or the press does not lift."""
    jacket_silent: bool = False
    """The jacket's setpoint is not renewed any more: its lease ends the heating when standby does not."""
