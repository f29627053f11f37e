"""Inputs of the interlocks' conditions: plain data, updated once a scan (``control.interlock_inputs``).

Unknown values are NaN, infinite or at a value that trips.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isfinite, nan
from typing import Final, TypeAlias

from tester.inputs.rig.parameter import Direction, Parameter
from tester.kinds.wheel_on_belt.image.process_image import Demand, Readings, Setpoints
from tester.kinds.wheel_on_belt.interlocks.contact_force import UNLOADED_N, Contact, ForceObserver
from tester.kinds.wheel_on_belt.interlocks.heat_balance import HeatBalance
from tester.kinds.wheel_on_belt.interlocks.monitors import (
    FreeTravel,
    JacketMonitor,
    PressTracker,
    SpeedTracker,
    SurfaceMonitor,
)
from tester.machine.inputs import ScanInputs
from tester.machine.row import Interlock
from tester.machine.wires import STALE_INPUTS_S


@dataclass(slots=True)
class RigLimits:
    """Limits besides the conditions' own parameters: numbers from the rig file's other sections."""

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
    """``loops.heat.hub_min``: the setpoint without demand for heat."""
    stiffness_n_per_mm: float
    """``loops.load.stiffness``."""
    press_low_mm: float
    press_high_mm: float
    """``axes.press.software_limits``; infinite where there are none."""
    deceleration_m_s2: float
    quick_stop_m_s2: float
    """Ramps of the belt; the wheel's rim has the same ramps."""
    lift_mm_s: float
    """``loops.load.lift_speed``."""


@dataclass(slots=True)
class PressBand:
    """The range of forces for a torque of the press's drive, at rest or moving either way (drivers.screw)."""

    known: bool
    """The rig file has ``axes.press.screw``."""
    drag_nm: float = 0.0
    spring_n: float = 0.0
    spring_rate_n_per_mm: float = 0.0
    least_n_per_nm: float = 0.0
    most_n_per_nm: float = 0.0

    def least_n(self, torque_nm: float, press_mm: float) -> float:
        """Return the least force with the press at ``press_mm``, N; NaN for an unknown torque."""
        least = (torque_nm - self.drag_nm) * self.least_n_per_nm - self.spring_n - self.spring_rate_n_per_mm * press_mm
        return 0.0 if least < 0.0 else least

    def most_n(self, torque_nm: float, press_mm: float) -> float:
        """Return the greatest force with the press at ``press_mm``, N; NaN for an unknown torque."""
        most = (torque_nm + self.drag_nm) * self.most_n_per_nm - self.spring_n - self.spring_rate_n_per_mm * press_mm
        return 0.0 if most < 0.0 else most


@dataclass(slots=True)
class StopStart:
    """The state at the start of a stop."""

    speed_m_s: float = 0.0
    """The faster of wheel and belt."""
    press_mm: float = inf
    """Remaining travel of the press on its ramp; infinity if unknown. At rest: its position."""
    lifted_mm: float = 0.0
    """Position to which the press lifts."""
    fast_speed_m_s: float = 0.0
    """The faster of wheel and belt when the quick stop began."""


