"""One control step: readings and demand in, bounded setpoints out. No I/O, no clock."""

from __future__ import annotations

from math import copysign, inf, isfinite
from typing import Final

from tester.control.interlock_inputs import InterlockInputs
from tester.control.permissives import Bounds, confirmed_speed_m_s, may_heat, may_load, may_move, rig_bounds
from tester.control.safe_outputs import no_outputs, withdraw_escalation
from tester.control.state import ACKNOWLEDGED, ControlState, Event, Mode, Trip
from tester.control.stops import (
    after_stop,
    begin_fast,
    begin_stop,
    cool_outputs,
    emergency_outputs,
    stop_ended,
    stop_outputs,
)
from tester.interlocks.contact import UNLOADED_N
from tester.interlocks.hub import RUNAWAY_WINDOW_S
from tester.interlocks.operation import ACK_WAIT_S, COLD_K, HOLD_AT_MOST_S, START_K
from tester.interlocks.row import NOTHING_COMPARED, Interlock, Reaction
from tester.interlocks.table import AT_REST, INTERLOCKS, WARNINGS, held, names_of, still_there
from tester.process import Demand, Press, Readings, Setpoints
from tester.rig import RigConfig

_INF: Final = inf
CEILING_STEP_S: Final = 1.0
"""How exactly it knows when a setpoint was left, s."""

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_IDLE: Final = Mode.IDLE
_RUN: Final = Mode.RUN
_HOLD: Final = Mode.HOLD
_STOPPING: Final = Mode.STOPPING
_COOLDOWN: Final = Mode.COOLDOWN
_FAST_STOP: Final = Mode.FAST_STOP
_EMERGENCY: Final = Mode.EMERGENCY
_LATCHED: Final = Mode.LATCHED
_LOAD: Final = Press.LOAD
_LIFT: Final = Press.LIFT
_AT_REST: Final = frozenset({Mode.IDLE, Mode.ARMED, Mode.LATCHED})
_WORKING: Final = frozenset({Mode.RUN, Mode.HOLD})


