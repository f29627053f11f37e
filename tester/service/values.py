"""Measured values beside what is wanted and allowed, for people: from the process image and the rig's limits."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Literal

from tester.engine.engine import Engine
from tester.process import NEVER, Press
from tester.rig import RigConfig
from tester.service.state import Quality, Value

CONTACT_N = 20.0
"""Below this normal force a friction coefficient is noise [A]."""
FRICTION_TOP = 2.0
"""Top of the coefficient's bar [A]: rubber on abrasive cloth stays below 1.6 (physics: the paper's tables)."""
FORCE_TOP_N = 600.0
"""End of the load cell [A], of the bars of its horizontal forces."""
MOMENT_TOP_NM = 20.0
"""Of the aligning moment's bar [A]."""
PRESS_TOP_MM = 30.0
"""Travel of the press [A], where the rig file states no limits."""

Source = Literal["cell", "can", "surface", "jacket"]


@dataclass(frozen=True, slots=True)
class Spec:
    """What of a value stays the same for a rig."""

    key: str
    label: str
    unit: str
    source: Source
    low: float | None
    high: float | None
    scale_low: float
    scale_high: float
    decimals: int

    def value(
        self,
        now: float | None,
        setpoint: float | None = None,
        band: float | None = None,
        age_s: float | None = None,
        quality: Quality = "none",
    ) -> Value:
        """Return this value as it is; ``band``: half the width of the gate around the setpoint."""
        band_low = band_high = None
        if setpoint is not None and band is not None:
            band_low, band_high = known(setpoint - band), known(setpoint + band)
        return Value(
            self.key, self.label, self.unit, known(now), known(setpoint), self.low, self.high, band_low, band_high,
            self.scale_low, self.scale_high, self.decimals, age_s, quality,
        )  # fmt: skip


def specs(rig: RigConfig) -> tuple[Spec, ...]:
    """Return what a rig's values are called, and where their limits and the ends of their bars lie."""
    limits, axes = rig.limits, rig.axes
    travel = axes.press.software_limits
    slip_mm_s = 1000.0 * rig.interlocks.max_slip_m_s
    cold_c = rig.ambient_c - 10.0
    return (
        Spec("friction", "Friction mu", "", "cell", None, None, 0.0, FRICTION_TOP, 3),
        Spec("load", "Load", "N", "cell", None, limits.load_n, 0.0, 1.1 * limits.load_n, 1),
        Spec("slip", "Slip speed", "mm/s", "can", None, slip_mm_s, 0.0, 1.1 * slip_mm_s, 1),
        Spec("surface", "Surface temp", "°C", "surface", None, limits.surface_c, cold_c, limits.surface_c + 5.0, 1),
        Spec("hub", "Jacket", "°C", "jacket", None, limits.jacket_c, cold_c, limits.jacket_c + 10.0, 1),
        Spec("sideslip", "Sideslip", "°", "can", -limits.sideslip_deg, limits.sideslip_deg,
             -1.1 * limits.sideslip_deg, 1.1 * limits.sideslip_deg, 2),
        Spec("camber", "Camber", "°", "can", -limits.camber_deg, limits.camber_deg,
             -1.1 * limits.camber_deg, 1.1 * limits.camber_deg, 2),
        Spec("wheel_speed", "Wheel speed", "m/s", "can", None, limits.wheel_speed_m_s,
             0.0, 1.1 * limits.wheel_speed_m_s, 3),
        Spec("belt_speed", "Belt speed", "m/s", "can", None, limits.belt_speed_m_s,
             0.0, 1.1 * limits.belt_speed_m_s, 3),
        Spec("press", "Press", "mm", "can", None, None, 0.0, travel[1] if travel else PRESS_TOP_MM, 2),
        Spec("force_x", "Force Fx", "N", "cell", None, None, -FORCE_TOP_N, FORCE_TOP_N, 1),
        Spec("force_y", "Force Fy", "N", "cell", None, None, -FORCE_TOP_N, FORCE_TOP_N, 1),
        Spec("moment", "Moment Mz", "N m", "cell", None, None, -MOMENT_TOP_NM, MOMENT_TOP_NM, 2),
        Spec("torque", "Drive torque", "N m", "can", None, None,
             -3.0 * axes.wheel.rated_torque_nm, 3.0 * axes.wheel.rated_torque_nm, 1),
        Spec("heat", "Heating", "%", "jacket", None, None, 0.0, 100.0, 0),
    )  # fmt: skip


