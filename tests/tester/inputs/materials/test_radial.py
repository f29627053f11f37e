"""The radial spectrum of a map, compared with maps of known spectrum."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.physics.roughness import TabulatedSpectrum, two_waves
from tester.inputs.materials.radial import detrended, radial_spectrum

PIXEL = (1e-6, 1e-6)
Array = NDArray[np.float64]


def self_affine(seed: int, points: int, hurst: float, q0: float, c0: float) -> Array:
    """Return a periodic map with C = c0 (q / q0)^(-2 (1 + H)) from q0 on and random phases."""
    generator = np.random.default_rng(seed)
    length = points * PIXEL[0]
    q = 2.0 * np.pi * np.hypot(np.fft.fftfreq(points, PIXEL[0])[:, None], np.fft.fftfreq(points, PIXEL[0])[None, :])
    power = np.where((q >= q0) & (q <= np.pi / PIXEL[0]), c0 * (np.maximum(q, q0) / q0) ** (-2.0 * (1.0 + hurst)), 0.0)
    noise = np.fft.fft2(generator.normal(size=(points, points))) / points
    return np.fft.ifft2(np.sqrt(power) * 2.0 * np.pi / length * noise * points**2).real


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2])
def test_a_sinusoid_has_its_mean_square_at_its_wave_number(angle: float) -> None:
    amplitude, wavelength = 2e-6, 16e-6
    y, x = np.meshgrid(np.arange(256) * PIXEL[0], np.arange(256) * PIXEL[1], indexing="ij")
    wave = amplitude * np.sin(2.0 * np.pi / wavelength * (x * np.cos(angle) + y * np.sin(angle)))
    spectrum = radial_spectrum(detrended(wave, PIXEL, "mean"), PIXEL)
    assert spectrum.q_1_m[np.argmax(spectrum.power_m4)] == pytest.approx(2.0 * np.pi / wavelength, rel=0.03)
    assert spectrum.rms_height_m**2 == pytest.approx(amplitude**2 / 2.0, rel=0.02)


def test_self_affine_maps_give_their_law_and_their_mean_square() -> None:
    hurst, q0, c0 = 0.8, 2.0 * np.pi / 32e-6, 1e-22
    slopes, levels, squares = [], [], []
    for seed in range(60):
        heights = self_affine(seed, 256, hurst, q0, c0)
        spectrum = radial_spectrum(detrended(heights, PIXEL, "mean"), PIXEL)
        kept = (spectrum.q_1_m > 1.5 * q0) & (spectrum.q_1_m < 0.8 * np.pi / PIXEL[0])
        x, y = np.log(spectrum.q_1_m[kept] / q0), np.log(spectrum.power_m4[kept])
        slope, level = np.polyfit(x, y, 1)
        slopes.append(slope)
        levels.append(np.exp(level) / c0)
        squares.append(spectrum.rms_height_m**2 / np.mean(heights**2))
    assert np.mean(slopes) == pytest.approx(-2.0 * (1.0 + hurst), abs=0.02)
    assert np.mean(levels) == pytest.approx(1.0, abs=0.05)
    assert np.mean(squares) == pytest.approx(1.0, abs=0.03)
    assert max(squares) < 1.2 and min(squares) > 0.8


def test_another_pixel_and_another_shape_change_nothing_of_the_law() -> None:
    heights = self_affine(3, 512, 0.7, 2.0 * np.pi / 64e-6, 1e-22)
    whole = radial_spectrum(detrended(heights, PIXEL, "mean"), PIXEL)
    part = radial_spectrum(detrended(heights[:256, ::2], (1e-6, 2e-6), "mean"), (1e-6, 2e-6))
    q = np.array([2e5, 4e5, 8e5])
    of_whole, of_part = (np.exp(np.interp(np.log(q), np.log(s.q_1_m), np.log(s.power_m4))) for s in (whole, part))
    assert of_part / of_whole == pytest.approx(np.ones(3), abs=0.35)
    assert part.q_1_m[-1] <= np.pi / 2e-6


def test_a_tilt_goes_with_the_plane_alone() -> None:
    y, x = np.meshgrid(np.arange(40.0), np.arange(60.0), indexing="ij")
    tilted = 3.0 * x - 2.0 * y + 7.0
    assert np.abs(detrended(tilted, (1.0, 2.0), "plane")).max() < 1e-9
    assert np.abs(detrended(tilted, (1.0, 2.0), "mean")).max() > 50.0
    assert detrended(tilted, (1.0, 2.0), "mean").mean() == pytest.approx(0.0, abs=1e-9)


def test_small_and_flat_maps_are_refused() -> None:
    with pytest.raises(ValueError, match="15 x 40 heights are too few"):
        radial_spectrum(np.ones((15, 40)), PIXEL)
    with pytest.raises(ValueError, match="all alike"):
        radial_spectrum(np.zeros((32, 32)), PIXEL)


def ringed(
    generator: np.random.Generator, points: int, pixel_m: float, rings: tuple[tuple[float, float], ...]
) -> Array:
    """Return a map of waves in all directions with random phases: length and rms height, m, of each ring."""
    q = np.fft.fftfreq(points, pixel_m)
    length = 1.0 / np.maximum(np.hypot(q[:, None], q[None, :]), 1e-9)
    heights = np.zeros((points, points))
    for wavelength_m, rms_m in rings:
        noise = np.fft.fft2(generator.normal(size=(points, points)))
        part = np.fft.ifft2(np.where(np.abs(length / wavelength_m - 1.0) < 0.1, noise, 0.0)).real
        heights += part * rms_m / float(np.std(part))
    return heights


def test_the_two_waves_of_maps_are_found_in_their_spectra() -> None:
    pixel_m, rings = 20e-6, ((1.28e-3, 100e-6), (160e-6, 10e-6))
    ratios: list[list[float]] = []
    for seed in range(20):
        heights = ringed(np.random.default_rng(seed), 512, pixel_m, rings)
        radial = radial_spectrum(detrended(heights, (pixel_m, pixel_m), "plane"), (pixel_m, pixel_m))
        waves = two_waves(TabulatedSpectrum(radial.q_1_m, radial.power_m4))
        assert waves is not None and waves.split_m == 0.5e-3
        ratios.append([
            value
            for wave, (length_m, rms_m) in zip(waves[:2], rings, strict=True)
            for value in (wave.wavelength_m / (2.0**0.5 * length_m), wave.ra_m / (2.0**0.5 * rms_m))
        ])
    assert np.mean(ratios, axis=0) == pytest.approx(np.ones(4), abs=0.1)  # 20 points a decade do not resolve a ring
    assert np.min(ratios) > 0.7 and np.max(ratios) < 1.4