class Control:
    """The rig's control: holds its configuration and its state, and nothing else."""

    def __init__(
        self, rig: RigConfig, state: ControlState, loss_ratios: tuple[float, float], recipe: Bounds | None = None
    ) -> None:
        """Bind configuration and state.

        ``loss_ratios``: steady hub-surface difference per kelvin above ambient, (lifted, in rolling contact).
        ``recipe``: the most the recipe asks for; commands stay within it and the rig's own bounds.
        """
        self.rig = rig
        self.state = state
        self.loss_ratios = loss_ratios
        self.bounds = rig_bounds(rig) if recipe is None else rig_bounds(rig).within(recipe)
        self._withdrawn = Demand()
        """What is wanted in every mode but RUN and HOLD: nothing. A stop is not watched against the load it lifts."""
        self._held = Demand()
        """What is wanted in HOLD."""
        self.view = InterlockInputs(state=state, rig=rig)
        self._parameters = self.view.parameters
        self._confirmed_m_s = confirmed_speed_m_s(self._parameters)
        self._delays = tuple(row.delay_s(self._parameters) for row in INTERLOCKS)
        self._load_loop, self._heat_loop = rig.loops.load, rig.loops.heat
        self._ambient_c = rig.ambient_c
        state.pending_s = [inf] * len(INTERLOCKS)

    def step(self, demand: Demand, readings: Readings, scan_s: float) -> Setpoints:
        """Return the setpoints for this scan; ``state.events`` holds what must be journalled before they leave."""
        state, now = self.state, readings.now_s
        mode = state.mode
        if mode is not _RUN:
            if mode is _HOLD:
                demand = self._held
            else:
                demand = self._withdrawn
                demand.enabled = state.setpoints.enable
        dt = now - state.last_s
        if not (0.0 <= dt <= 0.2):
            dt = 0.2 if dt > 0.2 else 0.0
        self._watch(demand, readings, scan_s, dt)
        mode = state.mode
        state.last_s = now
        if mode is _RUN:
            self._run(demand, readings, dt)
        else:
            self._other(mode, readings, dt)
        return state.setpoints

    def _other(self, mode: Mode, readings: Readings, dt: float) -> None:
        state, view = self.state, self.view
        if mode is _HOLD:
            self._hold(readings, dt)
        elif mode is _STOPPING or mode is _FAST_STOP:
            stop_outputs(state, view)
            if stop_ended(state, view):
                after_stop(state, view)
        elif mode is _EMERGENCY:
            emergency_outputs(state, view)
            if stop_ended(state, view):
                after_stop(state, view)
        elif mode is _COOLDOWN:
            if cool_outputs(state, view):
                begin_stop(state, view, readings.now_s, self.bounds)
        else:
            no_outputs(state.setpoints, self.rig)
            if mode is _LATCHED and state.ack_until_s > -inf:
                self._acknowledge(readings.now_s)

    # -- requests -------------------------------------------------------------------------------------------

    def start(self, readings: Readings) -> str:
        """Arm and enter RUN: one arming edge. Return "" or which levels stand in the way.

        ``readings`` are of now; every level of the table is evaluated on them.
        """
        state, now = self.state, readings.now_s
        if state.mode is not _IDLE:
            return f"the rig is in {state.mode.value}, not idle"
        state.last_s = now
        state.stop_requested = ""
        state.cooled = False
        state.stop.began_s = inf
        state.held = state.tripped = 0
        state.pending_s[:] = [inf] * len(INTERLOCKS)
        withdraw_escalation(state.setpoints)
        demand = self._withdrawn
        demand.enabled = False
        self.view.look(demand, readings, 0.0, 0.0)
        holding = names_of(held(self.view) & ~WARNINGS)
        p = self._parameters
        cold = abs(readings.hub_c - self.rig.ambient_c) <= p[COLD_K]
        if cold and not abs(readings.surface_c - readings.hub_c) <= p[START_K]:
            holding.append(f"thermometer at {readings.surface_c:.1f} degC, hub cold at {readings.hub_c:.1f} degC")
        if holding:
            return "not armed: " + ", ".join(holding)
        state.enter(Mode.ARMED, now, "every level clear")
        state.enter(_RUN, now, "start")
        return ""

    def request_hold(self, demand: Demand, now: float, why: str) -> str:
        """Hold a run: lift, take the slip out, keep the heat. Return "" or why not; idempotent."""
        state = self.state
        if state.mode is _HOLD:
            return ""
        if state.mode is not _RUN:
            return f"nothing runs that could be held: the rig is in {state.mode.value}"
        held = self._held
        held.enabled = demand.enabled
        held.press, held.load_n, held.quick_touch = _LIFT, 0.0, False
        held.wheel_speed_m_s = held.belt_speed_m_s = demand.wheel_speed_m_s
        held.sideslip_deg, held.camber_deg = demand.sideslip_deg, demand.camber_deg
        held.surface_c, held.freeze_heat = demand.surface_c, False
        held.attended = demand.attended
        state.enter(_HOLD, now, why)
        return ""

    def request_release(self, now: float, why: str) -> str:
        """Go on after a hold; return "" or why not."""
        if self.state.mode is not _HOLD:
            return f"nothing to release: the rig is in {self.state.mode.value}"
        self.state.enter(_RUN, now, why)
        return ""

    def request_stop(self, now: float, why: str, *, fast: bool = False, cool: bool = True) -> None:
        """Begin a controlled (or fast) stop; idempotent, and never slows one that is under way.

        ``cool``: the wheel goes on turning, unloaded, while the jacket is hot.
        """
        state = self.state
        mode = state.mode
        if not cool:
            state.cooled = True
        if mode in _AT_REST or mode is _FAST_STOP or mode is _EMERGENCY:
            return
        if mode is _COOLDOWN and not fast and not state.cooled:
            return
        state.stop_requested = state.stop_requested or why
        if mode is not _STOPPING:
            begin_stop(state, self.view, now, self.bounds)
        if fast:
            begin_fast(state, self.view, now, self.bounds)
            state.enter(_FAST_STOP, now, why)
        elif mode in _WORKING or (mode is _COOLDOWN and state.cooled):
            state.enter(_STOPPING, now, why)

    def request_ack(self, now: float, by: str = "") -> str:
        """Acknowledge a latched trip: IDLE follows once every cause is gone. Return "" or why not; idempotent."""
        state = self.state
        if state.mode is not _LATCHED:
            return f"nothing to acknowledge: the rig is in {state.mode.value}"
        if state.ack_until_s < now:
            state.ack_until_s, state.ack_by = now + self._parameters[ACK_WAIT_S], by
            withdraw_escalation(state.setpoints)
        return ""

    def _acknowledge(self, now: float) -> None:
        """Leave LATCHED where nothing holds any more; refuse when something still does after a while."""
        state = self.state
        holding = (state.held | still_there(self.view) & state.tripped) & ~WARNINGS
        if not holding:
            state.ack_until_s = -inf
            state.trip = None
            state.tripped = 0
            state.events.append(Event(now, ACKNOWLEDGED, state.ack_by))
            state.enter(_IDLE, now, "acknowledged")
        elif now > state.ack_until_s:
            state.ack_until_s = -inf
            state.tripped &= ~AT_REST  # what still moves or heats loses its power again
            names = ", ".join(names_of(holding))
            state.events.append(Event(now, "acknowledgement", f"refused, still there: {names}"))

    # -- interlocks -----------------------------------------------------------------------------------------

    def _watch(self, demand: Demand, readings: Readings, scan_s: float, dt: float) -> None:
        """Evaluate every row of the table: a level that has held for its delay trips."""
        state = self.state
        self.view.look(demand, readings, scan_s, dt)
        now_held = held(self.view)
        if now_held or state.held:
            self._time(now_held, readings)

    def _time(self, now_held: int, readings: Readings) -> None:
        """Note since when rows hold, and trip those that have for their delay."""
        state, now, delays = self.state, readings.now_s, self._delays
        pending = state.pending_s
        gone = state.held & ~now_held
        state.held = now_held
        state.tripped &= ~(gone & WARNINGS)
        while gone:
            lowest = gone & -gone
            gone ^= lowest
            pending[lowest.bit_length() - 1] = inf
        due = now_held & ~state.tripped
        while due:
            lowest = due & -due
            due ^= lowest
            i = lowest.bit_length() - 1
            if pending[i] > now:
                pending[i] = now
            if now - pending[i] >= delays[i] - 1e-9:
                self._trip(i, lowest, readings)

    def _trip(self, i: int, own: int, readings: Readings) -> None:
        """Act on a row that is due: warn, or stop by its reaction. At rest little is left to stop."""
        state, row, now = self.state, INTERLOCKS[i], readings.now_s
        if row.reaction is Reaction.WARN:
            state.tripped |= own
            state.events.append(Event(now, "warning", f"{row.name}: {row.cause}"))
            return
        resting = state.mode in _AT_REST
        if resting and not self._acts_at_rest(row):
            return
        state.tripped |= own
        text = row.cause + _detail(readings)
        if state.trip is None:
            compared = row.compared(self.view) if row.compared is not None else NOTHING_COMPARED
            state.trip = Trip(now, row.name, text, row.reaction, compared)
            state.events.append(Event(now, "trip", f"{row.name}: {text}"))
        else:
            state.events.append(Event(now, "alarm", f"{row.name}: {text}"))
        if row.ends_lease and not (readings.heat_percent <= 0.0):
            state.setpoints.jacket_silent = True
        if not resting:
            self._react(row.reaction, now, row.name)
        else:
            state.setpoints.power_off = state.setpoints.power_off or row.reaction is Reaction.POWER_OFF
            if state.mode is not _LATCHED:
                state.enter(_LATCHED, now, row.name)

    def _acts_at_rest(self, row: Interlock) -> bool:
        """Tell whether a row trips at rest: something is on that is to be off."""
        return row.at_rest is not None and row.at_rest(self.view)

    def _react(self, reaction: Reaction, now: float, why: str) -> None:
        state, mode = self.state, self.state.mode
        if mode in _WORKING or mode is _COOLDOWN:
            begin_stop(state, self.view, now, self.bounds)
        if reaction is Reaction.EMERGENCY:
            if mode is not _EMERGENCY:
                begin_fast(state, self.view, now, self.bounds)
                state.enter(_EMERGENCY, now, why)
        elif reaction is Reaction.CONTROLLED:
            if mode in _WORKING:
                state.enter(_STOPPING, now, why)
            elif mode is _COOLDOWN:
                state.stop.creeps = True
        elif mode is not _EMERGENCY:
            begin_fast(state, self.view, now, self.bounds)
            if mode is not _FAST_STOP:
                state.enter(_FAST_STOP, now, why)
        if reaction is Reaction.POWER_OFF:
            state.setpoints.power_off = True

    # -- modes ----------------------------------------------------------------------------------------------

    def _run(self, demand: Demand, readings: Readings, dt: float) -> None:
        out, state, bounds = self.state.setpoints, self.state, self.bounds
        out.enable = demand.enabled and may_move(readings)
        out.quick_stop = False
        out.sideslip_deg, out.camber_deg = self._yaw(demand, readings)
        wheel = _bounded(demand.wheel_speed_m_s, bounds.wheel_speed_m_s)
        out.belt_m_s = _bounded(demand.belt_speed_m_s, bounds.belt_speed_m_s)
        out.wheel_rad_s = wheel / (readings.diameter_mm * 0.5e-3) if readings.diameter_mm > 1.0 else 0.0
        load = self._load_loop
        if not readings.drives_enabled:
            out.press_mm_s = 0.0
        elif demand.press is _LOAD and not may_load(state, demand, readings, self._parameters, bounds.load_n):
            out.press_mm_s = -load.lift_speed_mm_s if not (readings.force_z_n <= UNLOADED_N) else 0.0
        else:
            out.press_mm_s = state.load.velocity(demand, readings, dt, load)
        self._heat(demand, readings)

    def _hold(self, readings: Readings, dt: float) -> None:
        """Command what a hold wants; one that lasts too long ends in a controlled stop."""
        state, now = self.state, readings.now_s
        if now - state.mode_since_s > self._parameters[HOLD_AT_MOST_S]:
            self.request_stop(now, "held too long")
            stop_outputs(state, self.view)
        else:
            self._run(self._held, readings, dt)

    def _yaw(self, demand: Demand, readings: Readings) -> tuple[float, float]:
        """Sideslip and camber move only unloaded; under load they stay where they were commanded."""
        out, bounds = self.state.setpoints, self.bounds
        if not readings.force_z_n < UNLOADED_N:
            return out.sideslip_deg, out.camber_deg
        return _bounded(demand.sideslip_deg, bounds.sideslip_deg), _bounded(demand.camber_deg, bounds.camber_deg)

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
            ratio = self.loss_ratios[1 if state.load.in_contact else 0]
            hub_c = state.heat.update(now, target, readings.surface_c, self._ambient_c, ratio, self._heat_loop)
            out.hub_c = min(hub_c, self.bounds.hub_c)
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
    said = "; ".join(
        said
        for said in (readings.drive_fault, readings.bus_fault, readings.foreign_master, readings.device_fault)
        if said
    )
    return f" [{said}]{text}" if said else text
