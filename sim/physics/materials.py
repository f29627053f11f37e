"""The two materials of a law of friction: a rubber's complex modulus, and the surface that it slides on.

SI units throughout. ``tester.inputs.materials`` reads the files of compounds and surfaces; this module holds their
data for calculations.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Complex = NDArray[np.complex128]


class ShearModulus(Protocol):
    """The complex shear modulus G*(omega, T) of a rubber in small strain."""

    def complex_pa(self, rate_rad_s: Array, temperature_c: float) -> Complex:
        """Return G* in Pa at angular frequencies above 0 rad/s (any shape) and a temperature in degC.

        Raises ``OutsideError`` if it is not known there.
        """
        ...


class OutsideError(ValueError):
    """A frequency or temperature at which a modulus is not known; the message states the known range."""


@dataclass(frozen=True, slots=True)
class Shear:
    """Shear strength of a contact of clean rubber (paper G, Eq 12): tau_s0 [1 + ratio / (1 + v_c / v)^n]."""

    strength_pa: float
    """tau_s0, at the slowest sliding."""
    speed_m_s: float
    """v_c"""
    exponent: float
    """n"""
    ratio: float
    """Ratio of the modulus of the glass to that of the rubber, Einf / E0."""


@dataclass(frozen=True, slots=True)
class Rubber:
    """A compound for laws of friction."""

    name: str
    modulus: ShearModulus
    poisson: float = 0.5
    glass_c: float | None = None
    """Glass transition, degC, if known."""
    shear: Shear | None = None
    """Shear strength for its adhesion, if known."""
    decade_k: float = 8.0
    """Kelvins equivalent to a decade of frequency (paper G, Eq 9)."""


def below_glass(rubber: Rubber, temperature_c: float) -> Iterator[str]:
    """Yield a warning if a compound is a glass at a temperature: laws of rubber do not cover this."""
    if rubber.glass_c is not None and temperature_c < rubber.glass_c:
        yield f"{temperature_c:g} degC is below the glass transition of {rubber.name}, {rubber.glass_c:g} degC"


class Spectrum(Protocol):
    """Isotropic power spectrum of heights, C(q) = (2 pi)^-2 int <h h> exp(-iqx) d2x: <h^2> = 2 pi int q C dq."""

    @property
    def band_1_m(self) -> tuple[float, float]:
        """Return q0 and q1, the least and the largest wave number, 1/m."""
        ...

    @property
    def rms_height_m(self) -> float:
        """Return the root of <h^2>, m."""
        ...

    @property
    def rms_slope(self) -> float:
        """Return the root of the mean-square slope."""
        ...

    def power_m4(self, q_1_m: Array) -> Array:
        """Return C in m^4 at wave numbers within the band."""
        ...


@dataclass(frozen=True, slots=True)
class Sinusoid:
    """A wave of a surface: its length and arithmetic mean roughness Ra, m (paper G takes Ra for the amplitude)."""

    wavelength_m: float
    ra_m: float


@dataclass(frozen=True, slots=True)
class Surface:
    """A track for laws of friction: a spectrum, two waves (coarse, fine), or both."""

    name: str
    spectrum: Spectrum | None = None
    coarse: Sinusoid | None = None
    fine: Sinusoid | None = None
    split_m: float | None = None
    """Wavelength that divided the spectrum between the two waves; None where its file states the waves."""


class UnknownMaterialError(ValueError):
    """A name of a compound or a surface without a file; the message names the places searched."""


class Materials(Protocol):
    """Source of the compounds and surfaces that a recipe or a rig file names."""

    def rubber(self, name: str) -> Rubber:
        """Return a compound. Raises UnknownMaterialError, and ValueError if its file has no moduli."""
        ...

    def surface(self, name: str) -> Surface:
        """Return a surface. Raises UnknownMaterialError."""
        ...


@dataclass(frozen=True, slots=True)
class ReadOnce:
    """Materials that read each name once from a source: a law, its table and the table's key see the same content."""

    source: Materials
    _rubbers: dict[str, Rubber] = field(default_factory=dict[str, Rubber])
    _surfaces: dict[str, Surface] = field(default_factory=dict[str, Surface])

    def rubber(self, name: str) -> Rubber:
        """Return a compound. Raises the exceptions of ``source``."""
        if name not in self._rubbers:
            self._rubbers[name] = self.source.rubber(name)
        return self._rubbers[name]

    def surface(self, name: str) -> Surface:
        """Return a surface. Raises the exceptions of ``source``."""
        if name not in self._surfaces:
            self._surfaces[name] = self.source.surface(name)
        return self._surfaces[name]


class Components(NamedTuple):
    """The two parts of a coefficient of friction."""

    adhesion: float
    hysteresis: float


def length_text(length_m: float) -> str:
    """Return a length above 0 with three digits, in mm, um or nm."""
    unit, scale = ("mm", 1e3) if length_m >= 0.9995e-3 else ("um", 1e6) if length_m >= 0.9995e-6 else ("nm", 1e9)
    return f"{scale * length_m:.3g} {unit}"
