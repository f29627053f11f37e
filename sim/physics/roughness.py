"""Power spectra of a track's heights: a self-affine law, or a table.

C(q) = (2 pi)^-2 int <h h> exp(-iqx) d2x in m^4, isotropic, q in 1/m; <h^2> = 2 pi int q C dq and the mean square of the
slope is 2 pi int q^3 C dq.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from sim.physics.materials import Sinusoid

if TYPE_CHECKING:
    from sim.physics.materials import Array, Spectrum


@dataclass(frozen=True, slots=True)
class SelfAffine:
    """C = c0 (q / q0)^(-2 (H + 1)) from q0 to q1."""

    c0_m4: float
    q0_1_m: float
    q1_1_m: float
    hurst: float

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        for name in ("c0_m4", "q0_1_m", "q1_1_m"):
            value: float = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"SelfAffine.{name} must be finite and above 0, not {value!r}")
        if self.q1_1_m <= self.q0_1_m:
            raise ValueError(f"SelfAffine.q1_1_m must be above q0_1_m ({self.q0_1_m:g} 1/m), not {self.q1_1_m!r}")
        if not 0.0 <= self.hurst <= 1.0:
            raise ValueError(f"SelfAffine.hurst is 0 to 1, not {self.hurst!r}")

    @property
    def band_1_m(self) -> tuple[float, float]:
        """Return q0 and q1, 1/m."""
        return self.q0_1_m, self.q1_1_m

    def power_m4(self, q_1_m: Array) -> Array:
        """Return C in m^4 at wave numbers of the band."""
        return self.c0_m4 * (np.asarray(q_1_m) / self.q0_1_m) ** self._power

    @property
    def rms_height_m(self) -> float:
        """Return the root of <h^2>, m."""
        return self._root_of_moment(1)

    @property
    def rms_slope(self) -> float:
        """Return the root of the mean-square slope."""
        return self._root_of_moment(3)

    @property
    def _power(self) -> float:
        return -2.0 * (self.hurst + 1.0)

    def _root_of_moment(self, order: int) -> float:
        return _root(self.q0_1_m, self.q1_1_m / self.q0_1_m, self.c0_m4, self._power, order)


class TabulatedSpectrum:
    """Measured C(q), straight between its points in logarithms, and undefined outside them."""

    def __init__(self, q_1_m: Array, power_m4: Array) -> None:
        """Take at least two points. Raises ValueError unless q ascends and all is finite and above 0."""
        q, power = np.array(q_1_m, dtype=np.float64), np.array(power_m4, dtype=np.float64)
        if q.ndim != 1 or q.shape != power.shape or len(q) < 2:
            raise ValueError(f"a spectrum has as many powers as wave numbers, at least 2, not {q.shape}, {power.shape}")
        for name, values in (("wave numbers", q), ("powers", power)):
            if not (np.all(np.isfinite(values)) and np.all(values > 0.0)):
                raise ValueError(f"a spectrum's {name} must be finite and above 0")
        if not np.all(np.diff(q) > 0.0):
            raise ValueError("a spectrum's wave numbers must ascend")
        self._band = float(q[0]), float(q[-1])
        self._log_q, self._log_power = np.log(q), np.log(power)

    def __repr__(self) -> str:
        """Return its content: two spectra of the same text are equal."""
        return f"TabulatedSpectrum({self._log_q.tolist()}, {self._log_power.tolist()})"

    @property
    def band_1_m(self) -> tuple[float, float]:
        """Return q0 and q1, 1/m."""
        return self._band

    def power_m4(self, q_1_m: Array) -> Array:
        """Return C in m^4 at wave numbers of the band."""
        return np.exp(np.interp(np.log(q_1_m), self._log_q, self._log_power))

    @property
    def rms_height_m(self) -> float:
        """Return the root of <h^2>, m."""
        return self._root_of_moment(1)

    @property
    def rms_slope(self) -> float:
        """Return the root of the mean-square slope."""
        return self._root_of_moment(3)

    def _root_of_moment(self, order: int) -> float:
        widths = np.diff(self._log_q)
        powers = np.diff(self._log_power) / widths
        parts = (
            _root(math.exp(q), math.exp(width), math.exp(power), float(exponent), order)
            for q, width, power, exponent in zip(
                self._log_q[:-1], widths, self._log_power[:-1], powers, strict=True
            )
        )
        return math.hypot(*parts)


def _root(q_1_m: float, ratio: float, power_m4: float, exponent: float, order: int) -> float:
    """Return the root of 2 pi int q^order C dq over q to ratio q, for C = power (q / q_1_m)^exponent there."""
    grows = order + exponent + 1.0
    # expm1 keeps its precision where the integrand is nearly 1 / q.
    integral = math.log(ratio) if abs(grows) < 1e-12 else math.expm1(grows * math.log(ratio)) / grows
    return math.sqrt(2.0 * math.pi * power_m4 * q_1_m ** (order + 1) * integral)


SPLIT_M: Final = 0.5e-3
"""Wavelength that divides macrotexture from microtexture (Table 1 of paper G; ISO 13473-1)."""
LEAST_RATIO: Final = 3.0
"""Least ratio of the longest wave to the shortest on either side of the division [A]."""
PLACES: Final = 400
"""Wave numbers at which a part of a spectrum is read for its moments."""


class TwoWaves(NamedTuple):
    """Two waves in the place of a spectrum."""

    coarse: Sinusoid
    fine: Sinusoid
    split_m: float
    """Wavelength that divides the spectrum between them."""


def two_waves(spectrum: Spectrum) -> TwoWaves | None:
    """Return the two waves of a spectrum; None for a band that is too narrow for two.

    The band is divided at 0.5 mm (``SPLIT_M``), or in its middle on a logarithmic scale [A] if one side would be
    narrower than ``LEAST_RATIO``. Each wave has the mean squares of heights and of profile slopes of its side: its
    length is the profile's root-mean-square wavelength 2 pi Rq / Rdq (ISO 4287:1984), its amplitude sqrt(2) Rq, which
    paper G takes for Ra. A profile's mean-square slope is half the surface's.
    """
    q0, q1 = spectrum.band_1_m
    split = 2.0 * math.pi / SPLIT_M
    if not LEAST_RATIO * q0 <= split <= q1 / LEAST_RATIO:
        split = math.sqrt(q0 * q1)
    if min(split / q0, q1 / split) < LEAST_RATIO:
        return None
    return TwoWaves(_one_wave(spectrum, q0, split), _one_wave(spectrum, split, q1), 2.0 * math.pi / split)


def _one_wave(spectrum: Spectrum, low_1_m: float, high_1_m: float) -> Sinusoid:
    """Return the wave of the part of a spectrum between two wave numbers."""
    q = np.geomspace(low_1_m, high_1_m, PLACES)
    q[0], q[-1] = low_1_m, high_1_m
    part = TabulatedSpectrum(q, spectrum.power_m4(q))
    amplitude_m = math.sqrt(2.0) * part.rms_height_m
    return Sinusoid(2.0 * math.pi * amplitude_m / part.rms_slope, amplitude_m)
