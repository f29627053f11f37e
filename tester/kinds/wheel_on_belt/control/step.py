"""One control step of this machine: its commands in each mode, and their bounds. No I/O, no clock."""

from __future__ import annotations

from math import inf
from typing import Final

from tester.kinds.wheel_on_belt.control.interlock_inputs import InterlockInputs
from tester.kinds.wheel_on_belt.control.loops import WheelState, loss_ratios
from tester.kinds.wheel_on_belt.control.permissives import Bounds, confirmed_speed_m_s, may_heat, may_load, rig_bounds
from tester.kinds.wheel_on_belt.control.stop_modes import WheelStops
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings
from tester.kinds.wheel_on_belt.interlocks.contact_force import UNLOADED_N
from tester.kinds.wheel_on_belt.interlocks.hub import RUNAWAY_WINDOW_S
from tester.kinds.wheel_on_belt.interlocks.operation import COLD_K, HOLD_AT_MOST_S, START_K
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.drive_rows import ACK_WAIT_S
from tester.machine.mode_commands import bounded, may_move
from tester.machine.safety_inputs import table_on

CEILING_STEP_S: Final = 1.0
"""Resolution of the times at which setpoints were left, s."""

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_INF: Final = inf
_LOAD: Final = Press.LOAD
_LIFT: Final = Press.LIFT


