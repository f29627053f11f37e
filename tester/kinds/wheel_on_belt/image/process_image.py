"""The process image: the readings of a scan, the recipe's demand, and the commands.

One instance of each exists per rig. The scan overwrites the fields in place (inputs fill ``Readings``, the executor
writes ``Demand``, control writes ``Setpoints``). Like a PLC's image it is complete and consistent between two steps of
a scan, and costs no allocation.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from math import inf
from typing import TYPE_CHECKING, Final

from tester.kinds.wheel_on_belt.image.axes import straight
from tester.machine.image import NAN, NEVER, BaseDemand, BaseReadings, BaseSetpoints

if TYPE_CHECKING:
    from drivers.joined_cell import JoinedCell  # loads Modbus, which a plan does not need

CELL: Final = ("force_x_n", "force_y_n", "force_z_n", "moment_z_nm")
"""The load cell's channels, in its order; a tare is subtracted from each."""


class Press(IntEnum):
    """Commands to the press axis."""

    LIFT = 0
    """Clear of the wheel, position-controlled to the lifted position."""
    LOAD = 1
    """In contact, force-controlled to ``Demand.load_n``."""


@dataclass(slots=True)
class Readings(BaseReadings):
    """Newest value of every signal, with the time stamp of its source (seconds of the scan's clock).

    Speeds of the wheel are rim speeds with the diameter it runs with, warm and worn. Forces are in the wheel frame,
    tare applied: x along the wheel plane (positive = belt drags the wheel back), y lateral, z normal.
    """

    wheel_speed_m_s: float = NAN
    wheel_rad_s: float = NAN
    drive_torque_nm: float = NAN
    wheel_at_s: float = NEVER
    wheel_changed_s: float = NEVER
    """When the wheel's speed last differed from its predecessor."""
    belt_speed_m_s: float = NAN
    belt_at_s: float = NEVER
    belt_torque_nm: float = NAN
    """Torque of the belt's drive at its roller: positive = it drives the belt forward, as for the wheel."""
    press_mm: float = NAN
    press_torque_nm: float = NAN
    """Torque of the press's drive: by its screw it is a second witness of the load (``drivers.screw``)."""
    press_at_s: float = NEVER
    positions: dict[str, float] = field(default_factory=straight)
    """Positions of the positioned axes (``axes.POSITIONED``), by name; 0 for an axis that a person sets."""
    positions_at_s: float = NEVER
    """The oldest time stamp of the positions."""
    yaw_reached: bool = False
    """The drives of these axes report their targets reached."""
    slip_m_s: float = NAN
    """Resultant slip speed from the measured speeds and sideslip angle."""

    contactor_closed: bool = False
    """State of the heater's contactor, as old as the safety inputs (``inputs_at_s``)."""

    force_x_n: float = NAN
    force_y_n: float = NAN
    force_z_n: float = NAN
    moment_z_nm: float = NAN
    cell_valid: bool = False
    cell_silent: bool = False
    """The load cell has not answered several requests in a row, and is not set up again yet."""
    joined: JoinedCell | None = None
    """The load cell if it has several transmitters: after a trip it names the faulty one."""
    cell_old_s: float = inf
    """A transmitter of the cell without a reading for this time is named, s."""
    cell_at_s: float = NEVER
    cell_changed_s: float = NEVER
    """When a reading of the cell last differed from its predecessor."""

    surface_c: float = NAN
    surface_valid: bool = False
    surface_silent: bool = False
    """The thermometer has not answered several requests in a row."""
    surface_at_s: float = NEVER
    surface_changed_s: float = NEVER
    """When a reading of the thermometer last differed from its predecessor."""
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
    """Running diameter of the wheel: the cold diameter plus its growth by heat (``procedures.wheel_life``)."""

    leapt_s: float = 0.0
    """By how much the stamps have been moved from the wires' clock, s."""

    def later(self, seconds: float) -> None:
        BaseReadings.later(self, seconds)
        self.leapt_s = seconds
        self.wheel_at_s += seconds
        self.wheel_changed_s += seconds
        self.belt_at_s += seconds
        self.press_at_s += seconds
        self.positions_at_s += seconds
        self.cell_at_s += seconds
        self.cell_changed_s += seconds
        self.surface_at_s += seconds
        self.surface_changed_s += seconds
        self.jacket_at_s += seconds

    def drive_stamps_s(self) -> tuple[float, ...]:
        return (self.wheel_at_s, self.belt_at_s, self.press_at_s, self.positions_at_s)

    def faults(self) -> list[str]:
        """Return the faults of drives, wires and devices, in words; the cell's transmitter first."""
        faults = BaseReadings.faults(self)
        blamed = "" if self.joined is None else self.joined.blame(self.now_s - self.leapt_s, self.cell_old_s)
        return [blamed, *faults] if blamed else faults

    @property
    def cell(self) -> tuple[float, float, float, float]:
        """Return the load cell's readings, tare applied, in the order of ``CELL``."""
        return self.force_x_n, self.force_y_n, self.force_z_n, self.moment_z_nm


@dataclass(slots=True)
class Demand(BaseDemand):
    """The demand of the present step; control bounds it and may refuse it."""

    wheel_speed_m_s: float = 0.0
    belt_speed_m_s: float = 0.0
    press: Press = Press.LIFT
    load_n: float = 0.0
    quick_touch: bool = False
    """Use the fast approach to a known contact (bursts with sideslip)."""
    positions: dict[str, float] = field(default_factory=straight)
    """Positions of the positioned axes, by name."""
    surface_c: float = NAN
    """Surface temperature to hold; NaN = heat off."""
    freeze_heat: bool = False
    """Keep the hub setpoint: the jacket must not correct the friction heat of a slip pulse."""

@dataclass(slots=True)
class Setpoints(BaseSetpoints):
    """Setpoints for the devices at the end of a scan, already inside every limit."""

    wheel_rad_s: float = 0.0
    belt_m_s: float = 0.0
    press_mm_s: float = 0.0
    positions: dict[str, float] = field(default_factory=straight)
    hub_c: float = 25.0
    heat: bool = False
    """Jacket controller in run (True) or standby."""
    contactor: bool = False
    jacket_silent: bool = False
    """The jacket's setpoint is no longer renewed: its lease ends the heating when standby does not."""
