"""Packaged rubbers, surfaces and laws for the checks of the papers' items."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from math import log10
from typing import Final

import numpy as np

import recipes
from sim.physics.greta import Greta
from sim.physics.materials import Rubber, ShearModulus, Spectrum, Surface
from sim.physics.persson import PerssonLaw
from sim.physics.roughness import SelfAffine
from tester.base.arrays import Array, Complex
from tester.inputs.materials.library import Library

ROOM_C: Final = 20.0
PRESSURE_PA: Final = 1e5
SPEEDS_M_S: Final = np.logspace(-6.0, 2.0, 81)


@cache
def rubber(name: str) -> Rubber:
    """Return a packaged compound with its moduli."""
    return Library([recipes.FOLDER]).rubber(name)


@cache
def surface(name: str) -> Surface:
    """Return a packaged surface."""
    return Library([recipes.FOLDER]).surface(name)


def spectrum(name: str) -> SelfAffine:
    """Return the spectrum of a packaged self-affine surface."""
    result = surface(name).spectrum
    assert isinstance(result, SelfAffine)
    return result


@dataclass(frozen=True, slots=True)
class Stiffer:
    """A modulus whose storage part is ``storage`` times another's, and whose loss part is ``loss`` times."""

    of: ShearModulus
    storage: float
    loss: float = 1.0

    def complex_pa(self, rate_rad_s: Array, temperature_c: float) -> Complex:
        """Return G* in Pa."""
        result = self.of.complex_pa(rate_rad_s, temperature_c)
        return self.storage * result.real + 1j * self.loss * result.imag


def persson_over_speed(
    modulus: ShearModulus, rough: Spectrum, pressure_pa: float = PRESSURE_PA, celsius: float = ROOM_C
) -> Array:
    """Return the hysteresis at ``SPEEDS_M_S``."""
    law = PerssonLaw(modulus, 0.5, rough)
    return np.array([law.contact(celsius, pressure_pa, float(v)).mu for v in SPEEDS_M_S])


def peak(mu: Array) -> tuple[float, float]:
    """Return the largest coefficient and log10 of its speed in m/s, from a parabola through the peak."""
    i = int(np.clip(np.argmax(mu), 1, len(mu) - 2))
    a, b, c = mu[i - 1 : i + 2].tolist()
    bend = a - 2.0 * b + c
    off = 0.5 * (a - c) / bend if bend else 0.0
    step = log10(float(SPEEDS_M_S[1] / SPEEDS_M_S[0]))
    return float(b - 0.25 * (a - c) * off), log10(float(SPEEDS_M_S[i])) + off * step


def smoother(name: str, factor: float) -> SelfAffine:
    """Return the spectrum of a surface with a smaller q1."""
    whole = spectrum(name)
    return replace(whole, q1_1_m=factor * whole.q1_1_m)


@cache
def tread_on_road() -> Greta:
    """Return the law greta of the packaged tread on the packaged road."""
    return Greta(rubber("tread"), surface("road"))


def load_n(pressure_pa: float, law: Greta) -> float:
    """Return the load that makes a pressure."""
    return pressure_pa * 1e-6 * law.parameters.area
