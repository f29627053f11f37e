"""Complex moduli, against their equations and against the law behind a table."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.physics.materials import OutsideError
from sim.physics.moduli import ConstantModulus, DmaRow, FractionalZener, MonotoneCubic, TabulatedModulus
from sim.physics.wlf import PoleError, log10_shift

ZENER = FractionalZener(1e6, 1e9, 1e-6, 0.6, -3.0)
"""An SBR-like rubber."""


def sweep(decade_k: float = 8.0, f0_hz: float = 1.0) -> list[DmaRow]:
    """Return a sweep of temperature with a loss peak, a row each 2 K."""
    rows: list[DmaRow] = []
    for temperature_c in np.arange(-80.0, 81.0, 2.0):
        storage = 7e6 * (2e9 / 7e6) ** (1.0 / (1.0 + math.exp((temperature_c + 25.0) / 6.0)))
        tan_delta = 0.12 + 0.55 * math.exp(-(((temperature_c + 15.0) / 18.0) ** 2))
        rows.append(DmaRow(float(temperature_c), f0_hz, storage, storage * tan_delta))
    return rows


def grid(noise: float = 0.0) -> list[DmaRow]:
    """Return 1 to 100 Hz at -40 to 60 degC of ``ZENER``."""
    random = np.random.default_rng(1)
    rows: list[DmaRow] = []
    for temperature_c in range(-40, 61, 5):
        for frequency_hz in np.geomspace(1.0, 100.0, 9):
            young = 3.0 * complex(ZENER.complex_pa(np.array([2.0 * math.pi * frequency_hz]), temperature_c)[0])
            a, b = 1.0 + noise * random.standard_normal(2)
            rows.append(DmaRow(temperature_c, float(frequency_hz), young.real * a, young.imag * b))
    return rows


def test_a_constant_modulus_is_the_same_everywhere() -> None:
    modulus = ConstantModulus(1e6, 0.3)
    for temperature_c in (-100.0, 20.0):
        assert np.all(modulus.complex_pa(np.array([[1e-9, 1.0, 1e12]]), temperature_c) == 1e6 + 3e5j)


def test_the_zener_solid_follows_its_equation() -> None:
    rate = np.array([1e-3, 1.0, 1e6, 1e9])
    z = (1j * rate * 1e-6) ** 0.6
    expected = 1e6 + (1e9 - 1e6) * z / (1.0 + z)
    assert ZENER.complex_pa(rate, 20.0) == pytest.approx(expected, rel=1e-12)


def test_the_zener_solids_loss_factor_peaks_at_1_240() -> None:
    # By omega tau = (Gr / Gg)^(1 / 2b): 3162 rad/s.
    rate = np.geomspace(1e1, 1e6, 5001)
    g = ZENER.complex_pa(rate, 20.0)
    tan_delta = g.imag / g.real
    assert np.max(tan_delta) == pytest.approx(1.240, abs=5e-4)
    assert rate[np.argmax(tan_delta)] == pytest.approx(3162.3, rel=5e-3)


@pytest.mark.parametrize("temperature_c", [-40.0, 0.0, 60.0])
def test_a_temperature_shifts_the_zener_solid_along_frequency(temperature_c: float) -> None:
    rate = np.geomspace(1e-3, 1e6, 10)
    factor = 10.0 ** (log10_shift(temperature_c, -3.0) - log10_shift(20.0, -3.0))
    assert ZENER.complex_pa(rate, temperature_c) == pytest.approx(ZENER.complex_pa(rate * factor, 20.0), rel=1e-12)


def test_the_zener_solid_is_refused_at_the_pole_of_its_shift() -> None:
    with pytest.raises(PoleError):
        ZENER.complex_pa(np.array([1.0]), -104.5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"relaxed_pa": 0.0}, "relaxed_pa must be finite and above 0"),
        ({"glassy_pa": 1e6}, "glassy_pa must be above relaxed_pa"),
        ({"exponent": 1.1}, "exponent must be at most 1"),
        ({"tau_s": math.inf}, "tau_s must be finite"),
    ],
)
def test_figures_of_no_solid_are_refused(change: dict[str, float], message: str) -> None:
    figures = {"relaxed_pa": 1e6, "glassy_pa": 1e9, "tau_s": 1e-6, "exponent": 0.6, "shift_c": -3.0}
    with pytest.raises(ValueError, match=message):
        FractionalZener(**{**figures, **change})


def test_a_constant_modulus_has_storage() -> None:
    with pytest.raises(ValueError, match="storage_pa must be finite and above 0"):
        ConstantModulus(0.0, 0.3)
    with pytest.raises(ValueError, match="tan_delta must be finite and at least 0"):
        ConstantModulus(1e6, -0.1)


def test_a_sweep_gives_its_own_rows_back() -> None:
    modulus = TabulatedModulus.of_sweep(sweep())
    for row in sweep()[1:-1]:
        g = modulus.complex_pa(np.array([2.0 * math.pi]), row.temperature_c)[0]
        assert 3.0 * g == pytest.approx(complex(row.storage_pa, row.loss_pa), rel=1e-12)


def test_100_hz_at_25_degc_are_1_hz_at_9_degc() -> None:
    modulus = TabulatedModulus.of_sweep(sweep(), decade_k=8.0)
    fast = modulus.complex_pa(np.array([200.0 * math.pi]), 25.0)
    assert fast == pytest.approx(modulus.complex_pa(np.array([2.0 * math.pi]), 9.0), rel=1e-12)


def test_a_sweep_at_10_hz_is_shifted_from_10_hz() -> None:
    modulus = TabulatedModulus.of_sweep(sweep(f0_hz=10.0), decade_k=8.0)
    expected = next(row for row in sweep() if row.temperature_c == 10.0)
    g = modulus.complex_pa(np.array([200.0 * math.pi]), 18.0)[0]
    assert 3.0 * g.real == pytest.approx(expected.storage_pa, rel=1e-12)


def test_poissons_ratio_makes_shear_of_tension() -> None:
    rate = np.array([2.0 * math.pi])
    half, third = (TabulatedModulus.of_sweep(sweep(), poisson=nu).complex_pa(rate, 20.0)[0] for nu in (0.5, 1.0 / 3.0))
    assert third / half == pytest.approx(3.0 / (8.0 / 3.0), rel=1e-12)


def test_a_grid_becomes_the_master_curve_that_it_was_made_of() -> None:
    modulus = TabulatedModulus.of_grid(grid(), glass_c=-53.0)
    for temperature_c in (-20.0, 20.0, 47.0):
        rate = np.geomspace(3.0, 1e3, 30)
        expected = ZENER.complex_pa(rate, temperature_c)
        assert np.max(np.abs(modulus.complex_pa(rate, temperature_c) / expected - 1.0)) < 5e-3


def test_a_grid_with_5_percent_of_noise_stays_within_10_percent() -> None:
    modulus = TabulatedModulus.of_grid(grid(noise=0.05), glass_c=-53.0)
    rate = np.geomspace(3.0, 1e3, 50)
    assert np.max(np.abs(modulus.complex_pa(rate, 20.0) / ZENER.complex_pa(rate, 20.0) - 1.0)) < 0.1


def test_outside_its_range_a_table_states_its_limits() -> None:
    modulus = TabulatedModulus.of_sweep(sweep(), decade_k=8.0)
    assert modulus.limits_hz(20.0) == pytest.approx((10.0**-7.5, 10.0**12.5), rel=1e-9)
    modulus.complex_pa(2.0 * math.pi * np.array([10.0**-7.5, 10.0**12.5]), 20.0)
    with pytest.raises(OutsideError, match=r"known from 3\.16e-08 to 3\.16e\+12 Hz, not over 1 to 1e\+13"):
        modulus.complex_pa(2.0 * math.pi * np.array([1.0, 1e13]), 20.0)
    with pytest.raises(OutsideError):
        modulus.complex_pa(2.0 * math.pi * np.array([1e-8]), 20.0)


def test_a_held_end_counts_how_far_it_was_held() -> None:
    modulus = TabulatedModulus.of_sweep(sweep(), decade_k=8.0, hold_ends=True)
    modulus.complex_pa(np.array([1.0]), 20.0)
    assert modulus.beyond_decades == 0.0
    last = modulus.complex_pa(2.0 * math.pi * np.array([1e14, 10.0**12.5]), 20.0)
    assert last[0] == pytest.approx(last[1], rel=1e-12)
    assert modulus.beyond_decades == pytest.approx(1.5, rel=1e-9)
    modulus.complex_pa(2.0 * math.pi * np.array([1e13]), 20.0)
    assert modulus.beyond_decades == pytest.approx(1.5, rel=1e-9)


def test_tables_that_give_no_modulus_are_refused() -> None:
    rows = sweep()
    with pytest.raises(ValueError, match="at least 2 rows, not 1"):
        TabulatedModulus.of_sweep(rows[:1])
    with pytest.raises(ValueError, match="one frequency"):
        TabulatedModulus.of_sweep(grid())
    with pytest.raises(ValueError, match="every temperature once"):
        TabulatedModulus.of_sweep([*rows, rows[0]])
    with pytest.raises(ValueError, match="row 2: loss_pa must be finite and above 0, not 0"):
        TabulatedModulus.of_sweep([rows[0], rows[1]._replace(loss_pa=0.0)])
    with pytest.raises(ValueError, match="no master curve"):
        TabulatedModulus.of_grid([rows[0], rows[0]], glass_c=-53.0)
    with pytest.raises(PoleError):
        TabulatedModulus.of_grid(rows, glass_c=40.0)
    with pytest.raises(ValueError, match=r"Poisson's ratio is 0 to 0\.5"):
        TabulatedModulus.of_sweep(rows, poisson=0.6)
    with pytest.raises(ValueError, match="more than 0 K"):
        TabulatedModulus.of_sweep(rows, decade_k=0.0)


# the cubic that never overshoots


def test_a_straight_line_stays_one() -> None:
    x = np.array([0.0, 1.0, 3.0, 3.5])
    at = np.linspace(0.0, 3.5, 50)
    assert MonotoneCubic(x, 2.0 - 3.0 * x)(at) == pytest.approx(2.0 - 3.0 * at, abs=1e-12)
    assert MonotoneCubic(x[:2], x[:2])(np.array([0.25])) == pytest.approx([0.25])


def test_between_two_points_it_stays_between_their_values() -> None:
    random = np.random.default_rng(3)
    for _ in range(50):
        x = np.cumsum(random.uniform(0.01, 1.0, 12))
        y = random.standard_normal(12)
        curve = MonotoneCubic(x, y)
        for i in range(11):
            inside = curve(np.linspace(x[i], x[i + 1], 40))
            assert np.all(np.diff(inside) * (y[i + 1] - y[i]) >= -1e-12)


def test_a_smooth_curve_is_met_with_the_square_of_the_step_at_least() -> None:
    errors = []
    for points in (11, 21, 41):
        x = np.linspace(0.0, 2.0, points)
        at = np.linspace(0.0, 2.0, 999)
        errors.append(float(np.max(np.abs(MonotoneCubic(x, np.exp(x))(at) - np.exp(at)))))
    assert errors[0] < 3e-3 and errors[1] < errors[0] / 4.0 and errors[2] < errors[1] / 4.0
