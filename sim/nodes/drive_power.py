"""The power side of a simulated CiA 402 drive: state machine, ramps to standstill, faults, lost connections.

``commanded`` returns the next state for a controlword; the class applies the transitions to the axis.
"""

from __future__ import annotations

from typing import Final

from drivers import cia402
from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.cia402 import State
from sim.nodes.canopen_device import CanopenDevice
from sim.nodes.drive_modes import ProfileVelocity, Ramps
from sim.nodes.drive_positioning import Homing, ProfilePosition
from sim.nodes.motion import PositionAxis, VelocityAxis
from sim.nodes.object_store import ObjectStore
from sim.nodes.safety_io import SafetyIo
from sim.wires.can_wire import CanWire

Axis = VelocityAxis | PositionAxis
DriveMode = ProfileVelocity | ProfilePosition | Homing

CONNECTION_ERROR: Final = 0x8100
"""EMCY code for the end of a connection without a lost heartbeat (CiA 301: communication, generic)."""

_OUTPUTS: Final = (o.DIGITAL_OUTPUTS, 1)
_HOLDING: Final = 5
"""Least quick stop option that stays in QUICK_STOP_ACTIVE at standstill."""

ENERGISED = frozenset((State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE, State.FAULT_REACTION))
"""States in which the power stage drives the motor."""

FAULTY = frozenset((State.FAULT_REACTION, State.FAULT))


