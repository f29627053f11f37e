"""One control step of any machine: readings and demand in, bounded setpoints out. No I/O, no clock.

Modes, requests, timing and trips are the same for every kind, which implements each mode's commands (``ModeCommands``).
"""

from __future__ import annotations

from math import inf
from typing import Any, Final

from tester.base.deriving import mypyc_attr
from tester.machine.interlock_table import InterlockTable, RigTable
from tester.machine.mode_commands import DemandT, InputsT, ModeCommands, ReadingsT, StateT
from tester.machine.row import Interlock, Reaction
from tester.machine.state import ACKNOWLEDGED, ControlEvent, Mode, Trip

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_IDLE: Final = Mode.IDLE
_RUN: Final = Mode.RUN
_HOLD: Final = Mode.HOLD
_STOPPING: Final = Mode.STOPPING
_COOLDOWN: Final = Mode.COOLDOWN
_FAST_STOP: Final = Mode.FAST_STOP
_EMERGENCY: Final = Mode.EMERGENCY
_LATCHED: Final = Mode.LATCHED
_AT_REST: Final = frozenset({Mode.IDLE, Mode.ARMED, Mode.LATCHED})
_WORKING: Final = frozenset({Mode.RUN, Mode.HOLD})

VOLTAGE_S: Final = 0.5
"""A drive that needs no power loses its voltage after this, s [A]: no stop waits for yaw, which ends within 0.25 s."""


