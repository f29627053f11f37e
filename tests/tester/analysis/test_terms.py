"""Contributions of the machine's chain: every term's size at one point, calculated here by hand."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, isnan, radians, sqrt

import pytest

from tester.analysis.terms import Acts, BudgetPoint, Size, Term, contributions_of, with_settings
from tester.kinds.wheel_on_belt.budget import TERMS

MU, LOAD_N, SLIDING_M_S, PER_KELVIN, RATE_K_S = 0.73, 200.0, 0.3, 0.02, 0.6
AT = BudgetPoint(
    MU,
    LOAD_N,
    SLIDING_M_S,
    {"wheel_speed_m_s": 0.8, "belt_speed_m_s": 0.5},
    PER_KELVIN,
    RATE_K_S,
    Size(89.8, 0.2),
)
EVEN = 1.0 / sqrt(3.0)
PER_MM = MU * 0.8 * 0.8 / (89.8 * 0.3)

EXPECTED = {
    "cell linearity, friction": 1.0 * EVEN / LOAD_N,
    "cell linearity, load": MU * 0.6 * EVEN / LOAD_N,
    "load held": 0.35 * MU * 0.6 * EVEN / LOAD_N,
    "cell crosstalk": 0.005 * EVEN * hypot(1.0, MU * MU),
    "cell zero, friction": 0.5 * EVEN / LOAD_N,
    "cell zero, load": MU * 0.5 * EVEN / LOAD_N,
    "axis misalignment": (1.0 + MU * MU) * radians(0.5) / sqrt(2.0),
    "thermometer": MU * PER_KELVIN * 1.0 * EVEN,
    "thermometer lag": MU * PER_KELVIN * RATE_K_S * 0.15 * EVEN,
    "wheel speed": MU * 0.8 / SLIDING_M_S * 0.001 * 0.8 * EVEN,
    "belt speed": MU * 0.8 / SLIDING_M_S * 0.001 * 0.5 * EVEN,
    "diameter as installed": PER_MM * 0.15 * EVEN,
    "diameter worn off": PER_MM * 0.2,
    "wheel to wheel": MU * 0.03,
}
"""Standard uncertainties in mu."""


def found(at: BudgetPoint = AT) -> dict[str, float]:
    return {one.name: one.standard for one in contributions_of(TERMS, at)}


@pytest.mark.parametrize("name", EXPECTED)
def test_a_term_is_as_large_as_its_bound_and_its_formula_make_it(name: str) -> None:
    assert found()[name] == pytest.approx(EXPECTED[name], rel=1e-9)


def test_every_term_of_the_machine_is_looked_at_here() -> None:
    assert found().keys() == EXPECTED.keys()


COMMON = {
    "cell zero, friction": "", "cell zero, load": "", "wheel to wheel": "",
    "diameter as installed": "piece", "diameter worn off": "piece",
}  # fmt: skip
"""Scope of a shared error; the rig for all others."""


@pytest.mark.parametrize("name", EXPECTED)
def test_the_scope_of_a_term_s_error_is_known(name: str) -> None:
    assert {one.name: one.common for one in contributions_of(TERMS, AT)}[name] == COMMON.get(name, "rig")


@pytest.mark.parametrize("name", ["thermometer", "thermometer lag"])
def test_a_coefficient_that_falls_with_temperature_is_off_the_other_way(name: str) -> None:
    falls = {one.name: one.sensitivity for one in contributions_of(TERMS, replace(AT, per_kelvin=-PER_KELVIN))}
    rises = {one.name: one.sensitivity for one in contributions_of(TERMS, AT)}
    assert rises[name] > 0.0 and falls[name] == pytest.approx(-rises[name])


def test_slower_than_a_tenth_of_a_metre_a_second_counts_as_that() -> None:
    slow, slower = (found(replace(AT, sliding_m_s=speed))["wheel speed"] for speed in (0.1, 0.02))
    assert slower == slow > 2.9 * found()["wheel speed"]


BOTH = replace(AT, turning={"wheel_speed_m_s": 0.0, "belt_speed_m_s": -0.3})
"""Both directions: the belt at 0.5 and at 1.1 m/s."""
LEFT = {
    "cell crosstalk": MU * 0.005,
    "cell zero, friction": sqrt(0.5),
    "cell zero, load": sqrt(0.5),
    "axis misalignment": MU * radians(0.5),
    "wheel speed": 0.0,
    "belt speed": 0.6,
    "diameter as installed": 0.0,
    "diameter worn off": 0.0,
}
"""Share of a term that remains with both directions; all of every other term."""


@pytest.mark.parametrize("name", EXPECTED)
def test_both_directions_leave_the_part_of_a_term_that_reverses_with_the_sliding(name: str) -> None:
    assert found(BOTH)[name] == pytest.approx(LEFT.get(name, 1.0) * EXPECTED[name], rel=1e-9, abs=1e-15)


def test_both_directions_leave_a_hundredth_of_a_percent_of_misalignment_and_crosstalk() -> None:
    left = found(BOTH)
    assert 100.0 * left["axis misalignment"] / MU == pytest.approx(0.01, abs=0.003)
    assert 100.0 * left["cell crosstalk"] / MU < 0.003


def test_misalignment_is_1_27_percent_of_a_coefficient_of_three_quarters() -> None:
    assert 100.0 * found()["axis misalignment"] / MU == pytest.approx(1.27, abs=0.04)


def test_each_speed_counts_the_more_the_slower_it_slides() -> None:
    slow = replace(AT, sliding_m_s=0.1, means={"wheel_speed_m_s": 0.8, "belt_speed_m_s": 0.7})
    speeds = found(slow)["wheel speed"], found(slow)["belt speed"]
    assert 100.0 * hypot(*speeds) / MU / 0.8 == pytest.approx(0.61, abs=0.01)  # of the sliding speed


def test_a_check_of_the_diameter_takes_the_place_of_the_believed_wear() -> None:
    (worn,) = [one for one in contributions_of(TERMS, replace(AT, size=Size(89.8, 0.2, 0.01))) if "worn" in one.name]
    assert worn.standard == pytest.approx(PER_MM * 0.01) and worn.source == "check of the diameter"


def test_zero_sliding_has_a_finite_budget() -> None:
    assert max(found(replace(AT, sliding_m_s=0.0)).values()) < 0.1


def test_without_a_load_there_is_no_budget() -> None:
    assert all(isnan(value) for value in found(replace(AT, normal_n=0.0)).values())


def test_a_channel_that_was_not_measured_leaves_its_term_without_a_value() -> None:
    assert isnan(found(replace(AT, means={"wheel_speed_m_s": 0.8}))["belt speed"])


def test_settings_replace_bounds_and_exponents() -> None:
    settings = {"uncertainty.misalignment_deg": "0.2", "uncertainty.mu_slip_exponent": "0.4", "ambient": "23 degC"}
    set_ = {one.name: one for one in with_settings(TERMS, settings)}
    assert set_["axis misalignment"].bound == 0.2 and set_["wheel speed"].factor == 0.4
    assert with_settings(TERMS) == TERMS


@pytest.mark.parametrize("wrong", ["-1", "nan", "much"])
def test_a_setting_that_is_no_bound_is_refused(wrong: str) -> None:
    with pytest.raises(ValueError, match=r"uncertainty|convert"):
        with_settings(TERMS, {"uncertainty.misalignment_deg": wrong})


def test_an_unknown_distribution_is_refused() -> None:
    with pytest.raises(ValueError, match="rectangular, U-shaped, normal"):
        Term("zero", Acts.NORMAL, 0.5, "N", "triangular", "[A]")
