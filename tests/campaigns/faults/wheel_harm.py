"""Harm, as the plant sees it: an observer of the true state, never of measurements or intentions.

The figures are those of docs/kinds/wheel-on-belt.md [A].
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import hypot, inf

from sim.machines.wheel_on_belt.rig import WheelRig
from sim.nodes.motion import PositionAxis, VelocityAxis

POWER_W, POWER_S = 350.0, 0.5
"""Slip speed times normal force beyond the plan, and for how long."""
CONTACT_C = 130.0
FORCE_N = 500.0
HUB_C = 155.0
STANDING_J = 40.0
"""Heat of friction with one axis stopped under load while the other runs: it flat-spots the wheel."""
COLD_STAND_S = 0.5
"""The jacket may heat a standing wheel for this long."""
UNLOADED_N = 5.0
STILL_M_S = 0.01
CREEP_M_S = 0.12
"""The creep of a cool-down is 0.1 m/s [A]."""
SAFE_S = 3.0
"""From the trip, or the loss of control, to physically safe (I5)."""
PRESS_MM = 1.0
"""A press that must stand has moved at most this far, mm [A]: half of its clearance."""
_NUDGE = 0.01
"""A yaw axis slower than this counts as standing, deg/s."""


@dataclass(slots=True)
class Truth:
    """The part of the rig's state that determines harm, in plain numbers."""

    force_n: float
    slip_m_s: float
    wheel_m_s: float
    belt_m_s: float
    heater_w: float

    @classmethod
    def of(cls, rig: WheelRig) -> Truth:
        """Look at a rig."""
        plant = rig.plant
        return cls(plant.force_z_n, plant.slip_m_s, rig.rim_m_s, rig.belt_m_s, rig.heat_flowing_w)

    def unsafe(self, *, creeping: bool = False, force_stays: bool = False) -> list[str]:
        """Return what the safe state of invariant I5 lacks; empty when the rig is safe.

        ``creeping``: in a cool-down the wheel turns slowly, unloaded.
        """
        missing: list[str] = []
        if not self.force_n < UNLOADED_N and not force_stays:
            missing.append(f"force {self.force_n:.1f} N")
        if self.heater_w > 0.0:
            missing.append(f"heat {self.heater_w:.0f} W")
        if not abs(self.wheel_m_s) < (CREEP_M_S if creeping else STILL_M_S):
            missing.append(f"wheel {self.wheel_m_s:.3f} m/s")
        if not abs(self.belt_m_s) < STILL_M_S:
            missing.append(f"belt {self.belt_m_s:.3f} m/s")
        if not self.slip_m_s < (CREEP_M_S if creeping else STILL_M_S):
            missing.append(f"slip {self.slip_m_s:.3f} m/s")
        return missing


