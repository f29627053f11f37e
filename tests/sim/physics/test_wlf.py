"""The bell over the reduced speed, against its closed form."""

from __future__ import annotations

import math

import pytest

from sim.physics.wlf import PoleError, WlfBell, WlfBellParameters, log10_shift, wlf_bell

LAW = WlfBell(WlfBellParameters())
TABLE = {
    -50.0: 8.601942, -25.0: 2.895425, -10.0: 0.968306, 0.0: 0.0, 10.0: -0.794619, 20.0: -1.458436, 50.0: -2.924092,
    100.0: -4.397022,
}  # fmt: skip
"""log10 aT by T - T_ref, with C1 = 8.86 and C2 = 101.5 K."""


@pytest.mark.parametrize(("off_k", "expected"), TABLE.items())
def test_the_shift_is_that_of_williams_landel_and_ferry(off_k: float, expected: float) -> None:
    assert log10_shift(12.0 + off_k, 12.0) == pytest.approx(expected, abs=1e-6)
    assert LAW.shift(LAW.parameters.t_ref + off_k) == pytest.approx(expected, abs=1e-6)


def test_a_shift_with_constants_of_its_own() -> None:
    assert log10_shift(40.0, 20.0, 17.4, 51.6) == pytest.approx(-17.4 * 20.0 / 71.6, rel=1e-12)


def test_the_shift_is_refused_at_its_pole() -> None:
    with pytest.raises(PoleError, match=r"-101\.5 degC: .* holds only above -101\.5 degC"):
        log10_shift(-101.5, 0.0)


def test_the_maximum_is_at_the_reference_speed_and_temperature() -> None:
    p = LAW.parameters
    assert LAW.mu(p.t_ref, 10.0, p.v_ref) == pytest.approx(p.mu_max, rel=1e-12)


def test_a_width_from_the_maximum_the_bell_is_down_to_one_over_e() -> None:
    p = LAW.parameters
    for decades in (-p.width, p.width):
        expected = p.mu_0 + (p.mu_max - p.mu_0) / math.e
        assert LAW.mu(p.t_ref, 10.0, p.v_ref * 10.0**decades) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("temperature_c", [-40.0, 0.0, 20.0, 60.0, 100.0])
def test_a_temperature_shift_equals_a_factor_of_speed(temperature_c: float) -> None:
    p = LAW.parameters
    for speed in (1e-6, 1e-4, 1e-2):
        shifted = speed * 10.0 ** LAW.shift(temperature_c)
        assert LAW.mu(temperature_c, 10.0, speed) == pytest.approx(LAW.mu(p.t_ref, 10.0, shifted), rel=1e-9)


def test_the_maximum_at_20_degc_is_where_grit_and_loss_frequency_put_it() -> None:
    speeds = [10.0 ** (-4.0 + 0.001 * i) for i in range(5000)]
    fastest = max(speeds, key=lambda speed: LAW.mu(20.0, 10.0, speed))
    assert fastest == pytest.approx(1.5e-4 * 3162.3 / (2.0 * math.pi), rel=0.01)


def test_load_changes_nothing() -> None:
    assert LAW.mu(20.0, 10.0, 1e-3) == LAW.mu(20.0, 400.0, 1e-3)


def test_at_standstill_it_is_the_foot_of_the_bell() -> None:
    assert LAW.mu(20.0, 10.0, 0.0) == LAW.parameters.mu_0


@pytest.mark.parametrize("below_k", [0.0, 1.0, 100.0])
def test_at_and_below_the_pole_there_is_no_law(below_k: float) -> None:
    with pytest.raises(PoleError, match=r"holds only above -104\.5 degC"):
        LAW.mu(LAW.parameters.t_ref - LAW.parameters.c2 - below_k, 10.0, 1e-3)


def test_the_shift_is_stated_valid_for_100_k_above_the_glass_transition() -> None:
    beyond = [c for c in (-53.1, -53.0, 47.0, 47.1) if list(LAW.caveats(c, 10.0, 1e-3))]
    assert beyond == [-53.1, 47.1]


@pytest.mark.parametrize(
    ("figures", "message"),
    [
        ({"width": 0.0}, "width must be above 0"),
        ({"c2": -1.0}, "c2 must be above 0"),
        ({"mu_0": 3.0}, "mu_0 is 0 to mu_max"),
        ({"t_ref": math.nan}, "t_ref must be finite"),
        ({"tg": -53.0}, "wlf_bell has no tg; it has mu_0"),
    ],
)
def test_figures_that_make_no_law_are_refused(figures: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        wlf_bell("SBR", figures)
