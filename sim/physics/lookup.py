"""A friction law as a table, because a simulated rig needs the law's value in every step, within microseconds.

ln mu, and adhesion's share of mu, are cubic B-splines over ln v, -1 / (T + 150 degC) and the root of the load, each in
equal steps. Temperature enters as -1 / (T + 150 degC), because the logarithm of a rubber's WLF shift is nearly linear
in it. Load enters as its root, because friction hardly depends on a light load.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log, sqrt
from typing import TYPE_CHECKING

from sim.physics.materials import Components

if TYPE_CHECKING:
    from sim.physics.laws import LawOfParts

BELOW_C = 150.0
"""Pole of the scale of temperatures, K below 0 degC."""


@dataclass(frozen=True, slots=True)
class TableSpan:
    """Range of a table, from least to most."""

    speeds_m_s: tuple[float, float]
    temperatures_c: tuple[float, float]
    loads_n: tuple[float, float]

    def __post_init__(self) -> None:
        """Raise ValueError unless every span ascends, begins above its pole, and is finite."""
        for name, (low, high), least in (
            ("speeds_m_s", self.speeds_m_s, 0.0),
            ("temperatures_c", self.temperatures_c, -BELOW_C),
            ("loads_n", self.loads_n, 0.0),
        ):
            if not least < low < high < float("inf"):
                raise ValueError(f"TableSpan.{name} ascends from above {least:g}, not {low!r} to {high!r}")


class SplineTable:
    """A cubic B-spline over three axes of equal steps 0, 1, 2 ..., from its coefficients.

    It sums over the third axis, then over the first, and keeps both sums for the next value at the same places: load
    and speed stay the same for thousands of steps while the temperature drifts. All ways give the same bits.
    """

    def __init__(self, rows: list[list[float]], between: int) -> None:
        """Take coefficients along the first axis, row by row: all of the second axis, for each of the third.

        ``between``: number of coefficients along the second axis. Each axis has two more than points.
        """
        self._rows = rows
        self._between = between
        self._x = self._z = -1.0
        self._j = -1
        self._four = (0.0, 0.0, 0.0, 0.0)
        self._weights = (0, 0.0, 0.0, 0.0, 0.0)
        self._plane: list[list[float]] = []

    def value(self, x: float, y: float, z: float) -> float:
        """Return the spline at 0 to points - 1 of every axis."""
        j = int(y)
        if j > self._between - 4:
            j = self._between - 4
        if x != self._x or z != self._z or j != self._j:
            self._move_to(x, j, z)
        q0, q1, q2, q3 = self._four
        t = y - j
        s = 1.0 - t
        tt, ss = t * t, s * s
        return (
            s * ss * q0 + (4.0 - 3.0 * tt * (1.0 + s)) * q1 + (4.0 - 3.0 * ss * (1.0 + t)) * q2 + t * tt * q3
        ) / 216.0

    def _move_to(self, x: float, j: int, z: float) -> None:
        """Calculate the four sums for a value, at places of the first and third axis."""
        if z != self._z:
            self._turn_to(z)
            rows = self._summed(j, j + 4)
        else:
            if not self._plane:
                self._plane = self._summed(0, self._between)
            rows = self._plane[j : j + 4]
        i = min(int(x), len(rows[0]) - 4)
        t = x - i
        s = 1.0 - t
        b1, b2 = 4.0 - 3.0 * t * t * (1.0 + s), 4.0 - 3.0 * s * s * (1.0 + t)
        b0, b3 = s * s * s, t * t * t
        q0, q1, q2, q3 = [b0 * r[i] + b1 * r[i + 1] + b2 * r[i + 2] + b3 * r[i + 3] for r in rows]
        self._x, self._j, self._four = x, j, (q0, q1, q2, q3)

    def _turn_to(self, z: float) -> None:
        """Set the weights of the rows for a coordinate of the third axis."""
        k = min(int(z), len(self._rows) // self._between - 4)
        t = z - k
        s = 1.0 - t
        self._weights = (
            k * self._between, s * s * s, 4.0 - 3.0 * t * t * (1.0 + s), 4.0 - 3.0 * s * s * (1.0 + t), t * t * t,
        )  # fmt: skip
        self._z = z
        self._plane = []

    def _summed(self, first: int, end: int) -> list[list[float]]:
        """Return rows of the second axis, summed over the third."""
        rows, n = self._rows, self._between
        at, c0, c1, c2, c3 = self._weights
        return [
            [
                c0 * p + c1 * q + c2 * r + c3 * s
                for p, q, r, s in zip(rows[i], rows[i + n], rows[i + 2 * n], rows[i + 3 * n], strict=True)
            ]
            for i in range(at + first, at + end)
        ]


class TabulatedLaw:
    """The law as a table; below its least speed and load the values are those at the least speed and load.

    Above its span, and outside its temperatures, the original law is called; ``outside`` counts these calls.
    """

    def __init__(
        self,
        slow: LawOfParts,
        span: TableSpan,
        points: tuple[int, int, int],
        total: SplineTable,
        adhesion: SplineTable,
        error: float,
    ) -> None:
        """Take ln mu and the share of adhesion, with these numbers of points on the axes."""
        self._slow = slow
        self.span = span
        self.points = points
        self.error = error
        """Greatest relative error of the coefficient between the points, as found when the table was made."""
        self.outside = 0
        self._total = total
        self._adhesion = adhesion
        self._v, self._t, self._n = span.speeds_m_s, span.temperatures_c, span.loads_n
        self._x = _axis(log(self._v[0]), log(self._v[1]), points[0])
        self._y = _axis(scale(self._t[0]), scale(self._t[1]), points[1])
        self._z = _axis(load_scale(self._n[0]), load_scale(self._n[1]), points[2])
        self._load_n, self._load = self._n[0], 0.0
        self._slip_m_s, self._speed = self._v[0], 0.0

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient; outside the table, raises the law's own exceptions."""
        # Called in every step of a simulated rig: the steps of ``components`` are written out here.
        low_c, high_c = self._t
        if not (low_c <= temperature_c <= high_c and load_n <= self._n[1] and slip_m_s <= self._v[1]):
            self.outside += 1
            return self._slow.mu(temperature_c, load_n, slip_m_s)
        if load_n != self._load_n:
            self._load_n = load_n
            self._load = (load_scale(max(load_n, self._n[0])) - self._z[0]) * self._z[1]
        if slip_m_s != self._slip_m_s:
            self._slip_m_s = slip_m_s
            self._speed = (log(max(slip_m_s, self._v[0])) - self._x[0]) * self._x[1]
        y0, y_per = self._y
        return exp(self._total.value(self._speed, (-1.0 / (temperature_c + BELOW_C) - y0) * y_per, self._load))

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return adhesion and hysteresis; outside the table, raises the law's own exceptions."""
        if self._beyond(temperature_c, load_n, slip_m_s):
            return self._slow.components(temperature_c, load_n, slip_m_s)
        x, y, z = self._place(temperature_c, load_n, slip_m_s)
        mu = exp(self._total.value(x, y, z))
        share = min(max(self._adhesion.value(x, y, z), 0.0), 1.0)
        return Components(mu * share, mu * (1.0 - share))

    def _beyond(self, temperature_c: float, load_n: float, slip_m_s: float) -> bool:
        low_c, high_c = self._t
        if low_c <= temperature_c <= high_c and load_n <= self._n[1] and slip_m_s <= self._v[1]:
            return False
        self.outside += 1
        return True

    def _place(self, temperature_c: float, load_n: float, slip_m_s: float) -> tuple[float, float, float]:
        x0, x_per = self._x
        y0, y_per = self._y
        z0, z_per = self._z
        return (
            (log(max(slip_m_s, self._v[0])) - x0) * x_per,
            (scale(temperature_c) - y0) * y_per,
            (load_scale(max(load_n, self._n[0])) - z0) * z_per,
        )

    def __deepcopy__(self, memo: dict[int, object]) -> TabulatedLaw:
        """Return itself: the table never changes, and copies of a running rig share it."""
        return self


def _axis(low: float, high: float, points: int) -> tuple[float, float]:
    """Return the begin of an axis, and its points per unit."""
    return low, (points - 1) / (high - low)


def scale(temperature_c: float) -> float:
    """Return the place of a temperature above -150 degC on its axis."""
    return -1.0 / (temperature_c + BELOW_C)


def load_scale(load_n: float) -> float:
    """Return the place of a load on its axis."""
    return sqrt(load_n)
