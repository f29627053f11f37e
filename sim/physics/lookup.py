"""A law of friction as a table: what a simulated rig is told in every step, within microseconds.

ln mu, and adhesion's share of mu, are cubic B-splines over ln v, -1 / (T + 150 degC) and ln load, each in equal steps.
The second is nearly straight in the logarithm of a rubber's shift of time by temperature.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log
from typing import TYPE_CHECKING

from sim.physics.materials import Components

if TYPE_CHECKING:
    from sim.physics.laws import LawOfParts

BELOW_C = 150.0
"""So far below 0 degC the scale of temperatures has its pole."""


@dataclass(frozen=True, slots=True)
class TableSpan:
    """What a table reaches over, from least to most."""

    speeds_m_s: tuple[float, float]
    temperatures_c: tuple[float, float]
    loads_n: tuple[float, float]

    def __post_init__(self) -> None:
        """Raise ValueError unless every span ascends, from above its pole on, and is finite."""
        for name, (low, high), least in (
            ("speeds_m_s", self.speeds_m_s, 0.0),
            ("temperatures_c", self.temperatures_c, -BELOW_C),
            ("loads_n", self.loads_n, 0.0),
        ):
            if not least < low < high < float("inf"):
                raise ValueError(f"TableSpan.{name} ascends from above {least:g}, not {low!r} to {high!r}")


class SplineTable:
    """A cubic B-spline over three axes of equal steps 0, 1, 2 ..., from its coefficients."""

    __slots__ = ("_between", "_rows")

    def __init__(self, rows: list[list[float]], between: int) -> None:
        """Take coefficients along the first axis, row by row: all of the second axis, for each of the third.

        ``between``: coefficients along the second axis. Each axis has two more than it has points.
        """
        self._rows = rows
        self._between = between

    def value(self, x: float, y: float, z: float) -> float:
        """Return the spline at 0 to points - 1 of every axis."""
        rows = self._rows
        i = int(x)
        last = len(rows[0]) - 4
        if i > last:
            i = last
        t = x - i
        s = 1.0 - t
        a0, a3 = s * s * s, t * t * t
        a1, a2 = 4.0 - 3.0 * t * t * (1.0 + s), 4.0 - 3.0 * s * s * (1.0 + t)

        j = int(y)
        last = self._between - 4
        if j > last:
            j = last
        t = y - j
        s = 1.0 - t
        b0, b3 = s * s * s, t * t * t
        b1, b2 = 4.0 - 3.0 * t * t * (1.0 + s), 4.0 - 3.0 * s * s * (1.0 + t)

        k = int(z)
        last = len(rows) // self._between - 4
        if k > last:
            k = last
        t = z - k
        s = 1.0 - t
        c0, c3 = s * s * s, t * t * t
        c1, c2 = 4.0 - 3.0 * t * t * (1.0 + s), 4.0 - 3.0 * s * s * (1.0 + t)

        total = 0.0
        at = k * self._between + j
        for weight in (c0, c1, c2, c3):
            r = rows[at]
            inner = b0 * (a0 * r[i] + a1 * r[i + 1] + a2 * r[i + 2] + a3 * r[i + 3])
            r = rows[at + 1]
            inner += b1 * (a0 * r[i] + a1 * r[i + 1] + a2 * r[i + 2] + a3 * r[i + 3])
            r = rows[at + 2]
            inner += b2 * (a0 * r[i] + a1 * r[i + 1] + a2 * r[i + 2] + a3 * r[i + 3])
            r = rows[at + 3]
            inner += b3 * (a0 * r[i] + a1 * r[i + 1] + a2 * r[i + 2] + a3 * r[i + 3])
            total += weight * inner
            at += self._between
        return total / 216.0


class TabulatedLaw:
    """The law; below its least speed and load it is that of these.

    Above its span, and outside its temperatures, the law that it stands for is asked, which ``outside`` counts.
    """

    __slots__ = ("_adhesion", "_at", "_per", "_slow", "_total", "error", "outside", "points", "span")

    def __init__(
        self,
        slow: LawOfParts,
        span: TableSpan,
        points: tuple[int, int, int],
        total: SplineTable,
        adhesion: SplineTable,
        error: float,
    ) -> None:
        """Take ln mu and the share of adhesion, at so many points of every axis."""
        self._slow = slow
        self.span = span
        self.points = points
        self.error = error
        """Greatest relative error of the coefficient that was found off the points when the table was made."""
        self.outside = 0
        self._total = total
        self._adhesion = adhesion
        ends = [
            (log(span.speeds_m_s[0]), log(span.speeds_m_s[1])),
            (scale(span.temperatures_c[0]), scale(span.temperatures_c[1])),
            (log(span.loads_n[0]), log(span.loads_n[1])),
        ]
        self._at = [low for low, _ in ends]
        self._per = [(count - 1) / (high - low) for (low, high), count in zip(ends, points, strict=True)]

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient; outside the table, raises what the law itself raises."""
        if self._beyond(temperature_c, load_n, slip_m_s):
            return self._slow.mu(temperature_c, load_n, slip_m_s)
        return exp(self._total.value(*self._place(temperature_c, load_n, slip_m_s)))

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return adhesion and hysteresis; outside the table, raises what the law itself raises."""
        if self._beyond(temperature_c, load_n, slip_m_s):
            return self._slow.components(temperature_c, load_n, slip_m_s)
        x, y, z = self._place(temperature_c, load_n, slip_m_s)
        mu = exp(self._total.value(x, y, z))
        share = min(max(self._adhesion.value(x, y, z), 0.0), 1.0)
        return Components(mu * share, mu * (1.0 - share))

    def _beyond(self, temperature_c: float, load_n: float, slip_m_s: float) -> bool:
        span = self.span
        low_c, high_c = span.temperatures_c
        if low_c <= temperature_c <= high_c and load_n <= span.loads_n[1] and slip_m_s <= span.speeds_m_s[1]:
            return False
        self.outside += 1
        return True

    def _place(self, temperature_c: float, load_n: float, slip_m_s: float) -> tuple[float, float, float]:
        span, at, per = self.span, self._at, self._per
        slip, load = max(slip_m_s, span.speeds_m_s[0]), max(load_n, span.loads_n[0])
        return (log(slip) - at[0]) * per[0], (scale(temperature_c) - at[1]) * per[1], (log(load) - at[2]) * per[2]

    def __deepcopy__(self, memo: dict[int, object]) -> TabulatedLaw:
        """Return itself: the table never changes, and copies of a running rig share it."""
        return self


def scale(temperature_c: float) -> float:
    """Return the place of a temperature above -150 degC on its axis."""
    return -1.0 / (temperature_c + BELOW_C)
