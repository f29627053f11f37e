"""Motion of simulated axes in closed form, exact for any step length.

Units are the axis' engineering units (rad/s, m/s, mm/s or degrees) and seconds; accelerations are unit/s2. A step
is integrated analytically from one corner of the ramp to the next, so the trajectory does not depend on how the
time is cut into ticks.
"""

from __future__ import annotations

from math import copysign, exp, inf, isfinite, sqrt
from typing import Final

SETTLED: Final = 1e-6
"""Difference to the target (axis units) below which a lagging axis is set to its target."""

_ON_TARGET: Final = 1e-9
"""Distance (position units) below which a positioning axis is set to its target."""


def _rate(value: float, name: str) -> float:
    """Return ``value`` when it is a usable acceleration (finite, > 0); raise ValueError otherwise."""
    if not (isfinite(value) and value > 0.0):
        raise ValueError(f"{name} must be finite and above 0, not {value!r}")
    return value


class VelocityAxis:
    """An axis under velocity control: a linear ramp generator followed by a first-order lag.

    ``value`` is the velocity, ``position`` its integral. ``still``: nothing changes until the next
    ``aim``, so a step may be skipped. ``settled``: only the position changes, by ``value`` a second, and ``bounded``:
    it has hard stops, ``low`` and ``high``.
    """

    def __init__(
        self,
        acceleration: float,
        deceleration: float | None = None,
        lag_s: float = 0.0,
        position: float = 0.0,
        low: float = -inf,
        high: float = inf,
    ) -> None:
        """Create an axis at rest; accelerations in unit/s2 (> 0), lag in s (>= 0), stops in position units."""
        self.acceleration = _rate(acceleration, "acceleration")
        self.deceleration = _rate(acceleration if deceleration is None else deceleration, "deceleration")
        self.lag_s = lag_s
        self.position = position
        self.value = 0.0
        self.demand = 0.0
        self.target = 0.0
        self.low = low
        self.high = high
        self.blocked = False
        self.yielded = 0.0
        self.settled = True
        self.still = True
        self.bounded = low > -inf or high < inf

    def aim(
        self, target: float, acceleration: float | None = None, deceleration: float | None = None
    ) -> None:
        """Set the velocity to ramp to, with new ramps (unit/s2, > 0) where given."""
        if acceleration is not None:
            self.acceleration = _rate(acceleration, "acceleration")
        if deceleration is not None:
            self.deceleration = _rate(deceleration, "deceleration")
        self.target = target
        self.settled = settled = self.value == target == self.demand
        self.still = settled and target == 0.0

    def block(self, blocked: bool) -> None:
        """Hold the shaft (True) or free it: a blocked axis is at rest while its demand changes on."""
        self.blocked = blocked
        if blocked:
            self.value = 0.0
        self.settled = False
        self.still = False

    def give_way(self, by: float) -> None:
        """Be off the loop's speed by ``by`` (unit/s) against the motor: the drive is at its limit; 0: follow again."""
        if not self.blocked:
            self.value += self.yielded - by
            self.yielded = by
        self.settled = False
        self.still = False

    def stall(self, position: float) -> None:
        """Stand at ``position``, short of the demand: the drive of the axis is at its limit."""
        self.position = position
        self.value = 0.0
        self.settled = False
        self.still = False

    def step(self, dt: float) -> None:
        """Advance by ``dt`` seconds (>= 0): from corner to corner of the ramp, the value lagging behind the demand."""
        position = self.position
        if self.settled:
            self.position = position = position + self.value * dt
            if self.bounded and not self.low <= position <= self.high:
                self._hit_stop()
            return
        target, demand, lag = self.target, self.demand, self.lag_s
        yielded, value = self.yielded, self.value
        if yielded:
            value, position = value + yielded, position - yielded * dt
        while dt > 0.0 and demand != target:
            end, rate = target, self.acceleration
            if demand * target < 0.0:
                end, rate = 0.0, self.deceleration
            elif rate != self.deceleration and abs(target) < abs(demand):
                rate = self.deceleration
            slope = rate if end > demand else -rate
            span = (end - demand) / slope
            if span > dt:
                span = dt
                end = demand + slope * dt
            if lag > 0.0:
                behind = slope * lag
                remainder = value - demand + behind
                decay = exp(-span / lag)
                value = end - behind + remainder * decay
                position += (0.5 * (demand + end) - behind) * span + remainder * lag * (1.0 - decay)
            else:
                value = end
                position += 0.5 * (demand + end) * span
            demand = end
            dt -= span
        if dt > 0.0:  # at the target the ramp is level
            if lag > 0.0:
                remainder, decay = value - target, exp(-dt / lag)
                value = target + remainder * decay
                position += target * dt + remainder * lag * (1.0 - decay)
            else:
                value = target
                position += target * dt
        self.demand = demand
        if self.blocked:
            value = self.yielded = 0.0
        else:
            self.position = position
        if yielded:
            value -= self.yielded
        elif demand == target and -SETTLED <= value - target <= SETTLED:
            value = target
            self.settled = True
            self.still = target == 0.0
        self.value = value
        if self.bounded and not self.low <= self.position <= self.high:
            self._hit_stop()

    def _hit_stop(self) -> None:
        """Rest against the hard stop that was overrun; only a new target moves the axis away again."""
        outward = 1.0 if self.position > self.high else -1.0
        self.position = min(max(self.position, self.low), self.high)
        if self.value * outward > 0.0:
            self.value = 0.0
            self.demand = 0.0
        if self.target * outward >= 0.0:
            self.settled = True
            self.still = True
        else:
            self.settled = False
            self.still = False


