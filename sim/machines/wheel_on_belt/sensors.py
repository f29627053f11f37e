"""The load cell under the belt, and its readings of the true forces.

``noise`` scales every imperfection; at 0 the cell gives the true value within its range. Numbers that are constant for
a session (sensitivity, linearity, drift, crosstalk, misalignment) depend on the seed alone. Sizes:
``SensorParameters``.
"""

from __future__ import annotations

import math

from sim.noise import NormalStream, uniforms
from sim.physics.parameters import SensorParameters


class LoadCellSensor:
    """Load cell for Fx, Fy, Fz and the moment about the vertical, under the belt's support plate."""

    def __init__(
        self, sensors: SensorParameters, noise: float, seed: int, ambient_c: float, sign: float = 1.0
    ) -> None:
        """Draw the session's imperfections; the zero is that at ambient temperature. ``sign``: -1 reverses them."""
        draws = [sign * u for u in uniforms(16, seed, "session cell")]
        self._noisy = noise > 0.0
        self._ranges_n = (sensors.range_x, sensors.range_y, sensors.range_z)
        # A parabola through zero and the range's end, with most error at half range, is a slope that falls with force.
        slopes = [4.0 * noise * sensors.linearity * u for u in draws[0:3]]
        bends = [slope / most for slope, most in zip(slopes, self._ranges_n, strict=True)]
        self._sizes = (*slopes, *bends, noise * sensors.force_rms, noise * sensors.moment_rms)
        self._drift_n_k = tuple(math.copysign(noise * sensors.zero_drift, u) for u in draws[3:6])
        self._offsets_n = (0.0, 0.0, 0.0)
        self._matrix = _coupling(sensors, noise, draws[6:16])
        if sensors.cell_sensitivity > 0.0:
            self._matrix = _scaled(self._matrix, sign * noise * sensors.cell_sensitivity, seed)
        self._reference_c = ambient_c
        self._time_s = sensors.cell_time
        self._warming = sensors.cell_warming
        self.cell_c = ambient_c
        self.noise = NormalStream(seed, "cell")

    def warm(self, dt_s: float, belt_c: float) -> None:
        """Advance the cell by ``dt_s`` (much less than its lag) towards its share of the belt's excess over ambient."""
        goal = self._reference_c + self._warming * (belt_c - self._reference_c)
        self.set_temperature(self.cell_c + (goal - self.cell_c) * dt_s / self._time_s)

    def set_temperature(self, cell_c: float) -> None:
        """Set the cell's temperature in degC."""
        self.cell_c = cell_c
        x, y, z = self._drift_n_k
        excess_k = cell_c - self._reference_c
        self._offsets_n = (x * excess_k, y * excess_k, z * excess_k)

    def measure(self, fx: float, fy: float, fz: float, mz: float) -> tuple[float, float, float, float]:
        """Return the cell's present readings: Fx, Fy, Fz in N, cut off at the ranges, and the moment in N m."""
        xx, xy, xz, yx, yy, yz, zx, zy, zz = self._matrix
        x = xx * fx + xy * fy + xz * fz
        y = yx * fx + yy * fy + yz * fz
        z = zx * fx + zy * fy + zz * fz
        rx, ry, rz = self._ranges_n
        if self._noisy:
            sx, sy, sz, bx, by, bz, rms, moment_rms = self._sizes
            ox, oy, oz = self._offsets_n
            for n1, n2, n3, n4 in self.noise.fours:  # noqa: B007 - NormalStream says why it is a loop
                break
            else:
                n1, n2, n3, n4 = self.noise.next4()
            x += x * (sx - bx * x if x > 0.0 else sx + bx * x) + ox + rms * n1
            y += y * (sy - by * y if y > 0.0 else sy + by * y) + oy + rms * n2
            z += z * (sz - bz * z if z > 0.0 else sz + bz * z) + oz + rms * n3
            mz += moment_rms * n4
        if -rx < x < rx and -ry < y < ry and -rz < z < rz:
            return x, y, z, mz
        return min(max(x, -rx), rx), min(max(y, -ry), ry), min(max(z, -rz), rz), mz


def _scaled(matrix: tuple[float, ...], most: float, seed: int) -> tuple[float, ...]:
    """Return the matrix with the errors of the channels' sensitivities, from a random stream of their own."""
    gains = [1.0 + most * u for u in uniforms(3, seed, "session cell sensitivity")]
    return tuple(gains[place // 3] * entry for place, entry in enumerate(matrix))


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
