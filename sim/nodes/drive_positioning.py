"""Profile position and homing of the simulated drive (CiA 402-2)."""

from __future__ import annotations

from typing import Final

from drivers import cia402
from drivers.canopen import objects as o
from sim.nodes.drive_modes import Lasting, ModeOwner
from sim.nodes.motion import PositionAxis

FOLLOWING_ERROR_CODE: Final = 0x8611
_RELATIVE: Final = 0x0040
_HERE: Final = frozenset((33, 34, 35, 37))
"""Homing methods that take the present position (CiA 402-2, 8.2: index pulse, current position)."""


class ProfilePosition:
    """Mode 1: trapezoidal moves to 0x607A by the set-point handshake of bits 4, 5 and 12.

    Bit 10 target reached, 12 set-point acknowledged, 13 following error (a fault, 0x8611).
    """

    def __init__(self, drive: ModeOwner, axis: PositionAxis) -> None:
        self._drive = drive
        self._axis = axis
        self._target: float | None = None
        self._buffered: float | None = None
        self._new = False
        self._acknowledged = False
        self._halt = False
        self._reached = Lasting()
        self._late = Lasting()
        self.bits = 0
        self.limited = False

    def start(self) -> None:
        """Begin when operation is enabled: the axis holds its position until a set-point comes."""
        self._target = None
        self._buffered = None
        self._halt = False
        self._reached.clear()
        if not self._axis.still:
            self._axis.stop(self._drive.ramps.deceleration)

    def note(self, controlword: int) -> None:
        """Record the new-set-point bit while it has no effect: only a later edge counts."""
        self._new = bool(controlword & cia402.NEW_SET_POINT)
        self._acknowledged = self._new and self._acknowledged

    def follow(self, controlword: int, t: float) -> None:
        """Accept a set-point on the rising edge of bit 4; pause while bit 8 is set."""
        new = bool(controlword & cia402.NEW_SET_POINT)
        if new and not self._new:
            self._take(bool(controlword & cia402.CHANGE_IMMEDIATELY), bool(controlword & _RELATIVE))
        elif not new and self._buffered is None:
            self._acknowledged = False
        self._new = new
        halt = bool(controlword & cia402.HALT)
        if halt != self._halt:
            self._halt = halt
            if halt:
                self._axis.stop(self._drive.ramps.halt)
            elif self._target is not None:
                self._go(self._target)

    def watch(self, t: float, enabled: bool) -> bool:
        """Update the status bits and continue with a buffered set-point; return whether something may still change."""
        axis, ramps = self._axis, self._drive.ramps
        if enabled and axis.still and self._buffered is not None and not self._halt:
            self._go(self._buffered)
            self._buffered = None
            self._acknowledged = self._new
        holding = self._halt or self._target is None
        goal = axis.position if self._halt or self._target is None else self._target
        near = enabled and axis.still and abs(goal - axis.position) <= ramps.position_window
        waiting = self._reached.check(near, 0.0 if holding else ramps.position_window_s, t)
        late = enabled and abs(axis.demand - axis.position) > ramps.following_error
        waiting |= self._late.check(late, ramps.following_error_s, t)
        bits = cia402.TARGET_REACHED if self._reached.true else 0
        if self._acknowledged:
            bits |= cia402.SET_POINT_ACKNOWLEDGED
        if self._late.true:
            bits |= cia402.FOLLOWING_ERROR
        if enabled and self.limited:
            bits |= cia402.INTERNAL_LIMIT
        self.bits = bits
        if self._late.true and enabled:
            self._drive.fault(FOLLOWING_ERROR_CODE)
        return waiting or not axis.still

    def _take(self, immediately: bool, relative: bool) -> None:
        drive = self._drive
        counts = drive.store.values[(o.TARGET_POSITION, 0)]
        target = self._clamp(counts)
        if relative:
            base = self._axis.target if self._target is None else self._target
            target = base + drive.counts_to_position(counts) - drive.counts_to_position(0)
        self._acknowledged = True
        if immediately or self._axis.still or self._target is None:
            self._buffered = None
            self._go(target)
        else:
            self._buffered = target

    def _clamp(self, counts: int) -> float:
        values = self._drive.store.values
        low, high = values[(o.SOFTWARE_LIMIT, 1)], values[(o.SOFTWARE_LIMIT, 2)]
        inside = min(max(counts, low), high) if low < high else counts
        self.limited = inside != counts
        return self._drive.counts_to_position(inside)

    def _go(self, target: float) -> None:
        ramps = self._drive.ramps
        self._target = target
        self._reached.clear()
        speed = self._drive.store.values[(o.PROFILE_VELOCITY, 0)] / ramps.profile_speed_counts
        if not self._halt:
            self._axis.move(target, min(speed, ramps.limit), ramps.acceleration, ramps.deceleration)


class Homing:
    """Mode 6: bit 4 starts. Bit 10 standstill, 12 homing attained, 13 homing error.

    The home switch is at ``home_position`` of the axis and is approached once, at 0x6099:01. With ``switch_works``
    false the axis runs a tenth of a unit past it and reports the error.
    """

    def __init__(self, drive: ModeOwner, axis: PositionAxis, home_position: float) -> None:
        self._drive = drive
        self._axis = axis
        self.home_position = home_position
        self.switch_works = True
        self._running = False
        self._failed = False
        self._start = False
        self.bits = 0

    def start(self) -> None:
        """Begin when operation is enabled: nothing moves before bit 4 rises."""
        self._running = False
        if not self._axis.still:
            self._axis.stop(self._drive.ramps.deceleration)

    def note(self, controlword: int) -> None:
        """Record the start bit while it has no effect: only a later edge counts."""
        self._start = bool(controlword & cia402.HOMING_START)
        self._running = False

    def follow(self, controlword: int, t: float) -> None:
        """Start on the rising edge of bit 4; interrupt when it falls or bit 8 is set."""
        start = bool(controlword & cia402.HOMING_START)
        if start and not self._start:
            self._begin()
        elif self._running and (not start or controlword & cia402.HALT):
            self._running = False
            self._axis.stop(self._drive.ramps.halt)
        self._start = start

    def watch(self, t: float, enabled: bool) -> bool:
        """Update the status bits; return whether the axis is still moving home."""
        axis = self._axis
        self._running = self._running and enabled  # a stop on the way does not attain home
        if self._running and axis.still:
            self._running = False
            if self.switch_works:
                self._drive.set_home()
            else:
                self._failed = True
        bits = cia402.TARGET_REACHED if axis.still and not self._running else 0
        if self._failed:
            bits |= cia402.HOMING_ERROR
        elif self._drive.homed and not self._running:
            bits |= cia402.HOMING_ATTAINED
        self.bits = bits
        return not axis.still or self._running

    def _begin(self) -> None:
        drive, axis = self._drive, self._axis
        values = drive.store.values
        drive.homed = False
        self._failed = False
        self._running = True
        if values[(o.HOMING_METHOD, 0)] in _HERE:
            return
        ramps = drive.ramps
        acceleration = values[(o.HOMING_ACCELERATION, 0)] / ramps.acceleration_counts
        speed = min(values[(o.HOMING_SPEED, 1)] / ramps.profile_speed_counts, ramps.limit)
        goal = self.home_position if self.switch_works else self.home_position - 0.1
        axis.move(goal, speed, acceleration, acceleration)