def known(value: float | None) -> float | None:
    """Return a value where it is a finite number, else None."""
    return value if value is not None and isfinite(value) else None


def unknown_values(rig: RigConfig) -> tuple[Value, ...]:
    """Return the values of a rig that nobody is connected to."""
    return tuple(spec.value(None) for spec in specs(rig))


class ValueView:
    """Makes the values of one run from its engine."""

    def __init__(self, engine: Engine) -> None:
        """Work out what stays."""
        self.engine = engine
        rig = engine.ctx.rig
        self.specs = specs(rig)
        self._gates = rig.gates
        self._limits_s: dict[Source, float] = {
            "cell": rig.interlocks.stale_cell_s,
            "can": rig.interlocks.stale_can_s,
            "surface": rig.interlocks.stale_ir_s,
            "jacket": rig.interlocks.stale_jacket_s,
        }

    def values(self) -> tuple[Value, ...]:
        """Return every value as of the last scan."""
        r = self.engine.ctx.readings
        now, pv, sp = r.now_s, self._measured(), self._wanted()
        newest: dict[Source, tuple[float, bool]] = {
            "cell": (r.cell_at_s, r.cell_valid),
            "can": (min(r.wheel_at_s, r.belt_at_s, r.press_at_s), not r.drive_fault),
            "surface": (r.surface_at_s, r.surface_valid),
            "jacket": (r.jacket_at_s, r.jacket_valid),
        }
        made: dict[Source, tuple[float | None, Quality]] = {
            source: self._quality(source, now, *one) for source, one in newest.items()
        }
        nothing = (None, None)
        return tuple(
            spec.value(value, *sp.get(spec.key, nothing), *made[spec.source])
            for spec, value in zip(self.specs, pv, strict=True)
        )

    def _quality(self, source: Source, now: float, at_s: float, valid: bool) -> tuple[float | None, Quality]:
        """Return age and quality. A device is not asked more often than scans come."""
        if at_s == NEVER:
            return None, "none"
        age_s = max(now - at_s, 0.0)
        if age_s > max(self._limits_s[source], 2.5 * self.engine.period_s):
            return age_s, "stale"
        return age_s, "good" if valid else "bad"

    def _measured(self) -> tuple[float, ...]:
        """Return the values in the order of ``specs``."""
        r = self.engine.ctx.readings
        return (
            friction(r.force_x_n, r.force_y_n, r.force_z_n), r.force_z_n, 1000.0 * r.slip_m_s, r.surface_c, r.hub_c,
            r.sideslip_deg, r.camber_deg, r.wheel_speed_m_s, r.belt_speed_m_s, r.press_mm, r.force_x_n, r.force_y_n,
            r.moment_z_nm, r.drive_torque_nm, r.heat_percent,
        )  # fmt: skip

    def _wanted(self) -> dict[str, tuple[float | None, float | None]]:
        """Return (setpoint, half the width of its gate) of the values that have one."""
        ctx, out = self.engine.ctx, self.engine.control.state.setpoints
        demand, target, gates = ctx.demand, ctx.gates.target, self._gates
        counting = ctx.burst > 0
        slip_band_m_s = max(0.01 * gates.slip_percent * target.slip_m_s, 1e-3 * gates.slip_floor_mm_s)
        load_n = demand.load_n if demand.press is Press.LOAD else None
        radius_m = 0.5e-3 * ctx.readings.diameter_mm
        wheel_m_s = out.wheel_rad_s * radius_m
        return {
            "load": (load_n, None if load_n is None else 0.01 * gates.load_percent * load_n),
            "slip": (1000.0 * target.slip_m_s, 1000.0 * slip_band_m_s) if counting else (None, None),
            "surface": (target.temperature_c, target.band_k) if counting else (known(demand.surface_c), None),
            "hub": (out.hub_c if out.heat else None, None),
            "sideslip": (out.sideslip_deg, None),
            "camber": (out.camber_deg, None),
            "wheel_speed": (wheel_m_s, abs(0.01 * gates.speed_percent * wheel_m_s)),
            "belt_speed": (out.belt_m_s, abs(0.01 * gates.speed_percent * out.belt_m_s)),
        }


def friction(force_x_n: float, force_y_n: float, force_z_n: float) -> float:
    """Return the momentary coefficient, resultant over normal force; NaN out of contact."""
    if not force_z_n > CONTACT_N:
        return float("nan")
    return (force_x_n * force_x_n + force_y_n * force_y_n) ** 0.5 / force_z_n
