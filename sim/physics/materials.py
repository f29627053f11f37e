"""Two materials as laws of friction need them: a rubber's complex modulus and the surface that it slides on.

SI throughout. ``tester.inputs.materials`` reads the files of compounds and surfaces; this module holds what a
calculation needs of them.
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

        Raises ``OutsideError`` where it is not known there.
        """
        ...


class OutsideError(ValueError):
    """A frequency or temperature at which a modulus is not known; the message says up to where it is."""


@dataclass(frozen=True, slots=True)
class Shear:
    """How a contact of clean rubber is sheared off (paper G, Eq 12): tau_s0 [1 + ratio / (1 + v_c / v)^n]."""

    strength_pa: float
    """tau_s0, of slowest sliding."""
    speed_m_s: float
    """v_c"""
    exponent: float
    """n"""
    ratio: float
    """Modulus of the glass over that of the rubber, Einf / E0."""


@dataclass(frozen=True, slots=True)
class Rubber:
    """A compound as laws see it."""

    name: str
    modulus: ShearModulus
    poisson: float = 0.5
    glass_c: float | None = None
    """Glass transition, degC, where it is known."""
    shear: Shear | None = None
    """What its adhesion is made of, where it is known."""
    decade_k: float = 8.0
    """Temperature that stands for a decade of frequency (paper G, Eq 9), K."""


def below_glass(rubber: Rubber, temperature_c: float) -> Iterator[str]:
    """Yield that a compound is a glass at a temperature, of which laws of rubber know nothing."""
    if rubber.glass_c is not None and temperature_c < rubber.glass_c:
        yield f"{temperature_c:g} degC is below the glass transition of {rubber.name}, {rubber.glass_c:g} degC"


class Spectrum(Protocol):
    """Isotropic power spectrum of heights, C(q) = (2 pi)^-2 int <h h> exp(-iqx) d2x: <h^2> = 2 pi int q C dq."""

    @property
    def band_1_m(self) -> tuple[float, float]:
        """Return q0 and q1, the least and the largest wave number, 1/m."""
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
    """A track as laws see it: a spectrum, two waves (coarse, fine), or both."""

    name: str
    spectrum: Spectrum | None = None
    coarse: Sinusoid | None = None
    fine: Sinusoid | None = None


class UnknownMaterialError(ValueError):
    """A compound or a surface of a name that no file has; the message says where was looked."""


class Materials(Protocol):
    """Where laws find what a recipe or a rig file names."""

    def rubber(self, name: str) -> Rubber:
        """Return a compound. Raises UnknownMaterialError, and ValueError where its file has no moduli."""
        ...

    def surface(self, name: str) -> Surface:
        """Return a surface. Raises UnknownMaterialError."""
        ...


@dataclass(frozen=True, slots=True)
class ReadOnce:
    """Materials that ask others for each name once: a law, its table and the table's key see the same content."""

    source: Materials
    _rubbers: dict[str, Rubber] = field(default_factory=dict[str, Rubber])
    _surfaces: dict[str, Surface] = field(default_factory=dict[str, Surface])

    def rubber(self, name: str) -> Rubber:
        """Return a compound. Raises what ``source`` raises."""
        if name not in self._rubbers:
            self._rubbers[name] = self.source.rubber(name)
        return self._rubbers[name]

    def surface(self, name: str) -> Surface:
        """Return a surface. Raises what ``source`` raises."""
        if name not in self._surfaces:
            self._surfaces[name] = self.source.surface(name)
        return self._surfaces[name]


class Components(NamedTuple):
    """A coefficient of friction in its parts."""

    adhesion: float
    hysteresis: float