@mypyc_attr(allow_interpreted_subclasses=True)
class Control(ModeCommands[StateT, ReadingsT, DemandT, InputsT]):
    """A machine's control: its state, its interlock table and the inputs of the table."""

    def __init__(
        self,
        state: StateT,
        view: InputsT,
        table: InterlockTable,
        withdrawn: DemandT,
        held: DemandT,
        *,
        hold_at_most_s: float,
        ack_wait_s: float,
    ) -> None:
        """Store the kind's parts. ``withdrawn``, ``held``: fresh demands for the modes that ignore the recipe's demand.

        ``hold_at_most_s``: after this time a hold ends in a controlled stop. ``ack_wait_s``: an acknowledgement waits
        this long for the last cause to clear.
        """
        super().__init__(state, view)
        self.table = table
        self._withdrawn = withdrawn
        """The demand in every mode but RUN and HOLD: nothing. A stop is not judged against the load that it removes."""
        self._held = held
        """The demand in HOLD."""
        self._hold_at_most_s, self._ack_wait_s = hold_at_most_s, ack_wait_s
        self._rows = RigTable(table, view.parameters)
        self._delays = table.delays_s(view.parameters)
        state.pending_s = table.nothing_pending()
        self._leapt_s = 0.0

    def leap(self, seconds: float) -> None:
        """Let rig time pass without scans (``tester.machine.leaps``): the next scan is not late."""
        self.state.last_s += seconds
        self._leapt_s += seconds

    def step(self, demand: DemandT, readings: ReadingsT, scan_s: float) -> None:
        """Compute ``state.setpoints`` for this scan; journal ``state.events`` before the setpoints leave."""
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
        self._watch(demand, readings, scan_s, dt + self._leapt_s)  # sums and averages count a leap whole
        self._leapt_s = 0.0
        mode = state.mode
        late_s = now - state.last_s - scan_s
        state.last_late_s = late_s if 0.0 < late_s < inf else 0.0
        state.last_period_s = scan_s
        state.last_s = now
        if mode is _RUN:
            self.run_outputs(demand, readings, dt)
        else:
            self._other(mode, readings, dt)
        if not state.setpoints.enable:
            self._disable_voltage(now)
        elif state.unwanted_s < inf:
            state.unwanted_s = inf
            state.setpoints.voltage_off = False

    def _disable_voltage(self, now: float) -> None:
        """Disable every drive's voltage once none has needed power for ``VOLTAGE_S``.

        The usual way down follows the drive's statusword. A drive that repeats an old one would stay on."""
        state, out = self.state, self.state.setpoints
        moves = out.quick_stop and not self.motion_over()
        state.unwanted_s = inf if moves else min(state.unwanted_s, now)
        out.voltage_off = now - state.unwanted_s > VOLTAGE_S

    def _other(self, mode: Mode, readings: ReadingsT, dt: float) -> None:
        state, now = self.state, readings.now_s
        if mode is _HOLD:
            self._hold(readings, dt)
        elif mode is _STOPPING or mode is _FAST_STOP:
            self.stop_outputs()
            if self.stop_ended():
                self._after_stop(now)
        elif mode is _EMERGENCY:
            self.emergency_outputs()
            if self.stop_ended():
                self._after_stop(now)
        elif mode is _COOLDOWN:
            over = self.cool_outputs()
            if over:
                state.cooled = True
                state.enter(_STOPPING, now, over)
                self._begin_stop(now)
        else:
            self.rest_outputs()
            if mode is _LATCHED and state.ack_until_s > -inf:
                self._acknowledge(now)

    # -- requests -------------------------------------------------------------------------------------------

    def start(self, readings: ReadingsT) -> str:
        """Arm and enter RUN: one arming edge. Return "", or the levels that prevent it.

        ``readings`` must be present values: every level of the table is evaluated on them.
        """
        state, now = self.state, readings.now_s
        if state.mode is not _IDLE:
            return f"the rig is in {state.mode.value}, not idle"
        state.last_s = now
        state.last_late_s = state.last_period_s = 0.0
        state.stop_requested = ""
        state.cooled = False
        state.stop.began_s = inf
        state.held = state.tripped = 0
        state.pending_s = self.table.nothing_pending()
        self.withdraw_escalation()
        demand = self._withdrawn
        demand.enabled = False
        self.look(demand, readings, 0.0, 0.0)
        blocking = self.table.names_of(self._rows.held(self.view) & ~self.table.warnings) + self.unfit(readings)
        if blocking:
            return "not armed: " + ", ".join(blocking)
        state.enter(Mode.ARMED, now, "every level clear")
        state.enter(_RUN, now, "start")
        return ""

    def request_hold(self, demand: DemandT, now: float, why: str) -> str:
        """Hold a run: open the contact, keep the heat. Return "", or the reason for refusing; idempotent."""
        state = self.state
        if state.mode is _HOLD:
            return ""
        if state.mode is not _RUN:
            return f"nothing to hold: the rig is in {state.mode.value}"
        self._held.enabled, self._held.attended = demand.enabled, demand.attended
        self.keep(self._held, demand)
        state.enter(_HOLD, now, why)
        return ""

    def request_release(self, now: float, why: str) -> str:
        """Resume after a hold; return "", or the reason for refusing."""
        if self.state.mode is not _HOLD:
            return f"nothing to release: the rig is in {self.state.mode.value}"
        self.state.enter(_RUN, now, why)
        return ""

    def request_stop(self, now: float, why: str, *, fast: bool = False, cool: bool = True) -> None:
        """Begin a controlled (or fast) stop; idempotent. A fast stop under way does not become a slower one.

        ``cool``: the machine keeps turning, unloaded, while it is too hot to stop.
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
            self._begin_stop(now)
        if fast:
            self._begin_fast(now)
            state.enter(_FAST_STOP, now, why)
        elif mode in _WORKING or (mode is _COOLDOWN and state.cooled):
            state.enter(_STOPPING, now, why)

    def request_ack(self, now: float, by: str = "") -> str:
        """Acknowledge a latched trip: IDLE follows once every cause is gone. Return "" or the refusal; idempotent."""
        state = self.state
        if state.mode is not _LATCHED:
            return f"nothing to acknowledge: the rig is in {state.mode.value}"
        if state.ack_until_s < now:
            state.ack_until_s, state.ack_by = now + self._ack_wait_s, by
            self.withdraw_escalation()
        return ""

    def _acknowledge(self, now: float) -> None:
        """Leave LATCHED once no level holds; refuse the acknowledgement if one still holds after ``ack_wait_s``."""
        state, table = self.state, self.table
        holding = (state.held | table.still_there(self.view) & state.tripped) & ~table.warnings
        if not holding:
            state.ack_until_s = -inf
            state.trip = None
            state.tripped = 0
            state.events.append(ControlEvent(now, ACKNOWLEDGED, state.ack_by))
            state.enter(_IDLE, now, "acknowledged")
        elif now > state.ack_until_s:
            state.ack_until_s = -inf
            state.tripped &= ~table.at_rest  # anything still moving or heating trips again
            names = ", ".join(table.names_of(holding))
            state.events.append(ControlEvent(now, "acknowledgement", f"refused, still there: {names}"))

    # -- interlocks -----------------------------------------------------------------------------------------

    def _watch(self, demand: DemandT, readings: ReadingsT, scan_s: float, dt: float) -> None:
        """Evaluate every row of the table: a level that has held for its delay trips."""
        self.look(demand, readings, scan_s, dt)
        now_held = self._rows.held(self.view)
        if now_held or self.state.held:
            self._time(now_held, readings)

    def _time(self, now_held: int, readings: ReadingsT) -> None:
        """Update the time since when each row holds, and trip rows that have held for their delay."""
        state, now, delays = self.state, readings.now_s, self._delays
        pending = state.pending_s
        gone = state.held & ~now_held
        state.held = now_held
        state.tripped &= ~(gone & self.table.warnings)
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

    def _trip(self, i: int, own: int, readings: ReadingsT) -> None:
        """Act on a row whose delay is over: warn, or stop by its reaction. At rest there is little left to stop."""
        state, row, now = self.state, self.table.rows[i], readings.now_s
        if row.reaction is Reaction.WARN:
            state.tripped |= own
            state.events.append(ControlEvent(now, "warning", f"{row.name}: {row.cause}"))
            return
        resting = state.mode in _AT_REST
        if resting and not self._acts_at_rest(row):
            return
        state.tripped |= own
        faults = "; ".join(readings.faults())
        text = row.cause + (f" [{faults}]" if faults else "") + f" ({self.detail(readings)})"
        if state.trip is None:
            compared = row.watch.compared(self.view)
            state.trip = Trip(now, row.name, text, row.reaction, compared)
            state.events.append(ControlEvent(now, "trip", f"{row.name}: {text}"))
        else:
            state.events.append(ControlEvent(now, "alarm", f"{row.name}: {text}"))
        if row.ends_lease:
            self.end_lease(readings)
        if not resting:
            self._react(row.reaction, now, row.name)
        else:
            state.setpoints.power_off = state.setpoints.power_off or row.reaction is Reaction.POWER_OFF
            if state.mode is not _LATCHED:
                state.enter(_LATCHED, now, row.name)

    def _acts_at_rest(self, row: Interlock[Any]) -> bool:
        """Return whether a row trips at rest, because something is on that should be off."""
        return row.at_rest is not None and row.at_rest(self.view)

    def _react(self, reaction: Reaction, now: float, why: str) -> None:
        state, mode = self.state, self.state.mode
        if mode in _WORKING or mode is _COOLDOWN:
            self._begin_stop(now)
        if reaction is Reaction.EMERGENCY:
            if mode is not _EMERGENCY:
                self._begin_fast(now)
                state.enter(_EMERGENCY, now, why)
        elif reaction is Reaction.CONTROLLED:
            if mode in _WORKING:
                state.enter(_STOPPING, now, why)
            elif mode is _COOLDOWN:
                state.stop.creeps = True
        elif mode is not _EMERGENCY:
            self._begin_fast(now)
            if mode is not _FAST_STOP:
                state.enter(_FAST_STOP, now, why)
        if reaction is Reaction.POWER_OFF:
            state.setpoints.power_off = True

    # -- holds and stops ------------------------------------------------------------------------------------

    def _hold(self, readings: ReadingsT, dt: float) -> None:
        """Command the hold's demand; end a hold that lasts too long with a controlled stop."""
        now = readings.now_s
        if now - self.state.mode_since_s > self._hold_at_most_s:
            self.request_stop(now, "held too long")
            self.stop_outputs()
        else:
            self.run_outputs(self._held, readings, dt)

    def _begin_stop(self, now: float) -> None:
        """Record the time at which a stop begins, and the state from which it begins."""
        stop = self.state.stop
        stop.began_s = now
        stop.fast_s = inf
        stop.creeps = False
        self.note_stop()

    def _begin_fast(self, now: float) -> None:
        """Record the time at which a quick stop begins, and the state from which it begins."""
        if self.state.stop.fast_s > now:
            self.state.stop.fast_s = now
            self.note_fast_stop()

    def _after_stop(self, now: float) -> None:
        """Leave a stop that has ended: to the cool-down if one is needed, to LATCHED after a trip, else to IDLE."""
        state = self.state
        hot = self.must_cool() if state.mode is _STOPPING and not state.cooled else ""
        if hot:
            state.enter(_COOLDOWN, now, hot)
            state.stop.creeps = True
            return
        state.stop.began_s = inf
        self.note_rest()
        if state.trip is not None or state.mode is not _STOPPING:
            state.enter(_LATCHED, now, "standstill")
        else:
            state.enter(_IDLE, now, "standstill")
        self.rest_outputs()


AnyControl = Control[Any, Any, Any, Any]
