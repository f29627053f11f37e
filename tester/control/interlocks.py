"""The interlocks: one table, one row a cause. Every row is a level, evaluated in every scan; unknown is tripped.

A row's condition is a small function of what is known (``View``) that returns True while the rig is *not* shown to
be well. Conditions are written so that NaN and missing data fall on the tripped side: ``not (x <= limit)``, never
``x > limit``. No row hides another; a trip latches in ``step``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import isfinite

from tester.control.state import ControlState, Reaction
from tester.process import Demand, Press, Readings
from tester.rig import InterlocksConfig, LimitsConfig, RigConfig

STANDING_M_S = 0.02
"""Below this a drive counts as standing [A]."""
UNLOADED_N = 20.0
"""Below this the contact counts as unloaded (safety concept, "load with a drive stopped")."""

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_LOAD = Press.LOAD


@dataclass(slots=True)
class View:
    """What a condition may look at. One object serves every scan: ``look`` brings it up to date."""

    state: ControlState
    rig: RigConfig
    limits: LimitsConfig = field(init=False)
    bounds: InterlocksConfig = field(init=False)
    readings: Readings = field(init=False)
    demand: Demand = field(init=False)
    scan_s: float = 0.0
    """Period of the scan, s."""
    pressing: bool = False
    """Contact is wanted."""
    loaded: bool = True
    """Contact is wanted or cannot be excluded."""

    def __post_init__(self) -> None:
        """Keep the parts of the rig file that conditions compare with."""
        self.limits = self.rig.limits
        self.bounds = self.rig.interlocks

    def look(self, demand: Demand, readings: Readings, scan_s: float) -> None:
        """Take this scan's demand and readings, and work out what several rows ask for."""
        self.readings = readings
        self.demand = demand
        self.scan_s = scan_s
        self.pressing = pressing = demand.press is _LOAD
        self.loaded = pressing or not (readings.force_z_n < UNLOADED_N)


@dataclass(frozen=True, slots=True)
class Interlock:
    """One row: cause, condition, delay, reaction."""

    name: str
    cause: str
    condition: Callable[[View], bool]
    delay_s: Callable[[RigConfig], float]
    reaction: Reaction


def _can_stale(view: View) -> bool:
    r = view.readings
    if not (view.demand.enabled and r.drives_enabled):
        return False
    # Drives answer a scan's SYNC: after a late one their data is as old as that scan was long ("scan late" judges).
    period_s = max(view.scan_s, r.now_s - view.state.last_s)
    limit = min(view.bounds.stale_can_scans * period_s, view.bounds.stale_can_s)
    oldest = min(r.wheel_at_s, r.belt_at_s, r.press_at_s, r.sideslip_at_s, r.camber_at_s)
    return not (r.now_s - oldest <= limit)


def _drive_fault(view: View) -> bool:
    return bool(view.readings.drive_fault)


def _safety_chain(view: View) -> bool:
    return not view.readings.safety_chain


def _guard(view: View) -> bool:
    return view.demand.enabled and not view.readings.guard_closed


def _cell_stale(view: View) -> bool:
    r = view.readings
    return view.loaded and not (r.cell_valid and r.now_s - r.cell_at_s <= view.bounds.stale_cell_s)


def _surface_stale(view: View) -> bool:
    r = view.readings
    wanted = view.pressing or isfinite(view.demand.surface_c)
    return wanted and not (r.surface_valid and r.now_s - r.surface_at_s <= view.bounds.stale_ir_s)


def _jacket_stale(view: View) -> bool:
    r = view.readings
    return not (r.jacket_valid and r.now_s - r.jacket_at_s <= view.bounds.stale_jacket_s)


def _overload(view: View) -> bool:
    return view.loaded and not (view.readings.force_z_n <= view.limits.load_n)


def _overshoot(view: View) -> bool:
    if not view.pressing:
        return False
    lim = view.bounds
    wanted = max(view.demand.load_n, view.state.load.highest_n)
    return not (view.readings.force_z_n <= lim.overload_factor * wanted + lim.overload_margin_n)


def _contact_lost(view: View) -> bool:
    target = min(view.demand.load_n, view.state.load.lowest_n)
    if not view.pressing or target < 50.0 or not view.state.load.loaded:
        return False
    return not (view.readings.force_z_n >= view.bounds.contact_share * target)


def _slip_power(view: View) -> bool:
    r = view.readings
    if not view.loaded:
        return False
    force = (r.force_x_n * r.force_x_n + r.force_y_n * r.force_y_n) ** 0.5
    return not (force * r.slip_m_s <= view.limits.slip_power_w)


