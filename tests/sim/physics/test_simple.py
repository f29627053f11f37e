"""The power law and the bell of one activation energy, against their closed forms."""

from __future__ import annotations

import math

import pytest

from sim.physics.simple import Arrhenius, ArrheniusParameters, PowerLaw, PowerParameters, arrhenius, power

BELL = Arrhenius(ArrheniusParameters())


def test_the_power_law_has_an_exponent_of_speed_and_one_of_load() -> None:
    law = PowerLaw(PowerParameters(a=0.8, v0=0.2, n=0.15, n0=20.0, m=-0.25))
    assert law.mu(60.0, 20.0, 0.2) == pytest.approx(0.8, rel=1e-12)
    assert law.mu(60.0, 320.0, 0.2) == pytest.approx(0.4, rel=1e-12)
    assert law.mu(60.0, 20.0, 0.02) == pytest.approx(0.8 * 10.0**-0.15, rel=1e-12)
    assert law.mu(-10.0, 20.0, 0.2) == law.mu(60.0, 20.0, 0.2)


def test_the_power_law_is_finite_at_standstill() -> None:
    for n in (-0.5, 0.0, 0.5):
        law = PowerLaw(PowerParameters(n=n))
        assert law.mu(20.0, 10.0, 0.0) == law.mu(20.0, 10.0, 1e-6) > 0.0


def test_the_maximum_is_at_the_reference() -> None:
    p = BELL.parameters
    assert BELL.mu(p.t_ref, 10.0, p.v_ref) == pytest.approx(p.mu_max, rel=1e-12)
    for decades in (-p.width, p.width):
        expected = p.mu_0 + (p.mu_max - p.mu_0) / math.e
        assert BELL.mu(p.t_ref, 10.0, p.v_ref * 10.0**decades) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("temperature_c", [-30.0, 0.0, 50.0, 90.0])
def test_warmth_moves_the_maximum_by_one_energy(temperature_c: float) -> None:
    p = BELL.parameters
    inverse_k = 1.0 / (temperature_c + 273.15) - 1.0 / (p.t_ref + 273.15)
    moved = p.v_ref * math.exp(-90e3 / 8.314462618 * inverse_k)
    assert BELL.mu(temperature_c, 10.0, moved) == pytest.approx(p.mu_max, rel=1e-12)
    assert (moved > p.v_ref) == (temperature_c > p.t_ref)


def test_the_bell_at_standstill_is_its_foot_at_any_load() -> None:
    assert BELL.mu(20.0, 10.0, 0.0) == BELL.parameters.mu_0
    assert BELL.mu(20.0, 10.0, 1e-3) == BELL.mu(20.0, 400.0, 1e-3)


def test_at_absolute_zero_there_is_no_law() -> None:
    with pytest.raises(ValueError, match=r"above -273\.15 degC"):
        BELL.mu(-273.15, 10.0, 1e-3)


@pytest.mark.parametrize(
    ("maker", "figures", "message"),
    [
        (power, {"v0": 0.0}, "v0 must be above 0"),
        (power, {"m": math.inf}, "m must be finite"),
        (power, {"k": 1.0}, "power has no k; it has a, v0, n, n0, m"),
        (arrhenius, {"mu_0": 3.0}, "mu_0 is 0 to mu_max"),
        (arrhenius, {"energy": -1.0}, "energy must be above 0"),
        (arrhenius, {"t_ref": -300.0}, "t_ref is above"),
        (arrhenius, {"c1": 8.86}, "arrhenius has no c1"),
    ],
)
def test_figures_that_make_no_law_are_refused(maker: object, figures: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        maker("SBR", figures)  # type: ignore[operator]
