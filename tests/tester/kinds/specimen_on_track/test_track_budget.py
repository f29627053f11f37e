"""Contributions of the track's chain: every term's size at one point, calculated here by hand."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, radians, sqrt

import pytest

from tester.analysis.kelvin import UNKNOWN, Slope
from tester.analysis.terms import Acts, BudgetPoint, contributions_of, with_settings
from tester.kinds.specimen_on_track.budget import TERMS, instruments_budget

MU, LOAD_N, TRACK_M_S, PER_KELVIN = 0.9, 20.0, 0.2, -0.03
AT = BudgetPoint(MU, LOAD_N, TRACK_M_S, {"load_n": LOAD_N, "sliding_m_s": TRACK_M_S}, PER_KELVIN)
EVEN = 1.0 / sqrt(3.0)

EXPECTED = {
    "cell linearity": 0.01 * MU * EVEN,  # 18 N are below a tenth of the range
    "cell zero": 0.05 * EVEN / LOAD_N,
    "weights": MU * 0.001 * EVEN,
    "axis misalignment": (1.0 + MU * MU) * radians(0.2) / sqrt(2.0),
    "thermometer": MU * abs(PER_KELVIN) * 1.0 * EVEN,
    "track speed": MU * 0.001 * EVEN,
    "specimen to specimen": MU * 0.03,
}
"""Standard uncertainties in mu."""
OWN = {"cell zero", "specimen to specimen"}
"""Terms of each condition or each specimen; the others are the rig's."""


@pytest.mark.parametrize("name", EXPECTED)
def test_a_term_is_as_large_as_its_bound_and_its_formula_make_it(name: str) -> None:
    found = {one.name: one.standard for one in contributions_of(TERMS, AT)}
    assert found[name] == pytest.approx(EXPECTED[name], rel=1e-9)


def test_every_term_of_the_machine_is_looked_at_here() -> None:
    assert {one.name for one in TERMS} == EXPECTED.keys()


def test_an_error_of_the_rig_is_common_to_its_conditions() -> None:
    assert {one.name for one in contributions_of(TERMS, AT) if one.common != "rig"} == OWN


def test_a_coefficient_that_falls_with_temperature_is_off_the_other_way() -> None:
    falls, rises = (
        next(one.sensitivity for one in contributions_of(TERMS, replace(AT, per_kelvin=c)) if one.name == "thermometer")
        for c in (-0.03, 0.03)
    )
    assert falls == pytest.approx(-MU * 0.03) and rises == -falls


def test_the_instruments_have_all_terms_but_specimen_and_sensitivity() -> None:
    found = instruments_budget(MU, LOAD_N, TRACK_M_S, Slope(PER_KELVIN, 0.004, "made up"))
    chain = sum(u * u for name, u in EXPECTED.items() if name != "specimen to specimen")
    assert found.standard == pytest.approx(sqrt(chain + (MU * 0.004 * EVEN) ** 2))


def test_an_unknown_sensitivity_is_in_the_expected_uncertainty() -> None:
    found = {one.name: one.standard for one in instruments_budget(MU, LOAD_N, TRACK_M_S, UNKNOWN).contributions}
    assert found["temperature sensitivity"] == pytest.approx(MU * 0.026 * EVEN)
    assert found["thermometer"] == 0.0


@pytest.mark.parametrize(("mu", "bound_n"), [(0.03, 0.006), (0.99, 0.198), (1.0, 0.2), (2.0, 0.2)])
def test_a_tared_cell_is_off_in_proportion_to_a_small_force(mu: float, bound_n: float) -> None:
    at = replace(AT, mu=mu)
    found = next(one for one in contributions_of(TERMS, at) if one.name == "cell linearity")
    assert found.standard == pytest.approx(bound_n * EVEN / LOAD_N, rel=1e-9)


def test_only_a_force_has_a_size_from_which_a_bound_counts_whole() -> None:
    (cell,) = (one for one in TERMS if one.name == "cell linearity")
    with pytest.raises(ValueError, match=r"cell linearity: whole_at 20\.0 N"):
        replace(cell, acts=Acts.TEMPERATURE)


def test_without_a_load_there_is_no_budget() -> None:
    assert isnan(instruments_budget(MU, 0.0, TRACK_M_S, UNKNOWN).standard)


@pytest.mark.parametrize(
    "setting",
    ["cell_linearity_n", "cell_zero_n", "weights_share", "misalignment_deg", "temperature_k", "speed_share",
     "specimen_to_specimen"],
)  # fmt: skip
def test_every_bound_can_be_set_by_a_recipe(setting: str) -> None:
    changed = [one for one in with_settings(TERMS, {f"uncertainty.{setting}": "0.125"}) if one.bound == 0.125]
    assert len(changed) == 1
