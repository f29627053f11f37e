"""What the rig's sensors make of the truth: a multi-axis load cell, thermometers, encoders.

``noise`` scales every imperfection; at 0 a sensor gives the true value (a thermometer its lagged one), the
load cell within its range. What is constant for a session (linearity, drift, crosstalk, misalignment, bias,
scale) is drawn from the seed alone. Sizes: ``SensorParameters``.
"""

from __future__ import annotations

import math

from sim.noise import NormalStream, uniforms
from sim.parameters import SensorParameters


class LoadCellSensor:
    """Load cell for Fx, Fy, Fz and the moment about the vertical, under the belt's support plate."""

    __slots__ = (
        "_drift_n_k",
        "_matrix",
        "_noisy",
        "_offsets_n",
        "_ranges_n",
        "_reference_c",
        "_sizes",
        "_time_s",
        "_warming",
        "cell_c",
        "noise",
    )

    def __init__(self, sensors: SensorParameters, noise: float, seed: int, ambient_c: float) -> None:
        """Draw the session's imperfections; the zero is that at ambient temperature."""
        draws = uniforms(16, seed, "session cell")
        self._noisy = noise > 0.0
        self._ranges_n = (sensors.range_x, sensors.range_y, sensors.range_z)
        # A parabola through zero and the range's end, farthest off at half range, is a slope that falls with force.
        slopes = [4.0 * noise * sensors.linearity * u for u in draws[0:3]]
        bends = [slope / most for slope, most in zip(slopes, self._ranges_n, strict=True)]
        self._sizes = (*slopes, *bends, noise * sensors.force_rms, noise * sensors.moment_rms)
        self._drift_n_k = tuple(math.copysign(noise * sensors.zero_drift, u) for u in draws[3:6])
        self._offsets_n = (0.0, 0.0, 0.0)
        self._matrix = _coupling(sensors, noise, draws[6:16])
        self._reference_c = ambient_c
        self._time_s = sensors.cell_time
        self._warming = sensors.cell_warming
        self.cell_c = ambient_c
        self.noise = NormalStream(seed, "cell")

    def warm(self, dt_s: float, belt_c: float) -> None:
        """Let the cell follow its share of the belt's excess over ambient for ``dt_s`` (much less than its lag)."""
        goal = self._reference_c + self._warming * (belt_c - self._reference_c)
        self.set_temperature(self.cell_c + (goal - self.cell_c) * dt_s / self._time_s)

    def set_temperature(self, cell_c: float) -> None:
        """Bring the cell to a temperature in degC."""
        self.cell_c = cell_c
        x, y, z = self._drift_n_k
        excess_k = cell_c - self._reference_c
        self._offsets_n = (x * excess_k, y * excess_k, z * excess_k)

    def measure(self, fx: float, fy: float, fz: float, mz: float) -> tuple[float, float, float, float]:
        """Return Fx, Fy, Fz in N, cut off at the ranges, and the moment in N m, as the cell sees them now."""
        xx, xy, xz, yx, yy, yz, zx, zy, zz = self._matrix
        x = xx * fx + xy * fy + xz * fz
        y = yx * fx + yy * fy + yz * fz
        z = zx * fx + zy * fy + zz * fz
        rx, ry, rz = self._ranges_n
        if self._noisy:
            sx, sy, sz, bx, by, bz, rms, moment_rms = self._sizes
            ox, oy, oz = self._offsets_n
            n1, n2, n3, n4 = self.noise.next4()
            x += x * (sx - bx * x if x > 0.0 else sx + bx * x) + ox + rms * n1
            y += y * (sy - by * y if y > 0.0 else sy + by * y) + oy + rms * n2
            z += z * (sz - bz * z if z > 0.0 else sz + bz * z) + oz + rms * n3
            mz += moment_rms * n4
        if -rx < x < rx and -ry < y < ry and -rz < z < rz:
            return x, y, z, mz
        return min(max(x, -rx), rx), min(max(y, -ry), ry), min(max(z, -rz), rz), mz


def _coupling(sensors: SensorParameters, noise: float, draws: list[float]) -> tuple[float, ...]:
    """Return the nine entries, by rows, of the matrix from true to seen forces: misalignment, then crosstalk."""
    least, spread = sensors.misalignment_least, sensors.misalignment_most - sensors.misalignment_least
    about_x, about_y = (
        noise * math.radians(math.copysign(least + spread * abs(size), sign)) for size, sign in (draws[0:2], draws[2:4])
    )
    cx, sx, cy, sy = math.cos(about_x), math.sin(about_x), math.cos(about_y), math.sin(about_y)
    turned = ((cy, 0.0, sy), (sx * sy, cx, -sx * cy), (-cx * sy, sx, cx * cy))
    seen = [noise * sensors.crosstalk * u for u in draws[4:10]]
    mixed = ((1.0, seen[0], seen[1]), (seen[2], 1.0, seen[3]), (seen[4], seen[5], 1.0))
    return tuple(sum(m[k] * turned[k][j] for k in range(3)) for m in mixed for j in range(3))


class TemperatureSensor:
    """A thermometer with a first-order lag, a constant bias and white noise; ``gain`` is its share of a step."""

    __slots__ = ("_bias_k", "_rms_k", "_time_s", "gain", "lagged_c", "noise")

    def __init__(self, time_s: float, rms_k: float, bias_k: float, noise: NormalStream) -> None:
        """Take the sizes as they are to apply (already scaled); reads 0 degC until ``reset``."""
        self._time_s = time_s
        self._rms_k = rms_k
        self._bias_k = bias_k
        self.gain = 0.0
        self.lagged_c = 0.0
        self.noise = noise

    def reset(self, true_c: float) -> None:
        """Settle at a temperature."""
        self.lagged_c = true_c

    def retime(self, dt_s: float) -> None:
        """Set the length of a step in s."""
        self.gain = -math.expm1(-dt_s / self._time_s)

    def follow(self, true_c: float) -> None:
        """Move on by one step at a true temperature."""
        self.lagged_c += (true_c - self.lagged_c) * self.gain

    def measure(self) -> float:
        """Return a reading in degC."""
        if self._rms_k > 0.0:
            return self.lagged_c + self._bias_k + self._rms_k * self.noise.next()
        return self.lagged_c + self._bias_k


class SpeedSensor:
    """An encoder taken for a line speed: an error of scale and white noise."""

    __slots__ = ("_rms_m_s", "factor", "noise")

    def __init__(self, factor: float, rms_m_s: float, noise: NormalStream) -> None:
        """Take ``factor`` = indicated over true speed and the noise as they are to apply (already scaled)."""
        self.factor = factor
        self._rms_m_s = rms_m_s
        self.noise = noise

    def error(self) -> float:
        """Return a number of white noise in m/s."""
        rms_m_s = self._rms_m_s
        if rms_m_s > 0.0:
            for number in self.noise.numbers:
                return rms_m_s * number
            return rms_m_s * self.noise.next()
        return 0.0

    def measure(self, true_m_s: float) -> float:
        """Return a reading in m/s."""
        return true_m_s * self.factor + self.error()
