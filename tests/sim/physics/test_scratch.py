"""Stress under a wave: against closed forms, and against the whole field added up."""

from __future__ import annotations

from math import asin, exp, pi, sqrt
from typing import TYPE_CHECKING

import numpy as np
import pytest

from sim.physics.scratch import FADE, Scratch, normal_x, normal_z, pressure, shear_x, shear_z

if TYPE_CHECKING:
    from sim.physics.materials import Array

WAVE_M, TREAD_M = 9.9e-3, 10e-3


def squares_m(scratch: Scratch, share: float, friction: float) -> float:
    normal, shear = scratch.parts_m(share)
    return normal + friction**2 * shear


def harmonics(share: float, points: int) -> Array:
    found = np.fft.rfft(pressure(share, points)).real[1:] / points
    found[:-1] *= 2.0
    return found


def field(share: float, friction: float, x: Array, z: Array, points: int = 200) -> tuple[Array, Array, Array]:
    """Return sx, sy, sz over p at all x (first axis) and z, m, without the mean pressure: harmonic by harmonic."""
    sx, sy, sz = (np.zeros((len(x), len(z))) for _ in range(3))
    for n, height in enumerate(harmonics(share, points), start=1):
        k = 2.0 * pi * n / WAVE_M
        cos, sin = np.cos(k * x)[:, None], np.sin(k * x)[:, None]
        if n == points // 2:
            sin = 0.0 * sin  # of the shortest harmonic the points see no sine
        u = (k * z)[None, :]
        sx += height * (-normal_x(u) * cos + friction * shear_x(u) * sin)
        sz += height * (-normal_z(u) * cos + friction * shear_z(u) * sin)
        sy += -height * normal_x(u) * cos
    return sx, sy, sz


@pytest.mark.parametrize(("share", "friction"), [(0.1214, 0.0), (0.1214, 0.677), (0.9, 1.0), (3.0, 0.5)])
def test_the_separate_sums_are_the_volume_integral_of_the_whole_field(share: float, friction: float) -> None:
    x, z = np.arange(200) * WAVE_M / 200, np.linspace(0.0, TREAD_M, 50)
    t, weights = np.polynomial.legendre.leggauss(200)
    squares = sum(np.square(one) for one in field(share, friction, x, z))
    full = np.asarray(squares)[:, None, :] * ((1.0 - t**2) ** 2)[None, :, None]
    over_y = np.einsum("xyz,y->xz", full, 0.5 * weights)
    brute = float(np.sum(0.5 * (over_y[:, 1:] + over_y[:, :-1]) * np.diff(z)) / len(x))
    assert squares_m(Scratch(WAVE_M, TREAD_M), share, friction) == pytest.approx(brute, rel=1e-10)


def test_at_the_surface_the_rubber_is_pressed_as_hard_in_every_direction() -> None:
    x = np.arange(200) * WAVE_M / 200
    sx, sy, sz = (one[:, 0] for one in field(0.1214, 0.0, x, np.zeros(1)))
    expected = 1.0 - pressure(0.1214)
    for found in (sx, sy, sz):
        assert np.max(np.abs(found - expected)) < 1e-12


@pytest.mark.parametrize("share", [0.01, 0.1214, 0.7, 1.0, 5.0])
def test_the_mean_of_the_pressure_is_1(share: float) -> None:
    assert float(np.mean(pressure(share))) == pytest.approx(1.0, abs=1e-12)


def test_the_pressure_is_westergaards() -> None:
    share, points = 0.1214, 20000
    x = np.arange(points) / points
    inside = np.minimum(x, 1.0 - x) < asin(sqrt(share)) / pi
    root = np.sqrt(np.clip(share - np.sin(pi * x) ** 2, 0.0, None))
    expected = np.where(inside, 2.0 * np.abs(np.cos(pi * x)) / share * root, 0.0)
    assert pressure(share, points) == pytest.approx(expected, rel=1e-4)


def test_partial_contact_becomes_full_contact_without_a_jump() -> None:
    assert pressure(1.0 - 1e-9) == pytest.approx(pressure(1.0), abs=1e-3)


def test_from_full_contact_on_the_cycled_part_of_the_stress_does_not_grow() -> None:
    scratch = Scratch(WAVE_M, TREAD_M)
    assert 16.0 * squares_m(scratch, 4.0, 0.5) == pytest.approx(squares_m(scratch, 1.0, 0.5), rel=1e-9)


def test_a_narrow_contact_is_that_of_hertz() -> None:
    share, points = 1e-3, 40000
    half_width_m = WAVE_M / pi * asin(sqrt(share))
    z = np.linspace(0.5, 1.1, 301) * half_width_m
    sx, _, sz = field(share, 0.0, np.zeros(1), z, points)
    shear = 0.5 * np.abs(sx - sz)[0] / float(pressure(share, points)[0])
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
    for n, height in enumerate(harmonics(share, 2000), start=1):
        k = 2.0 * pi * n / WAVE_M
        normal = squares(3.0, -2.0, 3.0, k * TREAD_M)  # (1 + u)^2 + 2 (1 - u)^2
        shear = squares(4.0, -4.0, 2.0, k * TREAD_M)  # (2 - u)^2 + u^2
        total += 0.5 * height**2 * (normal + friction**2 * shear) / k
    return FADE * total


def test_finer_grids_come_down_to_the_closed_form() -> None:
    exact = closed(0.1214, 0.677)
    off = [
        squares_m(Scratch(WAVE_M, TREAD_M, points, depths), 0.1214, 0.677) / exact - 1.0
        for points, depths in ((50, 25), (200, 50), (400, 100), (800, 400))
    ]
    assert off[0] > off[1] > off[2] > off[3] > 0.0
    assert off[1] == pytest.approx(0.021, abs=0.002) and off[3] < 1e-3


@pytest.mark.parametrize(
    ("length_m", "depth_m", "points", "depths"), [(0.0, 0.01, 200, 50), (0.01, -1.0, 200, 50), (0.01, 0.01, 201, 50)]
)
def test_what_is_no_grid_is_refused(length_m: float, depth_m: float, points: int, depths: int) -> None:
    with pytest.raises(ValueError, match=r"above 0 m|an even number"):
        Scratch(length_m, depth_m, points, depths)
