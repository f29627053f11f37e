"""One control step: readings and demand in, bounded setpoints out. No I/O, no clock."""

from __future__ import annotations

from math import copysign, cos, inf, isfinite, radians

from tester.control.interlocks import INTERLOCKS, STANDING_M_S, UNLOADED_N, View
from tester.control.safe_outputs import safe_outputs
from tester.control.state import ControlState, Event, Mode, Reaction, Trip
from tester.process import Demand, Press, Readings, Setpoints
from tester.rig import RigConfig

TURNING_CONFIRMED_S = 0.3
"""Heat is allowed once the wheel has been seen turning this long [A]."""
CEILING_WINDOW_S = 600.0
"""The runaway limit looks back this long (rulings, interlocks)."""
STOP_TIMEOUT_S = 10.0
"""A stop that has not reached standstill by then escalates [A]."""

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_IDLE, _RUN, _STOPPING, _COOLDOWN, _FAST_STOP, _LATCHED = (
    Mode.IDLE, Mode.RUN, Mode.STOPPING, Mode.COOLDOWN, Mode.FAST_STOP, Mode.LATCHED
)  # fmt: skip
_LOAD = Press.LOAD


class Control:
    """The rig's control: holds its configuration and its state, and nothing else."""

    def __init__(self, rig: RigConfig, state: ControlState, loss_ratios: tuple[float, float]) -> None:
        """Bind configuration and state.

        ``loss_ratios``: steady hub-surface difference per kelvin above ambient, (lifted, in rolling contact).
        """
        self.rig = rig
        self.state = state
        self.loss_ratios = loss_ratios
        self._withdrawn = Demand()
        """What is wanted in every mode but RUN: nothing. A stop is not watched against the load it takes off."""
        self._conditions = tuple(row.condition for row in INTERLOCKS)
        self._delays = tuple(row.delay_s(rig) for row in INTERLOCKS)
        self._view = View(state, rig)
        state.pending_s = [inf] * len(INTERLOCKS)

    def step(self, demand: Demand, readings: Readings, scan_s: float) -> Setpoints:
        """Return the setpoints for this scan; ``state.events`` holds what must be journalled before they leave."""
        state, now = self.state, readings.now_s
        mode = state.mode
        if mode is not _RUN:
            demand = self._withdrawn
            demand.enabled = state.setpoints.enable
        dt = min(max(now - state.last_s, 0.0), 0.2)
        if mode is not _IDLE and mode is not _LATCHED:
            self._watch(demand, readings, scan_s)
            mode = state.mode
        state.last_s = now
        if mode is _RUN:
            self._run(demand, readings, dt)
        elif mode is _STOPPING or mode is _FAST_STOP:
            self._stop(readings, now)
        elif mode is _COOLDOWN:
            self._cool_down(readings, now)
        else:
            self._rest_commands()
        return state.setpoints

    # -- requests -------------------------------------------------------------------------------------------

    def start(self, now: float) -> str:
        """Enter RUN; return "" or why not."""
        if self.state.mode is not Mode.IDLE:
            return f"the rig is in {self.state.mode.value}, not idle"
        self.state.stop_requested = ""
        self.state.cooled = False
        self.state.last_s = now
        self.state.enter(Mode.RUN, now, "start")
        return ""

    def request_stop(self, now: float, why: str, *, fast: bool = False) -> None:
        """Begin a controlled (or fast) stop; idempotent, and never slows one that is under way."""
        state = self.state
        if state.mode in (Mode.IDLE, Mode.LATCHED, Mode.FAST_STOP):
            return
        state.stop_requested = state.stop_requested or why
        if fast:
            state.enter(Mode.FAST_STOP, now, why)
        elif state.mode is not Mode.STOPPING:
            state.enter(Mode.STOPPING, now, why)

    def acknowledge(self, now: float) -> str:
        """Leave LATCHED for IDLE; return "" or why not."""
        if self.state.mode is not Mode.LATCHED:
            return "nothing to acknowledge"
        self.state.trip = None
        self.state.enter(Mode.IDLE, now, "acknowledged")
        return ""

    # -- interlocks -----------------------------------------------------------------------------------------

    def _watch(self, demand: Demand, readings: Readings, scan_s: float) -> None:
        """Evaluate every row of the table: a level that has held for its delay trips."""
        view, pending = self._view, self.state.pending_s
        view.look(demand, readings, scan_s)
        for i, condition in enumerate(self._conditions):
            if condition(view):
                self._hold(i, readings)
            else:
                pending[i] = inf

    def _hold(self, i: int, readings: Readings) -> None:
        """Note that the condition of row ``i`` holds, and trip when it has for its delay."""
        pending, now = self.state.pending_s, readings.now_s
        if pending[i] > now:
            pending[i] = now
        if now - pending[i] >= self._delays[i] - 1e-9:
            row = INTERLOCKS[i]
            self._trip(Trip(now, row.name, row.cause + _detail(readings), row.reaction))

    def _trip(self, trip: Trip) -> None:
        state = self.state
        if state.trip is None:
            state.trip = trip
            state.events.append(Event(trip.at_s, "trip", f"{trip.name}: {trip.text}"))
        if trip.reaction is Reaction.FAST and state.mode is not Mode.FAST_STOP:
            state.enter(Mode.FAST_STOP, trip.at_s, trip.name)
        elif trip.reaction is Reaction.CONTROLLED and state.mode is Mode.RUN:
            state.enter(Mode.STOPPING, trip.at_s, trip.name)

    # -- modes ----------------------------------------------------------------------------------------------

    def _run(self, demand: Demand, readings: Readings, dt: float) -> None:
        out, state, limits = self.state.setpoints, self.state, self.rig.limits
        out.enable = demand.enabled
        out.quick_stop = False
        out.contactor = True
        out.sideslip_deg, out.camber_deg = self._yaw(demand, readings)
        wheel = _bounded(demand.wheel_speed_m_s, limits.wheel_speed_m_s)
        out.belt_m_s = _bounded(demand.belt_speed_m_s, limits.belt_speed_m_s)
        out.wheel_rad_s = wheel / (readings.diameter_mm * 0.5e-3) if readings.diameter_mm > 1.0 else 0.0
        load = self.rig.loops.load
        if demand.press is _LOAD and not self._may_load(demand, readings):
            out.press_mm_s = -load.lift_speed_mm_s if readings.force_z_n > UNLOADED_N else 0.0
        else:
            out.press_mm_s = state.load.velocity(demand, readings, dt, load, self.rig.axes.press)
        if not readings.drives_enabled:
            out.press_mm_s = 0.0
        self._heat(demand, readings)

    def _yaw(self, demand: Demand, readings: Readings) -> tuple[float, float]:
        """Sideslip and camber move only unloaded; under load they stay where they were commanded."""
        out, limits = self.state.setpoints, self.rig.limits
        if not readings.force_z_n < UNLOADED_N:
            return out.sideslip_deg, out.camber_deg
        return _bounded(demand.sideslip_deg, limits.sideslip_deg), _bounded(demand.camber_deg, limits.camber_deg)

    def _may_load(self, demand: Demand, readings: Readings) -> bool:
        """Load only with both speeds confirmed, their difference bounded, the angles in place and the data fresh."""
        r, limits = readings, self.rig.limits
        confirmed = r.wheel_speed_m_s > 2.0 * STANDING_M_S and r.belt_speed_m_s > 2.0 * STANDING_M_S
        lateral = abs(r.wheel_speed_m_s * cos(radians(r.sideslip_deg)) - r.belt_speed_m_s)
        fresh = r.cell_valid and r.now_s - r.cell_at_s <= self.rig.interlocks.stale_cell_s
        in_contact = self.state.load.in_contact
        return (
            confirmed
            and fresh
            and (in_contact or r.yaw_reached)
            and lateral <= self.rig.interlocks.max_slip_m_s
            and demand.load_n <= limits.load_n
        )

    def _heat(self, demand: Demand, readings: Readings) -> None:
        out, state, loop, now = self.state.setpoints, self.state, self.rig.loops.heat, readings.now_s
        if not readings.wheel_speed_m_s > 2.0 * STANDING_M_S:
            state.turning_since_s = inf
        elif state.turning_since_s > now:
            state.turning_since_s = now
        wanted = isfinite(demand.surface_c)
        allowed = (
            now - state.turning_since_s >= TURNING_CONFIRMED_S and readings.jacket_valid and readings.surface_valid
        )
        out.heat = wanted and allowed
        if not wanted:
            out.hub_c = loop.hub_min_c
        elif not demand.freeze_heat:
            target = min(demand.surface_c, self.rig.limits.surface_c)
            ratio = self.loss_ratios[1 if state.load.in_contact else 0]
            out.hub_c = state.heat.update(now, target, readings.surface_c, self.rig.ambient_c, ratio, loop)
        self._note_ceiling(now, out.hub_c if out.heat else loop.hub_min_c)

    def _note_ceiling(self, now: float, setpoint_c: float) -> None:
        """Keep the highest hub setpoint of the last ten minutes at the front of a short monotonic list."""
        ceiling = self.state.hub_ceiling
        while ceiling and ceiling[-1][1] <= setpoint_c:
            ceiling.pop()
        ceiling.append((now, setpoint_c))
        while ceiling[0][0] < now - CEILING_WINDOW_S:
            ceiling.pop(0)

    def _stop(self, readings: Readings, now: float) -> None:
        state, out = self.state, self.state.setpoints
        fast = state.mode is Mode.FAST_STOP
        loaded = not readings.force_z_n < UNLOADED_N
        matched = abs(readings.slip_m_s) < 2.0 * STANDING_M_S
        wheel_rad_s, still_slipping = out.wheel_rad_s, loaded and not matched and now - state.mode_since_s < 0.5
        safe_outputs(out, self.rig, fast=fast)
        if not fast and still_slipping and readings.wheel_speed_m_s > 0.0:
            # Slip to zero first: with equal decelerations the slower belt would stand while the wheel still turns.
            out.wheel_rad_s = wheel_rad_s
            out.belt_m_s = _bounded(readings.wheel_speed_m_s, self.rig.limits.belt_speed_m_s)
        lifted = readings.press_mm <= state.load.lifted_mm(self.rig.loops.load) + 0.2
        if lifted:
            out.press_mm_s = 0.0
        standing = abs(readings.wheel_speed_m_s) < STANDING_M_S and abs(readings.belt_speed_m_s) < STANDING_M_S
        if (standing and lifted and not loaded) or now - state.mode_since_s > STOP_TIMEOUT_S:
            self._after_stop(readings, now)

    def _after_stop(self, readings: Readings, now: float) -> None:
        state, interlocks = self.state, self.rig.interlocks
        if state.mode is Mode.FAST_STOP or state.trip is not None:
            state.enter(Mode.LATCHED, now, "standstill")
        elif readings.hub_c > interlocks.cooldown_hub_c and readings.drives_enabled and not state.cooled:
            state.enter(Mode.COOLDOWN, now, "jacket hot")
        else:
            state.enter(Mode.IDLE, now, "standstill")
        if state.mode is not Mode.COOLDOWN:
            self._rest_commands()

    def _cool_down(self, readings: Readings, now: float) -> None:
        state, out, interlocks = self.state, self.state.setpoints, self.rig.interlocks
        safe_outputs(out, self.rig, fast=False)
        out.press_mm_s = 0.0
        cool = readings.hub_c <= interlocks.cooldown_hub_c
        if cool or now - state.mode_since_s > interlocks.cooldown_at_most_s:
            state.cooled = True
            state.enter(Mode.STOPPING, now, "cooled down" if cool else "cool-down time over")
            return
        out.wheel_rad_s = interlocks.cooldown_speed_m_s / (readings.diameter_mm * 0.5e-3)

    def _rest_commands(self) -> None:
        out = self.state.setpoints
        safe_outputs(out, self.rig, fast=False)
        out.press_mm_s = 0.0
        out.enable = False


def _bounded(value: float, limit: float) -> float:
    """Clamp to +-limit; what is not a finite number becomes 0."""
    if -limit <= value <= limit:
        return value
    return copysign(limit, value) if isfinite(value) else 0.0


def _detail(readings: Readings) -> str:
    """Name the values a reader of the journal wants first."""
    text = (
        f" (Fz {readings.force_z_n:.1f} N, wheel {readings.wheel_speed_m_s:.3f} m/s,"
        f" belt {readings.belt_speed_m_s:.3f} m/s,"
        f" surface {readings.surface_c:.1f} degC, hub {readings.hub_c:.1f} degC)"
    )
    return f" [{readings.drive_fault}]{text}" if readings.drive_fault else text
