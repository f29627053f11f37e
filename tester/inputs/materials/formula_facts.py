"""Facts of moduli that are a formula, as those of a sweep: plateaus, peak of tan delta, kelvins a decade."""

from __future__ import annotations

from collections.abc import Iterator
from math import log10, nan
from typing import NamedTuple

import numpy as np

from sim.physics.loss_maxima import loss_maxima
from sim.physics.materials import Rubber
from sim.physics.moduli import FractionalZener

PEAK_HZ = 1.0
"""Frequency of the sweep over the temperature, that of most DMA."""


class FormulaFacts(NamedTuple):
    """Moduli of tension in Pa; the peak of tan delta over the temperature at ``PEAK_HZ``, in degC; kelvins by which it
    moves to the next decade of frequency."""

    rubber_pa: float
    """E0"""
    glass_pa: float
    """Einf"""
    peak_c: float
    peak: float
    decade_k: float


def formula_facts(rubber: Rubber) -> FormulaFacts | None:
    """Return the facts of a compound whose modulus is a fractional Zener solid, None for another."""
    zener = rubber.modulus
    if not isinstance(zener, FractionalZener):
        return None
    tension = 2.0 * (1.0 + rubber.poisson)
    at_ts_hz = loss_maxima(zener, zener.shift_c).loss_factor_hz
    (at,) = zener.complex_pa(np.array([2.0 * np.pi * at_ts_hz]), zener.shift_c)
    place_c, next_c = (_celsius(zener, log10(at_ts_hz / hertz)) for hertz in (PEAK_HZ, 10.0 * PEAK_HZ))
    return FormulaFacts(
        tension * zener.relaxed_pa, tension * zener.glassy_pa, place_c, float(at.imag / at.real), next_c - place_c
    )


def _celsius(zener: FractionalZener, log10_shift: float) -> float:
    """Return the temperature of a shift about Ts, degC; NaN where no temperature has it."""
    return zener.shift_c - zener.c2_k * log10_shift / (zener.c1 + log10_shift) if zener.c1 + log10_shift > 0.0 else nan


def formula_words(facts: FormulaFacts) -> Iterator[tuple[str, str]]:
    """Yield each fact in words, with its label."""
    yield "tan peak", f"{facts.peak:.3g} at {facts.peak_c:.1f} degC, {PEAK_HZ:g} Hz: the Tg of a DMA, by the formula"
    yield "E0", f"{facts.rubber_pa / 1e6:.3g} MPa, by the formula"
    yield "Einf", f"{facts.glass_pa / 1e6:.4g} MPa, by the formula"
    yield "Einf/E0", f"{facts.glass_pa / facts.rubber_pa:.4g}"
    yield "shift", f"{facts.decade_k:.2f} K a decade of frequency, {PEAK_HZ:g} to {10.0 * PEAK_HZ:g} Hz"
