"""Spectra of heights: their moments against closed forms and quadrature."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.physics.roughness import SelfAffine, TabulatedSpectrum

ABRASIVE = SelfAffine(2.6023e-19, 2e4, 10.0**5.344, 0.8)


def test_the_reference_surface_is_20_um_high_with_a_slope_of_1_0272() -> None:
    assert ABRASIVE.rms_height_m == pytest.approx(20e-6, rel=1e-3)
    assert ABRASIVE.rms_slope == pytest.approx(1.0272, rel=1e-4)


def test_a_self_affine_spectrum_falls_with_its_exponent() -> None:
    assert ABRASIVE.power_m4(np.array([2e4, 2e5])) == pytest.approx([2.6023e-19, 2.6023e-19 * 10.0**-3.6], rel=1e-12)
    assert ABRASIVE.band_1_m == (2e4, 10.0**5.344)


@pytest.mark.parametrize("hurst", [0.0, 0.5, 1.0])
def test_moments_are_the_integrals_that_they_stand_for(hurst: float) -> None:
    spectrum = SelfAffine(1e-19, 2e4, 2e6, hurst)
    u = np.linspace(math.log(2e4), math.log(2e6), 20001)
    q = np.exp(u)
    for order, root in ((1, spectrum.rms_height_m), (3, spectrum.rms_slope)):
        integral = 2.0 * math.pi * np.trapezoid(q ** (order + 1) * spectrum.power_m4(q), u)
        assert root**2 == pytest.approx(integral, rel=1e-6)


def test_a_table_of_a_self_affine_spectrum_is_that_spectrum() -> None:
    q = np.geomspace(2e4, 10.0**5.344, 7)
    table = TabulatedSpectrum(q, ABRASIVE.power_m4(q))
    between = np.geomspace(2e4, 10.0**5.344, 50)
    assert table.power_m4(between) == pytest.approx(ABRASIVE.power_m4(between), rel=1e-12)
    assert table.rms_height_m == pytest.approx(ABRASIVE.rms_height_m, rel=1e-12)
    assert table.rms_slope == pytest.approx(ABRASIVE.rms_slope, rel=1e-12)
    assert table.band_1_m == (2e4, q[-1])


@pytest.mark.parametrize(
    ("figures", "message"),
    [
        ((0.0, 2e4, 2e5, 0.8), "c0_m4 must be finite and above 0"),
        ((1e-19, 2e4, 2e4, 0.8), "q1_1_m must be above q0_1_m"),
        ((1e-19, 2e4, 2e5, 1.2), "hurst is 0 to 1"),
    ],
)
def test_figures_of_no_spectrum_are_refused(figures: tuple[float, float, float, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        SelfAffine(*figures)


@pytest.mark.parametrize(
    ("q", "power", "message"),
    [
        ([1e4], [1e-19], "at least 2"),
        ([1e4, 2e4], [1e-19], "as many powers as wave numbers"),
        ([2e4, 1e4], [1e-19, 1e-19], "must ascend"),
        ([1e4, 2e4], [1e-19, 0.0], "powers must be finite and above 0"),
    ],
)
def test_tables_of_no_spectrum_are_refused(q: list[float], power: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        TabulatedSpectrum(np.array(q), np.array(power))
