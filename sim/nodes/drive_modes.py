"""The modes of operation of the simulated drive (CiA 402-2): their common parts, and profile velocity.

A mode turns targets and controlword bits into motion of the axis, and the axis' motion into the statusword bits 10,
12 and 13, whose meaning depends on the mode. ``follow`` is called with every new controlword or target while operation
is enabled, ``watch`` after every step of an axis that moves or has bits that wait for a time window.
"""

from __future__ import annotations

from math import inf
from typing import Final, Protocol

from drivers import cia402
from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from sim.nodes.motion import VelocityAxis
from sim.nodes.object_store import Key, ObjectStore

_TARGET_REACHED: Final = cia402.TARGET_REACHED  # bound once, for the mode that is watched in every scan
_UNLIMITED: Final = 0xFFFF_FFFF
ROUNDING_S: Final = 1e-9
_ENABLE: Final = 0x10
_UNLOCK: Final = 0x20
"""Two of the three bits of ``cia402.RAMP``: enable the ramp, and let it follow its reference."""


class Ramps:
    """Values of the drive's ramp and window objects in engineering units; ``load`` reads them."""

    def load(self, store: ObjectStore, config: AxisConfig) -> None:
        """Read the objects, which are in the counts of the configuration."""
        values = store.values
        per = self.velocity_increments = config.velocity_increments
        per_position = config.position_increments or inf
        rate = self.acceleration_counts = config.acceleration_counts
        self.profile_speed_counts = config.profile_speed_counts
        threshold = per * config.drive.units.threshold
        self.acceleration = values[(o.PROFILE_ACCELERATION, 0)] / rate
        self.deceleration = values[(o.PROFILE_DECELERATION, 0)] / rate
        self.quick_stop = values[(o.QUICK_STOP_DECELERATION, 0)] / rate
        if config.drive.inverter:
            self.acceleration = values[(o.VL_ACCELERATION, 1)] / values[(o.VL_ACCELERATION, 2)] / rate
            self.deceleration = values[(o.VL_DECELERATION, 1)] / values[(o.VL_DECELERATION, 2)] / rate
            self.quick_stop = values[(o.VL_QUICK_STOP, 1)] / values[(o.VL_QUICK_STOP, 2)] / rate
        self.halt = self.quick_stop if values[(o.HALT_OPTION, 0)] == 2 else self.deceleration
        greatest = min(values[(o.MAX_MOTOR_SPEED, 0)], values[(o.MAX_PROFILE_VELOCITY, 0)])
        if config.drive.inverter:
            greatest = values[(o.VL_MIN_MAX, 2)]
        self.limit = greatest / config.max_speed_counts
        self.max_slippage = values[(o.MAX_SLIPPAGE, 0)] / per
        self.velocity_window = values[(o.VELOCITY_WINDOW, 0)] / per
        self.velocity_window_s = values[(o.VELOCITY_WINDOW_TIME, 0)] * 1e-3
        self.velocity_threshold = values[(o.VELOCITY_THRESHOLD, 0)] / threshold
        self.velocity_threshold_s = values[(o.VELOCITY_THRESHOLD_TIME, 0)] * 1e-3
        if config.drive.inverter:
            self.velocity_window = self.velocity_threshold = 1.0 / per
        self.position_window = values[(o.POSITION_WINDOW, 0)] / per_position
        self.position_window_s = values[(o.POSITION_WINDOW_TIME, 0)] * 1e-3
        window = values[(o.FOLLOWING_ERROR_WINDOW, 0)]
        self.following_error = inf if window == _UNLIMITED else window / per_position
        self.following_error_s = values[(o.FOLLOWING_ERROR_TIME, 0)] * 1e-3


class Lasting:
    """A condition that is true once it has held for some time."""

    def __init__(self) -> None:
        self.since_s = inf
        self.true = False

    def check(self, condition: bool, hold_s: float, t: float) -> bool:
        """Process the condition at ``t`` s; return whether it has to be checked again."""
        if not condition:
            self.since_s = inf
            self.true = False
            return False
        if self.since_s == inf:
            self.since_s = t
        self.true = t >= self.since_s + hold_s - ROUNDING_S
        return not self.true

    def clear(self) -> None:
        """Start again."""
        self.since_s = inf
        self.true = False


class ModeOwner(Protocol):
    """The drive of a mode."""

    store: ObjectStore
    ramps: Ramps
    homed: bool

    def counts_to_position(self, counts: int) -> float:
        """Return the machine position (unit) of a position in counts."""
        ...

    def set_home(self) -> None:
        """Make the present position the machine home position."""
        ...

    def fault(self, code: int) -> None:
        """Enter the fault reaction."""
        ...