def _standing_under_load(view: View) -> bool:
    r = view.readings
    if r.force_z_n < UNLOADED_N:
        return False
    wheel, belt = abs(r.wheel_speed_m_s) > STANDING_M_S, abs(r.belt_speed_m_s) > STANDING_M_S
    return wheel != belt or (view.pressing and not (wheel and belt))


def _overspeed(view: View) -> bool:
    r, limits, margin = view.readings, view.limits, 1.0 + view.bounds.overspeed_share
    if not r.drives_enabled:
        return False
    return not (abs(r.wheel_speed_m_s) <= limits.wheel_speed_m_s * margin) or not (
        abs(r.belt_speed_m_s) <= limits.belt_speed_m_s * margin
    )


def _surface_hot(view: View) -> bool:
    r = view.readings
    return r.surface_valid and not (r.surface_c <= view.limits.surface_c)


def _hub_hot(view: View) -> bool:
    return view.readings.jacket_valid and not (view.readings.hub_c <= view.limits.jacket_c + 5.0)


def _runaway(view: View) -> bool:
    r, state = view.readings, view.state
    if not r.jacket_valid or not state.hub_ceiling:
        return False
    ceiling = max(state.hub_ceiling[0][1], view.rig.loops.heat.hub_min_c)
    return r.hub_c > ceiling + view.bounds.runaway_k and r.heat_percent > 0.0


def _heating_at_standstill(view: View) -> bool:
    r = view.readings
    return not (r.heat_percent <= 0.0) and not (abs(r.wheel_speed_m_s) > STANDING_M_S)


def _late(view: View) -> bool:
    return view.readings.now_s - view.state.last_s > view.bounds.late_scan_s + view.scan_s


FAST, CONTROLLED = Reaction.FAST, Reaction.CONTROLLED

INTERLOCKS: tuple[Interlock, ...] = (
    Interlock("safety chain", "safety chain open (drive input)", _safety_chain, lambda _: 0.0, FAST),
    Interlock("drive fault", "drive fault, loss or emergency", _drive_fault, lambda _: 0.0, FAST),
    Interlock("drive data stale", "no fresh drive data", _can_stale, lambda _: 0.0, FAST),
    Interlock("load cell stale", "load unknown while in contact", _cell_stale,
              lambda c: c.interlocks.stale_cell_delay_s, FAST),
    Interlock("overload", "normal force above the rig's limit", _overload, lambda _: 0.0, FAST),
    Interlock("load overshoot", "normal force above target + 10 % + 10 N", _overshoot,
              lambda c: c.interlocks.overload_delay_s, FAST),
    Interlock("contact lost", "normal force far below target", _contact_lost,
              lambda c: c.interlocks.contact_delay_s, FAST),
    Interlock("slip power", "friction power above the rig's limit", _slip_power,
              lambda c: c.interlocks.slip_power_delay_s, FAST),
    Interlock("drive standing under load", "wheel on a stopped belt, or belt under a stopped wheel",
              _standing_under_load, lambda c: c.interlocks.standing_delay_s, FAST),
    Interlock("overspeed", "wheel or belt above its limit", _overspeed,
              lambda c: c.interlocks.overspeed_delay_s, FAST),
    Interlock("guard open", "guard open with drives on", _guard, lambda _: 0.0, FAST),
    Interlock("surface hot", "rubber surface above its limit", _surface_hot,
              lambda c: c.interlocks.surface_delay_s, CONTROLLED),
    Interlock("jacket hot", "hub above its limit", _hub_hot, lambda c: c.interlocks.jacket_delay_s, CONTROLLED),
    Interlock("jacket runaway", "hub above every setpoint of the last ten minutes", _runaway,
              lambda c: c.interlocks.runaway_delay_s, CONTROLLED),
    Interlock("heating at standstill", "jacket heating with the wheel not turning", _heating_at_standstill,
              lambda c: c.interlocks.standstill_heat_delay_s, CONTROLLED),
    Interlock("surface data stale", "no fresh surface temperature", _surface_stale,
              lambda c: c.interlocks.stale_delay_s, CONTROLLED),
    Interlock("jacket data stale", "no fresh jacket data", _jacket_stale,
              lambda c: c.interlocks.stale_delay_s, CONTROLLED),
    Interlock("scan late", "the controlling process was late", _late, lambda _: 0.0, FAST),
)  # fmt: skip
