"""Spectra of heights: their moments against closed forms and quadrature."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.physics.roughness import SPLIT_M, SelfAffine, TabulatedSpectrum, TwoWaves, two_waves

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


def found(spectrum: SelfAffine | TabulatedSpectrum) -> TwoWaves:
    waves = two_waves(spectrum)
    assert waves is not None
    return waves


def test_two_waves_keep_the_mean_squares_of_heights_and_of_profile_slopes() -> None:
    spectrum = SelfAffine(1e-13, 600.0, 6e4, 0.8)
    coarse, fine, split_m = found(spectrum)
    assert split_m == SPLIT_M == 0.5e-3
    assert 0.5 * (coarse.ra_m**2 + fine.ra_m**2) == pytest.approx(spectrum.rms_height_m**2, rel=1e-9)
    slopes = sum(0.5 * (2.0 * math.pi * wave.ra_m / wave.wavelength_m) ** 2 for wave in (coarse, fine))
    assert slopes == pytest.approx(0.5 * spectrum.rms_slope**2, rel=1e-9)
    # The closed forms of each side.
    for wave, low, high in ((coarse, 600.0, 2.0 * math.pi / split_m), (fine, 2.0 * math.pi / split_m, 6e4)):
        side = SelfAffine(1e-13 * (low / 600.0) ** -3.6, low, high, 0.8)
        assert wave.ra_m == pytest.approx(math.sqrt(2.0) * side.rms_height_m, rel=1e-9)
        assert wave.wavelength_m == pytest.approx(2.0 * math.pi * wave.ra_m / side.rms_slope, rel=1e-9)


def test_waves_of_one_length_in_all_directions_have_a_profile_that_is_longer_by_the_root_of_two() -> None:
    # A narrow ring at 4000 1/m (1.57 mm) and one at 1e5 1/m (63 um), on a floor that counts for nothing.
    q = np.array([1e3, 3.96e3, 3.98e3, 4.02e3, 4.04e3, 0.99e5, 0.995e5, 1.005e5, 1.01e5, 1e6])
    tops = np.array([1e-30, 1e-30, 1e-13, 1e-13, 1e-30, 1e-30, 1e-19, 1e-19, 1e-30, 1e-30])
    coarse, fine, _ = found(TabulatedSpectrum(q, tops))
    assert coarse.wavelength_m == pytest.approx(math.sqrt(2.0) * 2.0 * math.pi / 4e3, rel=0.01)
    assert fine.wavelength_m == pytest.approx(math.sqrt(2.0) * 2.0 * math.pi / 1e5, rel=0.01)


def test_a_band_without_macrotexture_is_divided_in_its_middle_and_a_narrow_one_not_at_all() -> None:
    assert found(ABRASIVE).split_m == pytest.approx(2.0 * math.pi / math.sqrt(2e4 * 10.0**5.344), rel=1e-12)
    # 0.5 mm is inside, but waves from 0.5 to 0.9 mm alone are none.
    assert found(SelfAffine(1e-16, 7e3, 7e5, 0.8)).split_m == pytest.approx(2.0 * math.pi / 7e4, rel=1e-12)
    assert two_waves(SelfAffine(1e-19, 2e4, 1.7e5, 0.8)) is None