class PositionAxis:
    """An axis under position control: trapezoidal moves, retargeted on the fly.

    ``value`` is the velocity, ``position`` the position, ``demand`` the position of the trajectory. ``still``: the axis
    rests at its target. Moves are ``bounded`` by it, and never ``settled``.
    """

    def __init__(
        self, max_speed: float, acceleration: float, deceleration: float | None = None, position: float = 0.0
    ) -> None:
        """Create an axis at rest at ``position``; speed in unit/s and accelerations in unit/s2, all > 0."""
        self.max_speed = _rate(max_speed, "max_speed")
        self.acceleration = _rate(acceleration, "acceleration")
        self.deceleration = _rate(acceleration if deceleration is None else deceleration, "deceleration")
        self.position = position
        self.demand = position
        self.value = 0.0
        self._speed = 0.0
        self.target = position
        self.blocked = self.settled = False
        self.bounded = self.still = True
        self._stopping = False

    def move(
        self, target: float, max_speed: float, acceleration: float | None = None, deceleration: float | None = None
    ) -> None:
        """Travel to ``target`` from the present motion; with a speed of 0 the axis stays where it would stop."""
        if acceleration is not None:
            self.acceleration = _rate(acceleration, "acceleration")
        if deceleration is not None:
            self.deceleration = _rate(deceleration, "deceleration")
        if max_speed <= 0.0:
            self.stop(self.deceleration)
            return
        self.max_speed = max_speed
        self.target = target
        self._stopping = False
        self.still = self._speed == 0.0 and self.demand == target

    def stop(self, deceleration: float) -> None:
        """Ramp down to standstill with ``deceleration`` (unit/s2, > 0) and stay there."""
        self.deceleration = _rate(deceleration, "deceleration")
        self._stopping = True
        self.still = self._speed == 0.0
        if self.still:
            self.target = self.demand

    def block(self, blocked: bool) -> None:
        """Hold the shaft (True) while its trajectory continues, or free it: it then starts from its position."""
        self.blocked = blocked
        if blocked:
            self.value = 0.0
        else:
            self.demand = self.position
            self._speed = 0.0
        self.still = False

    def step(self, dt: float) -> None:
        """Advance by ``dt`` seconds (>= 0)."""
        while dt > 0.0 and not self.still:
            dt -= self._leg(dt)
        if not self.blocked:
            self.position = self.demand
            self.value = self._speed

    def _leg(self, dt: float) -> float:
        """Move through at most one leg (speed up, cruise, brake) of the trapezoid; return the seconds used."""
        value = self._speed
        if self._stopping:
            return self._to_rest(value, self.deceleration, dt, arrive=False)
        distance = self.target - self.demand
        if abs(distance) <= _ON_TARGET and abs(value) <= _ON_TARGET:
            self._arrive()
            return dt
        way = copysign(1.0, distance)
        speed = value * way
        if speed < 0.0:
            return self._to_rest(value, self.deceleration, dt, arrive=False)
        distance *= way
        braking = speed * speed / (2.0 * self.deceleration)
        spare = distance - braking
        if spare <= _ON_TARGET:
            # Within rounding of the braking point, use the rate that ends exactly on the target.
            exact = distance > 0.0 and spare >= -_ON_TARGET - 1e-6 * distance
            rate = speed * speed / (2.0 * distance) if exact else self.deceleration
            return self._to_rest(value, rate, dt, arrive=exact)
        if speed > self.max_speed:
            return self._change(speed, self.max_speed, self.deceleration, way, dt)
        if speed < self.max_speed:
            return self._speed_up(speed, distance, way, dt)
        used = min(dt, spare / speed)
        self.demand += value * used
        return used

    def _speed_up(self, speed: float, distance: float, way: float, dt: float) -> float:
        """Accelerate towards the speed limit or the top of a triangular move; return the seconds used."""
        up, down = 0.5 / self.acceleration, 0.5 / self.deceleration
        peak = sqrt((distance + speed * speed * up) / (up + down))
        return self._change(speed, min(peak, self.max_speed), self.acceleration, way, dt)

    def _change(self, speed: float, goal: float, rate: float, way: float, dt: float) -> float:
        """Change the speed along ``way`` linearly to ``goal``; return the seconds used."""
        duration = abs(goal - speed) / rate
        if duration > dt:
            reached = speed + copysign(rate, goal - speed) * dt
            duration = dt
        else:
            reached = goal
        self.demand += way * 0.5 * (speed + reached) * duration
        self._speed = way * reached
        return duration

    def _to_rest(self, value: float, rate: float, dt: float, *, arrive: bool) -> float:
        """Brake with ``rate``; at standstill arrive on the target, or rest after a commanded stop."""
        duration = abs(value) / rate
        if duration > dt:
            reached = value - copysign(rate, value) * dt
            self.demand += 0.5 * (value + reached) * dt
            self._speed = reached
            return dt
        self.demand += 0.5 * value * duration
        self._speed = 0.0
        if arrive:
            self._arrive()
        elif self._stopping:
            self.target = self.demand
            self.still = True
        return duration

    def _arrive(self) -> None:
        self.demand = self.target
        self._speed = 0.0
        self.still = True