class ProfileVelocity:
    """Mode 3: ramp to 0x60FF. Bit 10 target reached, 11 limit of speed or torque, 12 speed zero, 13 slippage error."""

    def __init__(self, drive: ModeOwner, axis: VelocityAxis) -> None:
        self._drive = drive
        self._axis = axis
        self._target_key: Key = (o.TARGET_VELOCITY, 0)
        self._target: int | None = None
        self._halt = 0
        self._reached_at = inf
        self._zero_at = inf
        self.bits = 0
        self.limited = False
        self.at_torque_limit = False

    def start(self) -> None:
        """Begin when operation is enabled or ramps have changed: the next target counts as new."""
        self._target = None

    def note(self, controlword: int) -> None:
        """Ignore the controlword: nothing in this mode depends on edges."""

    def follow(self, controlword: int, t: float) -> None:
        """Aim at the target velocity, or at standstill during a halt."""
        target = self._drive.store.values[self._target_key]
        halt = controlword & cia402.HALT
        if target == self._target and halt == self._halt:
            return
        self._halt = halt
        ramps = self._drive.ramps
        self._target = None
        if halt:
            self._axis.aim(0.0, deceleration=ramps.halt)
            self.limited = False
        else:
            self._axis.aim(self._axis.target, ramps.acceleration, ramps.deceleration)
            self.retarget(target)

    def retarget(self, target: int) -> None:
        """Aim at a target velocity in counts, on the present ramps."""
        if target == self._target or self._halt:
            return
        self._target = target
        ramps = self._drive.ramps
        speed = target / ramps.velocity_increments
        limit, axis = ramps.limit, self._axis
        if -limit <= speed <= limit:
            self.limited = False
        else:
            self.limited = True
            speed = limit if speed > 0.0 else -limit
        # As ``VelocityAxis.aim``, without the call: targets of the press change with nearly every scan.
        axis.target = speed
        axis.settled = settled = axis.value == speed == axis.demand
        axis.still = settled and speed == 0.0

    def watch(self, t: float, enabled: bool) -> bool:
        """Update the status bits; return whether they may still change without a new target."""
        axis, ramps = self._axis, self._drive.ramps
        value = axis.value
        bits = 0
        waiting = not axis.settled
        if enabled:
            window = ramps.velocity_window
            if -window <= value - axis.target <= window:
                if self._reached_at == inf:
                    self._reached_at = t + ramps.velocity_window_s
                if t >= self._reached_at - ROUNDING_S:
                    bits = _TARGET_REACHED
                else:
                    waiting = True
            else:
                self._reached_at = inf
            slippage = ramps.max_slippage
            if not -slippage <= axis.demand - value <= slippage:
                bits |= cia402.MAX_SLIPPAGE
            if self.limited or self.at_torque_limit:
                bits |= cia402.INTERNAL_LIMIT
        else:
            self._reached_at = inf
        threshold = ramps.velocity_threshold
        if -threshold <= value <= threshold:
            if self._zero_at == inf:
                self._zero_at = t + ramps.velocity_threshold_s
            if t >= self._zero_at - ROUNDING_S:
                bits |= cia402.SPEED_ZERO
            else:
                waiting = True
        else:
            self._zero_at = inf
        self.bits = bits
        return waiting


class InverterVelocity(ProfileVelocity):
    """Mode 2: ramp to 0x6042 with controlword bits 4 to 6 set. Bit 10 target reached, 11 limit of speed or torque.

    Without bit 5 the ramp holds its speed; without bit 6 or bit 4 it leads to standstill (for bit 4 the maker's choice
    [A]).
    """

    def __init__(self, drive: ModeOwner, axis: VelocityAxis) -> None:
        super().__init__(drive, axis)
        self._target_key = (o.VL_TARGET_VELOCITY, 0)
        self._ramp = 0

    def follow(self, controlword: int, t: float) -> None:
        """Act on the ramp's bits, then on the target."""
        ramp = controlword & cia402.RAMP
        if ramp != self._ramp:
            self._ramp = ramp
            self._target = None
        super().follow(controlword, t)

    def retarget(self, target: int) -> None:
        """Aim at a target in counts as far as the ramp's bits allow."""
        if self._ramp == cia402.RAMP:
            super().retarget(target)
        elif self._ramp & _UNLOCK or not self._ramp & _ENABLE:
            super().retarget(0)
        elif not self._halt:
            self._axis.aim(self._axis.demand)

    def watch(self, t: float, enabled: bool) -> bool:
        """Update the status bits: this mode has neither bit 12 nor 13."""
        waiting = super().watch(t, enabled)
        self.bits &= ~(cia402.SPEED_ZERO | cia402.MAX_SLIPPAGE)
        return waiting
