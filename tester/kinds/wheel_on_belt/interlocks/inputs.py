"""What the conditions of interlocks may look at: plain data, brought up to date once a scan.

``control.interlock_inputs`` fills it. What is not known stays NaN, infinite or the value that trips.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, nan
from typing import TypeAlias

from tester.kinds.wheel_on_belt.image.process_image import Demand, Readings, Setpoints
from tester.kinds.wheel_on_belt.interlocks.contact import Contact
from tester.kinds.wheel_on_belt.interlocks.force_observer import ForceObserver
from tester.kinds.wheel_on_belt.interlocks.heat_balance import HeatBalance
from tester.kinds.wheel_on_belt.interlocks.monitors import JacketMonitor, PressTracker, SpeedTracker, SurfaceMonitor
from tester.machine.inputs import ScanInputs
from tester.machine.row import Interlock


@dataclass(slots=True)
class RigLimits:
    """What conditions compare with beside their own parameters: numbers from the rig file's other sections."""

    load_n: float
    heartbeat_s: float
    """``can.drive_heartbeat``."""
    wheel_speed_m_s: float
    belt_speed_m_s: float
    slip_power_w: float
    roller_m: float
    """Radius of the belt's drive roller."""
    jacket_c: float
    surface_c: float
    hub_min_c: float
    """``loops.heat.hub_min``: the setpoint while no heat is wanted."""
    stiffness_n_per_mm: float
    """``loops.load.stiffness``."""
    press_low_mm: float
    press_high_mm: float
    """``axes.press.software_limits``; infinite where there are none."""
    deceleration_m_s2: float
    quick_stop_m_s2: float
    """Ramps of the belt; those of the wheel are the same at its rim."""


@dataclass(slots=True)
class PressBand:
    """Between which forces a torque of the press's drive can stand, moving either way or not at all (drivers.screw)."""

    known: bool
    """The rig file has ``axes.press.screw``."""
    drag_nm: float = 0.0
    spring_n: float = 0.0
    least_n_per_nm: float = 0.0
    most_n_per_nm: float = 0.0

    def least_n(self, torque_nm: float) -> float:
        """Return the least force, N; NaN for a torque that is not known."""
        least = (torque_nm - self.drag_nm) * self.least_n_per_nm - self.spring_n
        return 0.0 if least < 0.0 else least

    def most_n(self, torque_nm: float) -> float:
        """Return the greatest force, N; NaN for a torque that is not known."""
        most = (torque_nm + self.drag_nm) * self.most_n_per_nm - self.spring_n
        return 0.0 if most < 0.0 else most


@dataclass(slots=True)
class StopStart:
    """What a stop began from."""

    speed_m_s: float = 0.0
    """The faster of wheel and belt."""
    press_mm: float = inf
    """How far the press may still come, by its ramp; infinity where that is not known. At rest: where it stands."""
    fast_speed_m_s: float = 0.0
    """The faster of wheel and belt when the quick stop began."""


@dataclass(slots=True)
class Inputs(ScanInputs):
    """One scan, as conditions see it."""

    limits: RigLimits = field(init=False)
    readings: Readings = field(init=False)
    demand: Demand = field(init=False)
    setpoints: Setpoints = field(init=False)
    """What the scan before has commanded."""
    contact: Contact = field(init=False)
    stop_start: StopStart = field(init=False)
    hub_setpoints: list[tuple[float, float]] = field(init=False)
    """(time, hub setpoint) within ``runaway_window``, falling ones only: the first is the highest."""
    jacket: JacketMonitor = field(init=False)
    surface: SurfaceMonitor = field(init=False)
    wheel: SpeedTracker = field(init=False)
    belt: SpeedTracker = field(init=False)
    press: PressTracker = field(init=False)
    press_band: PressBand = field(init=False)
    force: ForceObserver = field(init=False)
    heat: HeatBalance = field(init=False)
    model_c: float = nan
    """What the thermal observer has for the rubber's surface."""
    pressing: bool = False
    """Contact is wanted."""
    turning: bool = False
    """The wheel is confirmed turning."""
    least_n: float = inf
    """The least force since contact was last wanted: what is lifting does not get firmer."""
    contact_mm: float = inf
    """Where the press touches the wheel: as it was touched last, less its wear since, or as its diameter says."""
    friction_n: float = 0.0
    friction_w: float = 0.0
    """Resultant friction force and its power (NaN where a part is unknown); 0 while unloaded."""
    rest_mm: float = inf
    """How far back the press has been since a run was seen without power (``unpowered``)."""


Row: TypeAlias = Interlock[Inputs]
