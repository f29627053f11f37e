"""Persson's hysteresis, against closed forms, limits, and what a rubber's friction does."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import pytest

from sim.physics.materials import Rubber, ShearModulus, Surface
from sim.physics.moduli import ConstantModulus, FractionalZener
from sim.physics.persson import PerssonLaw, persson
from sim.physics.roughness import SelfAffine, TabulatedSpectrum
from sim.physics.wlf import log10_shift

if TYPE_CHECKING:
    from sim.physics.materials import Array, Complex

ABRASIVE = SelfAffine(2.6023e-19, 2e4, 10.0**5.344, 0.8)
"""20 um high, slope 1.0272."""
PLAIN = ConstantModulus(1e6, 0.3)
SBR = FractionalZener(1e6, 1e9, 1e-6, 0.6, -3.0)
LOSS_RAD_S = 3162.3
"""Of its greatest loss factor at 20 degC."""


class Stiffened:
    """A modulus with its storage part multiplied."""

    def __init__(self, modulus: ShearModulus, factor: float) -> None:
        self.modulus, self.factor = modulus, factor

    def complex_pa(self, rate_rad_s: Array, temperature_c: float) -> Complex:
        g = self.modulus.complex_pa(rate_rad_s, temperature_c)
        return self.factor * g.real + 1j * g.imag


def closed(pressure_pa: float, slope_square: float, modulus: ConstantModulus = PLAIN) -> tuple[float, float]:
    """Return mu and P for a modulus without frequency; ``slope_square``: int q^3 C dq up to the scale."""
    delta = math.atan(modulus.tan_delta)
    k = 2.0 * modulus.storage_pa / math.cos(delta) / (0.5 * pressure_pa)
    c, root = 1.0 / (k * math.sqrt(math.pi)), math.sqrt(slope_square)
    share = math.erf(c / root)
    mu = 2.0 * k * math.sin(delta) * (
        slope_square * share
        + 2.0 * c / math.sqrt(math.pi) * root * math.exp(-((c / root) ** 2))
        - 2.0 * c * c * math.erfc(c / root)
    )  # fmt: skip
    return mu, share


def law(modulus: ShearModulus = SBR, spectrum: SelfAffine = ABRASIVE) -> PerssonLaw:
    """Return the law at its own resolution."""
    return PerssonLaw(modulus, 0.5, spectrum)


def bell(of: PerssonLaw, temperature_c: float = 20.0, low: float = -6.0, high: float = 4.0) -> tuple[float, float]:
    """Return speed and height of the maximum, by a parabola through the greatest three of 20 a decade."""
    x = np.linspace(low, high, round(20 * (high - low)) + 1)
    y = np.array([of.components(temperature_c, 4e5, 10.0**speed).hysteresis for speed in x])
    i = int(np.argmax(y))
    a, b, c = y[i - 1 : i + 2]
    off = 0.5 * (a - c) / (a - 2.0 * b + c)
    return 10.0 ** (x[i] + off * (x[1] - x[0])), float(b - 0.25 * (a - c) * off)


TABULATED = {1e3: (0.299767, 0.000372), 1e5: (0.291203, 0.037187), 1e9: (0.000403, 1.0)}
"""mu and P(q1) by the nominal pressure, Pa."""


@pytest.mark.parametrize("pressure_pa", [1e3, 1e4, 1e5, 1e6, 1e7, 1e9])
def test_a_modulus_without_frequency_meets_its_closed_form(pressure_pa: float) -> None:
    slope_square = ABRASIVE.rms_slope**2 / (2.0 * math.pi)
    mu, share = closed(pressure_pa, slope_square)
    if pressure_pa in TABULATED:
        assert mu == pytest.approx(TABULATED[pressure_pa][0], rel=1e-4)
        assert share == pytest.approx(TABULATED[pressure_pa][1], rel=1e-4, abs=1e-6)
    found = law(PLAIN).contact(20.0, pressure_pa, 1.0)
    assert found.mu == pytest.approx(mu, rel=1e-5)
    assert found.share[-1] == pytest.approx(share, rel=1e-4)


@pytest.mark.parametrize("pressure_pa", [1e3, 1e5, 1e7])
def test_the_area_at_every_scale_meets_its_closed_form(pressure_pa: float) -> None:
    found = law(PLAIN).contact(20.0, pressure_pa, 1.0)
    assert found.share[0] == 1.0
    for i in range(20, len(found.q_1_m), 20):
        seen = SelfAffine(2.6023e-19, 2e4, float(found.q_1_m[i]), 0.8)
        assert found.share[i] == pytest.approx(closed(pressure_pa, seen.rms_slope**2 / (2.0 * math.pi))[1], rel=1e-4)


def test_under_a_low_pressure_friction_is_that_of_slope_and_loss_alone() -> None:
    expected = 1.015898 * math.sin(math.atan(0.3)) * ABRASIVE.rms_slope
    for pressure_pa in (1e2, 1e3):
        assert law(PLAIN).components(20.0, pressure_pa, 1.0).hysteresis == pytest.approx(expected, rel=5e-3)


def test_in_full_contact_friction_falls_with_the_pressure() -> None:
    one, ten = (law(PLAIN).components(20.0, pressure_pa, 1.0).hysteresis for pressure_pa in (1e9, 1e10))
    assert one / ten == pytest.approx(10.0, rel=1e-4)


def test_an_sbr_like_rubber_at_1_cm_s() -> None:
    parts = law().components(20.0, 4e5, 1e-2)
    assert parts.adhesion == 0.0
    assert parts.hysteresis == pytest.approx(1.0469, rel=5e-3)


@pytest.mark.parametrize("speed", [1e-6, 1e-3, 1.0, 100.0])
def test_finer_points_change_nothing(speed: float) -> None:
    fine = PerssonLaw(SBR, 0.5, ABRASIVE, panels=2000, nodes=128)
    expected = fine.components(20.0, 4e5, speed).hysteresis
    assert law().components(20.0, 4e5, speed).hysteresis == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("temperature_c", [-40.0, -10.0, 5.0, 40.0, 80.0])
def test_a_temperature_shift_equals_a_factor_of_speed(temperature_c: float) -> None:
    factor = 10.0 ** (log10_shift(temperature_c, -3.0) - log10_shift(20.0, -3.0))
    for speed in (1e-6, 1e-3, 1e-1):
        shifted = law().components(20.0, 4e5, speed * factor).hysteresis
        assert law().components(temperature_c, 4e5, speed).hysteresis == pytest.approx(shifted, rel=1e-9)


def test_over_the_speed_friction_is_one_bell() -> None:
    of = law()
    mu = [of.components(20.0, 4e5, 10.0**speed).hysteresis for speed in np.linspace(-10.0, 8.0, 73)]
    top = mu.index(max(mu))
    assert 0 < top < 72
    assert all(a < b for a, b in pairwise(mu[: top + 1])) and all(a > b for a, b in pairwise(mu[top:]))


def test_the_maximum_is_where_the_grit_and_the_loss_frequency_put_it() -> None:
    # Grosch: the speed of the rough track's maximum is 150 um times the frequency of the greatest loss factor.
    speed, _ = bell(law())
    assert speed == pytest.approx(1.5e-4 * LOSS_RAD_S / (2.0 * math.pi), rel=0.1)


def test_the_maximum_is_at_the_same_reduced_speed_at_every_temperature() -> None:
    places = [math.log10(bell(law(), t, low, low + 6.0)[0]) + log10_shift(t, -3.0)
              for t, low in ((0.0, -6.0), (20.0, -4.0), (60.0, -2.0))]  # fmt: skip
    assert max(places) - min(places) < 5e-3


def test_1_to_7_bar_change_little() -> None:
    of = law()
    found = [of.contact(20.0, 1e5 * bar, 1e-2) for bar in (1, 2, 4, 7)]
    mu = [one.mu for one in found]
    assert all(a > b for a, b in pairwise(mu)) and mu[0] / mu[-1] < 1.05
    areas = [one.share[-1] / bar for one, bar in zip(found, (1, 2, 4, 7), strict=True)]
    assert max(areas) / min(areas) < 1.01


def test_beyond_full_contact_friction_falls_as_one_over_the_pressure() -> None:
    of = law()
    assert of.contact(20.0, 1e9, 1e-2).share[-1] > 0.99
    one, ten = (of.components(20.0, pressure_pa, 1e-2).hysteresis for pressure_pa in (1e10, 1e11))
    assert one / ten == pytest.approx(10.0, rel=5e-3)


def test_a_stiffer_rubber_has_a_lower_maximum_at_the_same_speed() -> None:
    speed, height = bell(law())
    stiff_speed, stiff_height = bell(law(Stiffened(SBR, 3.0)))
    assert stiff_height / height == pytest.approx(0.5, abs=0.1)
    assert abs(math.log10(stiff_speed / speed)) < 0.3


def test_without_the_finest_roughness_the_maximum_is_lower_and_at_higher_speed() -> None:
    speed, height = bell(law())
    coarse_speed, coarse_height = bell(law(spectrum=SelfAffine(2.6023e-19, 2e4, 8e4, 0.8)))
    assert coarse_height < 0.9 * height and coarse_speed > 1.3 * speed


def test_at_standstill_it_is_that_of_the_slowest_sliding() -> None:
    assert law().components(20.0, 4e5, 0.0) == law().components(20.0, 4e5, 1e-15)


def test_a_table_of_the_spectrum_gives_the_same() -> None:
    q = np.geomspace(2e4, 10.0**5.344, 40)
    table = PerssonLaw(SBR, 0.5, TabulatedSpectrum(q, ABRASIVE.power_m4(q)))
    expected = law().components(20.0, 4e5, 1e-2).hysteresis
    assert table.components(20.0, 4e5, 1e-2).hysteresis == pytest.approx(expected, rel=1e-6)


def test_impossible_laws_are_refused() -> None:
    rubber, surface = Rubber("SBR", SBR), Surface("grit", ABRASIVE)
    assert persson(rubber, surface, 100.0, {}).components(20.0, 40.0, 1e-2) == law().components(20.0, 4e5, 1e-2)
    with pytest.raises(ValueError, match="'plate' has no spectrum of heights"):
        persson(rubber, Surface("plate"), 100.0, {})
    with pytest.raises(ValueError, match="takes no figures, not q1"):
        persson(rubber, surface, 100.0, {"q1": 1.0})
    with pytest.raises(ValueError, match="pressure must be finite and above 0"):
        law().components(20.0, 0.0, 1e-2)
    with pytest.raises(ValueError, match=r"Poisson's ratio is 0 to 0\.5"):
        PerssonLaw(SBR, 0.7, ABRASIVE)
