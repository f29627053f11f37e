"""Stress under a wave: against closed forms, and against the whole field added up."""

from __future__ import annotations

from math import asin, exp, pi, sqrt
from typing import TYPE_CHECKING

import numpy as np
import pytest

from sim.physics.scratch import FADE, Scratch, harmonics, normal_x, normal_z, shear_x, shear_z

if TYPE_CHECKING:
    from sim.physics.materials import Array

WAVE_M, TREAD_M = 9.9e-3, 10e-3


def squares_m(scratch: Scratch, share: float, friction: float) -> float:
    normal, shear = scratch.parts_m(share)
    return normal + friction**2 * shear


def pressure(share: float, points: int) -> Array:
    """Return Westergaard's pressure over a wave length from its crest on, in shares of its mean, which is 1."""
    x = np.arange(points) / points
    if share >= 1.0:
        return 1.0 + np.cos(2.0 * pi * x) / share
    found = np.abs(np.cos(pi * x)) * np.sqrt(np.clip(share - np.sin(pi * x) ** 2, 0.0, None))
    return found / float(np.mean(found))


def field(share: float, friction: float, x: Array, z: Array, count: int = 100) -> tuple[Array, Array, Array]:
    """Return sx, sy, sz over p at all x (first axis) and z, m, without the mean pressure: harmonic by harmonic."""
    sx, sy, sz = (np.zeros((len(x), len(z))) for _ in range(3))
    for n, height in enumerate(harmonics(share, count), start=1):
        k = 2.0 * pi * n / WAVE_M
        cos, sin = np.cos(k * x)[:, None], np.sin(k * x)[:, None]
        u = (k * z)[None, :]
        sx += height * (-normal_x(u) * cos + friction * shear_x(u) * sin)
        sz += height * (-normal_z(u) * cos + friction * shear_z(u) * sin)
        sy += -height * normal_x(u) * cos
    return sx, sy, sz


@pytest.mark.parametrize(("share", "friction"), [(0.1214, 0.0), (0.1214, 0.677), (0.9, 1.0), (3.0, 0.5)])
def test_the_separate_sums_are_the_volume_integral_of_the_whole_field(share: float, friction: float) -> None:
    x, z = np.arange(400) * WAVE_M / 400, np.linspace(0.0, TREAD_M, 50)
    t, weights = np.polynomial.legendre.leggauss(200)
    squares = sum(np.square(one) for one in field(share, friction, x, z))
    full = np.asarray(squares)[:, None, :] * ((1.0 - t**2) ** 2)[None, :, None]
    over_y = np.einsum("xyz,y->xz", full, 0.5 * weights)
    brute = float(np.sum(0.5 * (over_y[:, 1:] + over_y[:, :-1]) * np.diff(z)) / len(x))
    assert squares_m(Scratch(WAVE_M, TREAD_M), share, friction) == pytest.approx(brute, rel=1e-10)


def test_at_the_surface_the_rubber_is_pressed_as_hard_in_every_direction() -> None:
    x = np.arange(200) * WAVE_M / 200
    sx, sy, sz = (one[:, 0] for one in field(0.1214, 0.0, x, np.zeros(1)))
    n = np.arange(1, 101)
    expected = -np.cos(2.0 * pi * np.outer(x / WAVE_M, n)) @ harmonics(0.1214, 100)
    for found in (sx, sy, sz):
        assert np.max(np.abs(found - expected)) < 1e-12


@pytest.mark.parametrize("share", [0.01, 0.1214, 0.7, 1.0, 5.0])
def test_the_harmonics_are_those_of_westergaards_pressure(share: float) -> None:
    points = 200_000
    expected = 2.0 * np.fft.rfft(pressure(share, points)).real[1:101] / points
    assert harmonics(share, 100) == pytest.approx(expected, abs=1e-6)


def test_partial_contact_becomes_full_contact_without_a_jump() -> None:
    assert harmonics(1.0 - 1e-9, 100) == pytest.approx(harmonics(1.0, 100), abs=1e-6)


def test_the_parts_of_hysteresis_change_smoothly_with_the_pressure() -> None:
    scratch = Scratch(WAVE_M, TREAD_M)
    shares = np.geomspace(0.01, 0.9, 400)
    logs = np.log([squares_m(scratch, float(share), 0.5) for share in shares])
    assert np.max(np.abs(np.diff(logs, 3))) < 1e-4


def test_from_full_contact_on_the_cycled_part_of_the_stress_does_not_grow() -> None:
    scratch = Scratch(WAVE_M, TREAD_M)
    assert 16.0 * squares_m(scratch, 4.0, 0.5) == pytest.approx(squares_m(scratch, 1.0, 0.5), rel=1e-9)


def test_a_narrow_contact_is_that_of_hertz() -> None:
    share, count = 1e-3, 20000
    half_width_m = WAVE_M / pi * asin(sqrt(share))
    z = np.linspace(0.5, 1.1, 301) * half_width_m
    sx, _, sz = field(share, 0.0, np.zeros(1), z, count)
    shear = 0.5 * np.abs(sx - sz)[0] / (1.0 + float(np.sum(harmonics(share, count))))
    deepest = int(np.argmax(shear))
    assert float(shear[deepest]) == pytest.approx(0.3, rel=2e-3)
    assert z[deepest] / half_width_m == pytest.approx(0.786, rel=1e-2)


def closed(share: float, friction: float) -> float:
    """Return the integral over depths without number: int u^n e^-2u du by parts."""

    def squares(a: float, b: float, c: float, end: float) -> float:
        """Return int of (a + b u + c u^2) e^-2u from 0 to ``end``."""
        gone = exp(-2.0 * end)
        of_1, of_u = 0.5 * (1.0 - gone), 0.25 * (1.0 - (1.0 + 2.0 * end) * gone)
        return a * of_1 + b * of_u + c * 0.25 * (1.0 - (1.0 + 2.0 * end + 2.0 * end * end) * gone)

    total = 0.0
    for n, height in enumerate(harmonics(share, 1000), start=1):
        k = 2.0 * pi * n / WAVE_M
        normal = squares(3.0, -2.0, 3.0, k * TREAD_M)  # (1 + u)^2 + 2 (1 - u)^2
        shear = squares(4.0, -4.0, 2.0, k * TREAD_M)  # (2 - u)^2 + u^2
        total += 0.5 * height**2 * (normal + friction**2 * shear) / k
    return FADE * total


def test_finer_grids_come_down_to_the_closed_form() -> None:
    exact = closed(0.1214, 0.677)
    off = [
        squares_m(Scratch(WAVE_M, TREAD_M, count, depths), 0.1214, 0.677) / exact - 1.0
        for count, depths in ((25, 25), (100, 50), (200, 100), (400, 400))
    ]
    assert off[0] > off[1] > off[2] > off[3] > 0.0
    assert off[1] == pytest.approx(0.021, abs=0.002) and off[3] < 1e-3


@pytest.mark.parametrize(
    ("length_m", "depth_m", "count", "depths"), [(0.0, 0.01, 100, 50), (0.01, -1.0, 100, 50), (0.01, 0.01, 0, 50)]
)
def test_invalid_grids_are_refused(length_m: float, depth_m: float, count: int, depths: int) -> None:
    with pytest.raises(ValueError, match=r"above 0 m|1 harmonic"):
        Scratch(length_m, depth_m, count, depths)