@dataclass(slots=True)
class HarmObserver:
    """Watches one rig. ``found`` names each harm once, with time and figure. Copied together with the rig.

    ``planned_w`` is the greatest slip speed times load that the recipe asks for, W. ``heat_stays``: with a shorted
    heater and a welded contactor only hardware ends the heat.
    """

    rig: WheelRig
    planned_w: float = 0.0
    found: dict[str, str] = field(default_factory=dict[str, str])
    most_n: float = 0.0
    """The greatest figures so far: force ..."""
    most_hub_c: float = -inf
    most_contact_c: float = -inf
    most_power_w: float = 0.0
    """... slip speed times normal force, however short ..."""
    most_standing_j: float = 0.0
    """... and heat of friction with one axis stopped."""
    _last_s: float = -inf
    _power_since_s: float = inf
    _heat_since_s: float = inf
    _standing_j: float = 0.0
    _press_mm: float = inf

    def look(self, must_stand: bool) -> None:
        """Look at the rig as it is now; ``must_stand``: latched, idle or emergency stop, and time enough to rest."""
        rig, now = self.rig, self.rig.now_s
        dt = now - self._last_s if self._last_s > -inf else 0.0
        if now <= self._last_s:
            return
        self._last_s = now
        plant = rig.plant
        force_n = plant.force_z_n
        self._most(force_n)
        if force_n > FORCE_N:
            self._note("force", f"{force_n:.0f} N at {now:.2f} s, at most {FORCE_N:g} N")
        if plant.surface_c > CONTACT_C:
            self._note("contact temperature", f"{plant.surface_c:.0f} degC at {now:.2f} s, at most {CONTACT_C:g} degC")
        if plant.heat.hub_c > HUB_C:
            self._note("hub temperature", f"{plant.heat.hub_c:.0f} degC at {now:.2f} s, at most {HUB_C:g} degC")
        wheel, belt = abs(rig.rim_m_s), abs(rig.belt_m_s)
        self._rubbing(now, dt, force_n, wheel, belt)
        if wheel < STILL_M_S and rig.heat_flowing_w > 0.0:
            self._heat_since_s = min(self._heat_since_s, now)
            if now - self._heat_since_s > COLD_STAND_S:
                self._note("heat on a standing wheel", f"at {now:.2f} s, for more than {COLD_STAND_S:g} s")
        else:
            self._heat_since_s = inf
        if must_stand:
            self._stand(now, wheel, belt)
        else:
            self._press_mm = inf

    def forget(self) -> None:
        """Reset the greatest figures."""
        self.most_n = self.most_power_w = self.most_standing_j = 0.0
        self.most_hub_c = self.most_contact_c = -inf

    def _most(self, force_n: float) -> None:
        plant = self.rig.plant
        power_w = plant.slip_m_s * force_n
        self.most_n = force_n if force_n > self.most_n else self.most_n
        self.most_power_w = power_w if power_w > self.most_power_w else self.most_power_w
        self.most_hub_c = plant.heat.hub_c if plant.heat.hub_c > self.most_hub_c else self.most_hub_c
        self.most_contact_c = plant.surface_c if plant.surface_c > self.most_contact_c else self.most_contact_c

    def _rubbing(self, now: float, dt: float, force_n: float, wheel: float, belt: float) -> None:
        plant = self.rig.plant
        if plant.slip_m_s * force_n > max(POWER_W, 1.05 * self.planned_w):
            self._power_since_s = min(self._power_since_s, now)
            if now - self._power_since_s > POWER_S:
                power = plant.slip_m_s * force_n
                self._note("slip power", f"{power:.0f} W at {now:.2f} s for more than {POWER_S:g} s")
        else:
            self._power_since_s = inf
        if force_n > UNLOADED_N and (wheel < STILL_M_S) != (belt < STILL_M_S):
            self._standing_j += hypot(plant.force_x_n, plant.force_y_n) * plant.slip_m_s * dt
            self.most_standing_j = max(self.most_standing_j, self._standing_j)
            if self._standing_j > STANDING_J:
                self._note(
                    "one axis stopped under load", f"{self._standing_j:.0f} J by {now:.2f} s, at most {STANDING_J:g} J"
                )
        else:
            self._standing_j = 0.0

    def _stand(self, now: float, wheel: float, belt: float) -> None:
        press = self.rig.axes["press"].axis.position
        self._press_mm = min(self._press_mm, press)
        moving: list[str] = []
        if wheel >= STILL_M_S:
            moving.append(f"wheel {wheel:.3f} m/s")
        if belt >= STILL_M_S:
            moving.append(f"belt {belt:.3f} m/s")
        for name, drive in self.rig.axes.items():
            axis = drive.axis
            towards = name == "press" and isinstance(axis, VelocityAxis) and axis.position > self._press_mm + PRESS_MM
            yaws = isinstance(axis, PositionAxis) and abs(axis.value) > _NUDGE
            if towards or yaws:
                moving.append(f"{name} {axis.value:.2f}")
        if moving:
            self._note("motion where everything must stand", f"{', '.join(moving)} at {now:.2f} s")

    def _note(self, name: str, text: str) -> None:
        self.found.setdefault(name, text)