class DrivePower(CanopenDevice):
    """A device with a power stage on an axis; see ``cia402_slave.Cia402Slave``.

    ``watching``: its status may change without a command, so it must be advanced.
    """

    __slots__ = (
        "_causes", "_controlword", "_leaving", "_steady", "axis", "coast_deceleration", "config", "encoder_error", "io",
        "local", "mode", "modes", "origin", "ramps", "state", "statusword", "torque_gain", "torque_nm",
        "torque_off", "torque_offset_nm", "unpowered_velocity", "watching",
    )  # fmt: skip

    def __init__(
        self,
        config: AxisConfig,
        wire: CanWire,
        store: ObjectStore,
        axis: Axis,
        boot_s: float,
        turnaround_s: float,
        now: float,
    ) -> None:
        """Put a drive on the wire, unpowered, its axis at rest."""
        super().__init__(wire, store, boot_s, turnaround_s, now)
        self.config = config
        self.axis = axis
        self.io = SafetyIo() if config.digital_io else None
        self.origin = 0.0
        self.statusword = 0
        self.torque_nm = 0.0
        self.encoder_error = 0.0
        self.torque_gain = 1.0
        self.torque_offset_nm = 0.0
        self.state = State.NOT_READY
        self.mode: DriveMode | None = None
        self.modes: dict[int, DriveMode] = {}
        self.ramps = Ramps()
        self.torque_off = False
        self.local = False
        self.unpowered_velocity = 0.0
        self.coast_deceleration = axis.deceleration
        self._causes: list[int] = []
        self._controlword = 0
        self._leaving: State | None = None  # state after a ramp down
        self._steady = False  # nothing but the target can be new in the next process data
        self.watching = False  # status bits may change with time

    def update(self, t: float) -> None:
        """Compose the statusword."""

    @property
    def energised(self) -> bool:
        """Return whether the power stage is on, so that the drive can give torque."""
        return self.state in ENERGISED

    def reload_ramps(self) -> None:
        """Read ramp and window objects; a move under way continues with them."""
        self.ramps.load(self.store, self.config)
        if isinstance(self.mode, ProfileVelocity):
            self.mode.start()

    # surroundings of the drive -------------------------------------------------------------------------------

    def fault(self, code: int, persistent: bool = False) -> None:
        """Enter the fault reaction with an EMCY code (0x1000..0xFFFF) at the present time.

        A ``persistent`` cause refuses every fault reset until ``clear_cause``, and is found again after a reboot. A
        drive without power or in its self-test notices no other fault.
        """
        if persistent and code not in self._causes:
            self._causes.append(code)
        if self.state is State.NOT_READY:
            return
        t = self.now_s
        values = self.store.values
        values[(o.ERROR_CODE, 0)] = code
        if self.state not in FAULTY:
            self._react(State.FAULT, values[(o.FAULT_REACTION_OPTION, 0)], State.FAULT_REACTION)
        self.error(code, t)

    def clear_cause(self, code: int) -> None:
        """Remove the cause of a persistent fault; the fault stays until it is reset."""
        if code in self._causes:
            self._causes.remove(code)

    def set_torque_off(self, off: bool) -> None:
        """Open (True) or close the safe-torque-off input: open, the power stage has no supply and the axis coasts."""
        self.torque_off = off
        if off and self.state not in FAULTY and self.state is not State.NOT_READY:
            self._power_stage_off(State.SWITCH_ON_DISABLED)
        self.pdos.refresh()
        self.update(self.now_s)

    def set_local(self, local: bool) -> None:
        """Put the drive under local control (its own keypad): it ignores the bus and clears bit 9."""
        self.local = local
        self._steady = False
        self.pdos.refresh()
        self.update(self.now_s)

    # state machine -------------------------------------------------------------------------------------------

    def _command(self, controlword: int, t: float) -> None:
        """Run the power state machine as far as this controlword allows."""
        rising = controlword & ~self._controlword
        self._controlword = controlword
        if self.state is State.FAULT:
            if rising & cia402.FAULT_RESET and not self._causes:
                self.state = State.SWITCH_ON_DISABLED
                self.store.values[(o.ERROR_CODE, 0)] = 0
                self.emergencies.remove_all(t)
            return
        stop_may_end = self.store.values[(o.QUICK_STOP_OPTION, 0)] >= _HOLDING
        for _ in range(2):  # READY_TO_SWITCH_ON to OPERATION_ENABLED is one command (transitions 3 and 4)
            wanted = commanded(self.state, controlword, stop_may_end)
            if wanted is self.state:
                if wanted is State.OPERATION_ENABLED and self._leaving is not None:
                    self._enable()
                return
            self._transit(wanted)

    def _transit(self, wanted: State) -> None:
        """Perform one commanded transition."""
        if self.torque_off and wanted is not State.SWITCH_ON_DISABLED:
            return
        values = self.store.values
        if wanted is State.OPERATION_ENABLED:
            self.state = wanted
            self._enable()
        elif self.state not in ENERGISED:
            self.state = wanted
        elif wanted is State.QUICK_STOP_ACTIVE:
            self._react(State.SWITCH_ON_DISABLED, values[(o.QUICK_STOP_OPTION, 0)], wanted)
        elif wanted is State.SWITCHED_ON:
            self._react(wanted, values[(o.DISABLE_OPERATION_OPTION, 0)], self.state)
        elif wanted is State.READY_TO_SWITCH_ON:
            self._react(wanted, values[(o.SHUTDOWN_OPTION, 0)], self.state)
        else:
            self._power_stage_off(wanted)

    def _react(self, end: State, option: int, meanwhile: State) -> None:
        """Leave operation for ``end`` by an option code: 0 coasts at once, 1/5 slow down ramp, 2/6 quick stop ramp.

        The drive shows ``meanwhile`` on the ramp; with 5 and 6 it stays in that state, energised, at standstill.
        """
        if option == 0 or self.state not in ENERGISED:
            self._power_stage_off(end)
            return
        if self._leaving is end and self.state is meanwhile:
            return
        self.state = meanwhile
        self._leaving = end
        self._steady = False
        self.watching = True
        self._decelerate(self.ramps.deceleration if option in (1, _HOLDING) else self.ramps.quick_stop)
        if self._at_rest():
            self._arrived_at_rest()

    def _at_rest(self) -> bool:
        """Return whether the ramp has ended and the speed is below the zero speed threshold (0x606F)."""
        axis = self.axis
        if isinstance(axis, PositionAxis):
            return axis.still
        return axis.demand == 0.0 and abs(axis.value) <= self.ramps.velocity_threshold

    def _decelerate(self, rate: float) -> None:
        axis = self.axis
        if isinstance(axis, VelocityAxis):
            axis.aim(0.0, deceleration=rate)
        else:
            axis.stop(rate)

    def _arrived_at_rest(self) -> None:
        """End the ramp down: power off, unless the quick stop option holds the axis."""
        end = self._leaving
        self._leaving = None
        held = (
            self.state is State.QUICK_STOP_ACTIVE and self.store.values[(o.QUICK_STOP_OPTION, 0)] >= _HOLDING
        )
        if end is not None and not held:
            self._power_stage_off(end)

    def _enable(self) -> None:
        """Start the mode that drives the axis; without a mode the axis is held."""
        self._leaving = None
        self.watching = True
        if self.mode is not None:
            self.mode.start()
        else:
            self._decelerate(self.ramps.deceleration)

    def _power_stage_off(self, state: State) -> None:
        """Remove the torque: the axis coasts, or follows an external pull."""
        self.state = state
        self._leaving = None
        self._steady = False
        self.watching = True
        # The next controlword acts in the new state even if its bytes are those of the last one.
        self.pdos.refresh()
        axis = self.axis
        if isinstance(axis, VelocityAxis):
            axis.aim(self.unpowered_velocity, self.coast_deceleration, self.coast_deceleration)
        else:
            axis.stop(self.coast_deceleration)

    def select_mode(self, code: int) -> bool:
        """Change the mode of operation while the axis is at rest; return whether the requested mode is in force."""
        mode = self.modes.get(code)
        if mode is self.mode:
            return True
        if not self.axis.still:
            return False
        self.mode = mode
        self._steady = False
        self.watching = True
        if mode is not None:
            mode.note(self._controlword)
            mode.start()
        return True

    @property
    def mode_display(self) -> int:
        """The mode in force, 0x6061; 0 for none."""
        for code, mode in self.modes.items():
            if mode is self.mode:
                return code
        return 0

    # communication -------------------------------------------------------------------------------------------

    def _connection_lost(self, t: float) -> None:
        """React to a lost connection by 0x6007; only a drive that is switched on reacts."""
        self._drop_outputs(t)
        state = self.state
        option = self.store.values[(o.ABORT_CONNECTION_OPTION, 0)]
        if option == 0:
            return
        if state in (State.READY_TO_SWITCH_ON, State.SWITCHED_ON):
            self._power_stage_off(State.SWITCH_ON_DISABLED)
        elif state in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE):
            if option == 1:
                present = self.emergencies.present
                self.now_s = max(self.now_s, t)
                self.fault(present[-1] if present else CONNECTION_ERROR)
            elif option == 2:
                self._power_stage_off(State.SWITCH_ON_DISABLED)
            elif state is State.OPERATION_ENABLED:
                self._transit(State.QUICK_STOP_ACTIVE)
        self.update(t)

    def _left_operational(self, t: float) -> None:
        self._drop_outputs(t)

    def _drop_outputs(self, t: float) -> None:
        """Switch the digital outputs off: no master controls them [A]."""
        self.store.values[_OUTPUTS] = 0
        self._switch_outputs(0, t)

    def _switch_outputs(self, word: int, t: float) -> None:
        if self.io is not None and self.io.set_outputs(word, t):
            self.reschedule()

    def error(self, code: int, t: float) -> None:
        """Report an error by EMCY, register and history; outside a fault it shows as the warning bit."""
        super().error(code, t)
        self.update(t)

    def recovered(self, code: int, t: float) -> None:
        """Report that an error has gone, unless it is the cause of the drive's fault."""
        if self.state in FAULTY and self.store.values[(o.ERROR_CODE, 0)] == code:
            return
        super().recovered(code, t)
        self.update(t)


def commanded(state: State, controlword: int, stop_may_end: bool = False) -> State:
    """Return the next state for a controlword (0..0xFFFF); ``state`` itself if it commands no transition.

    ``stop_may_end``: quick stop option 5-8, from which operation may be enabled again (transition 16). Only the
    rising edge of bit 7 leaves a fault state; this function sees levels and not edges.
    """
    if state in FAULTY or state is State.NOT_READY:
        return state
    if not controlword & 0x02:  # disable voltage
        return State.SWITCH_ON_DISABLED
    if not controlword & 0x04:  # quick stop
        if state is State.OPERATION_ENABLED or state is State.QUICK_STOP_ACTIVE:
            return State.QUICK_STOP_ACTIVE
        return State.SWITCH_ON_DISABLED
    command = controlword & 0x0F
    if state is State.QUICK_STOP_ACTIVE:
        return State.OPERATION_ENABLED if stop_may_end and command == 0x0F else state
    if not command & 0x01:  # shutdown
        return State.READY_TO_SWITCH_ON
    if state is State.SWITCH_ON_DISABLED:
        return state
    if state is State.READY_TO_SWITCH_ON:
        return State.SWITCHED_ON
    return State.OPERATION_ENABLED if command == 0x0F else State.SWITCHED_ON