class WheelControl(WheelStops):
    """The control of a wheel on a belt."""

    def __init__(self, rig: RigConfig, recipe: Bounds | None = None) -> None:
        """Begin in idle; ``recipe``: the recipe's greatest values. They and the rig's own bounds limit the commands."""
        state = WheelState(rig.loops.heat.hub_min_c)
        view = InterlockInputs(state=state, rig=rig)
        p = view.parameters
        super().__init__(
            state, view, table_on(rig, rig.table), Demand(), Demand(),
            hold_at_most_s=p[HOLD_AT_MOST_S], ack_wait_s=p[ACK_WAIT_S],
        )  # fmt: skip
        self.rig = rig
        self.loss_ratios = loss_ratios(rig)
        self.bounds = rig_bounds(rig) if recipe is None else rig_bounds(rig).within(recipe)
        self._parameters = p
        self._confirmed_m_s = confirmed_speed_m_s(p)
        self._load_loop, self._heat_loop = rig.loops.load, rig.loops.heat
        self._ambient_c = rig.ambient_c

    # -- the inputs of the rows -----------------------------------------------------------------------------

    def look(self, demand: Demand, readings: Readings, scan_s: float, dt: float) -> None:
        """Update the view."""
        self.view.look(demand, readings, scan_s, dt)

    def unfit(self, readings: Readings) -> list[str]:
        """Detect a misaligned thermometer: it must agree with a cold hub."""
        r = readings
        if self._cold(r) and self._apart(r):
            return [f"thermometer at {r.surface_c:.1f} degC, hub cold at {r.hub_c:.1f} degC"]
        return []

    def doubts(self, readings: Readings) -> list[str]:
        """Report a thermometer that is off a hub that is not cold: the wheel may come from a hot run."""
        r = readings
        if self._cold(r) or not self._apart(r):
            return []
        apart_k = abs(r.surface_c - r.hub_c)
        return [
            f"thermometer at {r.surface_c:.1f} degC, hub at {r.hub_c:.1f} degC, {apart_k:.0f} K apart at rest: right"
            " only soon after a hot run"
        ]

    def _cold(self, r: Readings) -> bool:
        return abs(r.hub_c - self.rig.ambient_c) <= self._parameters[COLD_K]

    def _apart(self, r: Readings) -> bool:
        return not abs(r.surface_c - r.hub_c) <= self._parameters[START_K]

    def detail(self, readings: Readings) -> str:
        """Return the values most useful to a reader of the journal."""
        return (
            f"Fz {readings.force_z_n:.1f} N, wheel {readings.wheel_speed_m_s:.3f} m/s,"
            f" belt {readings.belt_speed_m_s:.3f} m/s,"
            f" surface {readings.surface_c:.1f} degC, hub {readings.hub_c:.1f} degC"
        )

    # -- RUN and HOLD ---------------------------------------------------------------------------------------

    def keep(self, held: Demand, demand: Demand) -> None:
        """Write a hold's demand: lift, take the slip out, keep speed, angles and heat."""
        held.press, held.load_n, held.quick_touch = _LIFT, 0.0, False
        held.wheel_speed_m_s = held.belt_speed_m_s = demand.wheel_speed_m_s
        held.positions.update(demand.positions)
        held.surface_c, held.freeze_heat = demand.surface_c, False

    def run_outputs(self, demand: Demand, readings: Readings, dt: float) -> None:
        """Command speeds, angles, press and heat from the demand, within the bounds."""
        out, state, bounds = self.state.setpoints, self.state, self.bounds
        out.enable = demand.enabled and may_move(readings)
        out.quick_stop = False
        self._position(demand, readings)
        wheel = bounded(demand.wheel_speed_m_s, bounds.wheel_speed_m_s)
        out.belt_m_s = bounded(demand.belt_speed_m_s, bounds.belt_speed_m_s)
        out.wheel_rad_s = wheel / (readings.diameter_mm * 0.5e-3) if readings.diameter_mm > 1.0 else 0.0
        load = self._load_loop
        if not readings.drives_enabled:
            out.press_mm_s = 0.0
        elif demand.press is _LOAD and not may_load(state, demand, readings, self._parameters, bounds.load_n):
            out.press_mm_s = -load.lift_speed_mm_s if not (readings.force_z_n <= UNLOADED_N) else 0.0
        else:
            out.press_mm_s = state.load.velocity(demand, readings, dt, load)
        self._heat(demand, readings)

    def _position(self, demand: Demand, readings: Readings) -> None:
        """Command the positioned axes: they move only unloaded, and keep their last command under load."""
        if readings.force_z_n < UNLOADED_N:
            positions, most = self.state.setpoints.positions, self.bounds.positions
            for name, wanted in demand.positions.items():
                positions[name] = bounded(wanted, most[name])

    def _heat(self, demand: Demand, readings: Readings) -> None:
        out, state, now = self.state.setpoints, self.state, readings.now_s
        least_c = self.view.limits.hub_min_c
        if not readings.wheel_speed_m_s > self._confirmed_m_s:
            state.turning_since_s = inf
        elif state.turning_since_s > now:
            state.turning_since_s = now
        wanted = -_INF < demand.surface_c < _INF
        out.heat = out.contactor = wanted and may_heat(state, readings, self._parameters)
        if not wanted:
            out.hub_c = least_c
        elif not demand.freeze_heat:
            target = min(demand.surface_c, self.bounds.surface_c)
            touching = state.load.in_contact
            ratio, loop = self.loss_ratios[1 if touching else 0], self._heat_loop
            air_c = self._ambient_c
            hub_c = state.heat.update(now, target, readings.surface_c, air_c, ratio, loop, touching=touching)
            # In warmer air the same surface needs a cooler hub.
            out.hub_c = min(hub_c, self.bounds.hub_c - self.view.warmer_k * self.loss_ratios[1])
        setpoint_c = out.hub_c if out.heat else least_c
        ceiling = state.hub_ceiling
        if not ceiling or ceiling[-1][1] != setpoint_c or now - ceiling[-1][0] >= CEILING_STEP_S:
            self._note_ceiling(now, setpoint_c)

    def _note_ceiling(self, now: float, setpoint_c: float) -> None:
        """Keep the highest hub setpoint of ``runaway_window`` at the front of a short monotonic list."""
        ceiling = self.state.hub_ceiling
        while ceiling and ceiling[-1][1] <= setpoint_c:
            ceiling.pop()
        ceiling.append((now, setpoint_c))
        while ceiling[0][0] < now - self._parameters[RUNAWAY_WINDOW_S]:
            ceiling.pop(0)