@dataclass(slots=True)
class Inputs(ScanInputs):
    """The inputs of the conditions in one scan."""

    limits: RigLimits = field(init=False)
    readings: Readings = field(init=False)
    demand: Demand = field(init=False)
    setpoints: Setpoints = field(init=False)
    """The commands of the previous scan."""
    contact: Contact = field(init=False)
    stop_start: StopStart = field(init=False)
    hub_setpoints: list[tuple[float, float]] = field(init=False)
    """(time, hub setpoint) within ``runaway_window``, only falling setpoints: the first is the highest."""
    jacket: JacketMonitor = field(init=False)
    surface: SurfaceMonitor = field(init=False)
    wheel: SpeedTracker = field(init=False)
    belt: SpeedTracker = field(init=False)
    press: PressTracker = field(init=False)
    press_band: PressBand = field(init=False)
    free: FreeTravel = field(init=False)
    force: ForceObserver = field(init=False)
    heat: HeatBalance = field(init=False)
    model_c: float = nan
    """The rubber's surface temperature by the thermal observer."""
    pressing: bool = False
    """Contact is wanted."""
    turning: bool = False
    """The wheel is confirmed turning."""
    least_n: float = inf
    """The least force since contact was last wanted: a lifting press cannot press harder."""
    contact_mm: float = inf
    """Press position of the contact: the last touch corrected for wear since, or from the diameter."""
    friction_n: float = 0.0
    friction_w: float = 0.0
    """Resultant friction force and its power (NaN where a part is unknown); 0 while unloaded."""
    rest_mm: float = inf
    """Farthest retraction of the press since a run was found without power (``unpowered``)."""

    def seldom(self) -> tuple[object, ...] | None:
        r, demand, out, heat, setpoints = self.readings, self.demand, self.setpoints, self.heat, self.hub_setpoints
        # None where no heat is wanted: a NaN is unequal to itself, and would be a change in every scan.
        wanted_c = demand.surface_c if demand.surface_c == demand.surface_c else None
        return (
            r.safety_chain, r.guard_closed, r.bus_fault, r.drive_fault, r.foreign_master, r.device_fault, r.line_errors,
            r.drives_enabled, r.contactor_closed, r.surface_c, r.surface_valid, r.surface_silent, r.hub_c,
            r.heat_percent, r.jacket_valid, r.jacket_silent, demand.enabled, wanted_c, out.heat, out.contactor,
            self.confirmed, self.attended, self.pressing, self.turning, self.model_c, self.surface.jump_k,
            self.jacket.jump_k, self.jacket.coolest_c, setpoints[0][1] if setpoints else None, heat.unseen_k,
            heat.ungiven_k, heat.still_k, heat.put_w, heat.shown_w, heat.lack_j, heat.may_lack_j,
        )  # fmt: skip


Row: TypeAlias = Interlock[Inputs]


STANDING_M_S: Final = Parameter(
    "standing_m_s", "m/s", "20 mm/s", "a drive slower than this is at rest [A]: forty times the noise of its speed",
    hardest="50 mm/s", because="0.05 m/s is the creep that the arming proof calls moving",
)  # fmt: skip
SPEEDS_OLD_S: Final = Parameter(
    "speeds_old_s", "s", "500 ms", "a stop does not end on speeds, force or position older than this [A]",
    hardest="1 s",
    because="the next step of a stop that does not work begins a second after it: by then it must be known to fail",
)  # fmt: skip
CLEAR_MM: Final = Parameter(
    "clear_mm", "mm", "0.5 mm", "this far off the known contact the press is clear, whatever the cell shows [A]",
    direction=Direction.HIGHER, hardest="0.2 mm",
    because="four times the runout of the tread, which is 0.05 mm peak to peak",
)  # fmt: skip


def standing(v: Inputs) -> bool:
    """Return whether wheel and belt are known to stand; old or unknown speeds do not count as standing."""
    r, p = v.readings, v.parameters
    since, slow = r.now_s - p[SPEEDS_OLD_S], p[STANDING_M_S]
    return (
        r.wheel_at_s >= since
        and r.belt_at_s >= since
        and -slow < r.wheel_speed_m_s < slow
        and -slow < r.belt_speed_m_s < slow
    )


def contactor_open(v: Inputs) -> bool:
    """Return whether the heater's contactor is known to be open."""
    r = v.readings
    return not r.contactor_closed and r.now_s - r.inputs_at_s <= v.parameters[STALE_INPUTS_S]


def unloaded(v: Inputs) -> bool:
    """Return whether the contact is known to be open: by a fresh force, or by a press away from the contact.

    The position counts only if the cell gives no information: it is stale, invalid, or repeats its reading.
    """
    r, old_s = v.readings, v.parameters[SPEEDS_OLD_S]
    if r.cell_valid and r.now_s - r.cell_at_s <= old_s:
        if r.force_z_n < UNLOADED_N:
            return True
        if r.now_s - r.cell_changed_s <= old_s:
            return False
    touched_mm = v.contact.contact_mm
    known = isfinite(touched_mm) and r.now_s - r.press_at_s <= old_s
    return known and r.press_mm <= touched_mm - v.parameters[CLEAR_MM]
