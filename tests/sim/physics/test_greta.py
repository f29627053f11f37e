"""Adhesion and hysteresis: the printed figures, an independent calculation, and every trend that the paper states."""

from __future__ import annotations

from dataclasses import replace
from math import exp, log10, pi, sqrt

import pytest

from sim.physics.greta import Greta, GretaParameters, greta
from sim.physics.materials import Components, Surface
from tests.sim.physics.greta_example import SHEAR, road, rubber

LAW = Greta(rubber(), road())
SPEEDS_M_S = [10.0 ** (-6.0 + 0.25 * i) for i in range(41)]
LOAD_N = 30.0
"""300 kPa on 100 mm2."""


def at_fixed_friction(law: Greta, friction: float, load_n: float = LOAD_N) -> float:
    coarse, _ = law.dynamic(25.0, 1.0)
    return law.hysteresis(law.pressure_pa(load_n), coarse, friction)


def test_adhesion_is_that_of_a_calculation_by_hand() -> None:
    at_c = 25.0 - 8.0 * log10(1.0 / 9.9e-5)  # 1 m/s over the fine wave, as a temperature at 1 Hz
    storage = 10.0 ** (log10(7e6) + log10(2e9 / 7e6) / (1.0 + exp((at_c + 25.0) / 6.0)))
    tan_delta = 0.12 + 0.55 * exp(-(((at_c + 15.0) / 18.0) ** 2))
    slope = sqrt(pi * 0.5 * (0.8e-5 * 2.0 * pi / 9.9e-5) ** 2)
    strength = 1.2e4 * (1.0 + (2e9 / 7e6) / 2.0**0.6)
    expected = strength * 2.0 / (storage * sqrt(1.0 + tan_delta**2) * slope)
    assert LAW.components(25.0, LOAD_N, 1.0).adhesion == pytest.approx(expected, abs=1e-6)
    assert expected == pytest.approx(0.67672, abs=5e-6)


def test_hysteresis_matches_the_figure_within_the_error_of_the_grid() -> None:
    found = LAW.components(25.0, LOAD_N, 1.0)
    assert found.hysteresis == pytest.approx(0.0152, rel=0.02)
    assert found.hysteresis == pytest.approx(0.0152, abs=5e-5)
    assert LAW.mu(25.0, LOAD_N, 1.0) == pytest.approx(0.6919, abs=5e-5)


@pytest.mark.parametrize(("ra_mm", "expected"), [(0.2, 0.0050), (0.4, 0.0079), (0.8, 0.0109), (1.6, 0.0139)])
def test_without_friction_hysteresis_grows_with_roughness(ra_mm: float, expected: float) -> None:
    assert at_fixed_friction(Greta(rubber(), road(ra_mm)), 0.0) == pytest.approx(expected, abs=6e-5)


@pytest.mark.parametrize(("tread_mm", "expected"), [(5.0, 0.0129), (10.0, 0.0132), (20.0, 0.0139)])
def test_a_higher_tread_hardly_adds_hysteresis(tread_mm: float, expected: float) -> None:
    law = Greta(rubber(), road(), GretaParameters(tread=tread_mm))
    assert at_fixed_friction(law, 0.5) == pytest.approx(expected, abs=6e-5)


def test_hysteresis_grows_with_roughness_at_any_friction() -> None:
    for friction in (0.0, 0.5, 1.0):
        found = [at_fixed_friction(Greta(rubber(), road(ra)), friction) for ra in (0.1, 0.2, 0.4, 0.8, 1.6, 3.2)]
        assert found == sorted(found) and found[0] < found[-1]


def test_hysteresis_grows_with_the_pressure() -> None:
    found = [at_fixed_friction(LAW, 0.5, load) for load in (1.0, 3.0, 10.0, 30.0, 100.0)]
    assert found == sorted(found) and found[0] < found[-1]


def test_adhesion_falls_with_roughness_and_with_a_stiffer_rubber() -> None:
    of_ra = [Greta(rubber(), road(ra)).components(25.0, LOAD_N, 1.0).adhesion for ra in (0.2, 0.4, 0.8, 1.6)]
    assert of_ra == sorted(of_ra, reverse=True) and of_ra[0] > of_ra[-1]
    of_e = [Greta(rubber(stiffer), road()).components(25.0, LOAD_N, 1.0) for stiffer in (0.5, 1.0, 2.0, 4.0)]
    for part in zip(*of_e, strict=True):
        assert list(part) == sorted(part, reverse=True)


def test_over_the_speed_the_coefficient_is_a_bell() -> None:
    found = [LAW.mu(25.0, LOAD_N, speed) for speed in SPEEDS_M_S]
    top = found.index(max(found))
    assert 0 < top < len(found) - 1
    assert found[: top + 1] == sorted(found[: top + 1])
    assert found[-1] < 0.8 * found[top] and found[0] < 0.8 * found[top]


def test_both_parts_are_above_0_everywhere() -> None:
    for temperature in (-20.0, 0.0, 25.0, 60.0, 100.0):
        for speed in (0.0, *SPEEDS_M_S):
            for load in (0.1, 10.0, 1000.0):
                parts = LAW.components(temperature, load, speed)
                assert min(parts) > 0.0 and sum(parts) == LAW.mu(temperature, load, speed)


def test_adhesion_does_not_know_the_load_until_the_contact_is_full() -> None:
    soft = [LAW.components(25.0, load, 1.0).adhesion for load in (1.0, 10.0, 100.0)]
    assert soft == pytest.approx([soft[0]] * 3, rel=1e-12)
    full = [LAW.components(25.0, load, 1.0).adhesion for load in (1e4, 2e4)]
    assert full[1] == pytest.approx(0.5 * full[0], rel=1e-12)


def test_friction_beyond_its_limit_does_not_add_to_the_stress() -> None:
    sticky = Greta(rubber(shear=replace(SHEAR, strength_pa=1e6)), road())
    parts = sticky.components(25.0, LOAD_N, 1.0)
    assert parts.adhesion > 1.0
    assert parts.hysteresis == at_fixed_friction(sticky, 1.0) == at_fixed_friction(sticky, 7.0)


def test_slower_than_slow_it_is_that_of_slow_sliding() -> None:
    assert LAW.mu(25.0, LOAD_N, 0.0) == LAW.mu(25.0, LOAD_N, 1e-6)


def test_a_constant_shift_of_temperature_equals_a_decade_of_frequency() -> None:
    colder, faster = LAW.dynamic(9.0, 1e-2), LAW.dynamic(25.0, 1.0)
    assert colder[0].magnitude_pa == pytest.approx(faster[0].magnitude_pa, rel=1e-12)


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: Greta(rubber(shear=None), road()), "greta needs its shear"),
        (lambda: Greta(rubber(), Surface("glass")), "surface 'glass': greta needs its two waves"),
        (lambda: greta(rubber(), road(), {"height": 5.0}), "greta has no height; it has area, tread, friction_limit"),
        (lambda: greta(rubber(), road(), {"tread": 0.0}), "tread must be finite and above 0"),
    ],
)  # fmt: skip
def test_materials_and_figures_that_make_no_law_are_refused(made: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        made()  # type: ignore[operator]


def test_a_rubber_a_surface_and_figures_make_the_law() -> None:
    law = greta(rubber(), road(), {"area": 200.0})
    assert isinstance(law.components(25.0, 2.0 * LOAD_N, 1.0), Components)
    assert law.mu(25.0, 2.0 * LOAD_N, 1.0) == pytest.approx(LAW.mu(25.0, LOAD_N, 1.0), rel=1e-12)
