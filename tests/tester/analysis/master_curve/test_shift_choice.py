"""WLF or Arrhenius, by likelihood."""

from __future__ import annotations

import numpy as np
import pytest

from tester.analysis.master_curve.collapse import collapse
from tester.analysis.master_curve.fitted_curve import master_of
from tester.analysis.master_curve.points import set_of
from tester.analysis.master_curve.shift_choice import ShiftChoice, arrhenius_shifts, choice_of
from tests.campaigns.master.synthetic import arrhenius, synthetic


def test_the_shift_of_arrhenius_is_its_closed_form() -> None:
    celsius = np.array([0.0, 20.0, 40.0])
    shifts = arrhenius_shifts(celsius, 100e3)
    assert shifts[0] - shifts[2] == pytest.approx(arrhenius(0.0) - arrhenius(40.0), rel=1e-3)
    assert abs(shifts[1]) < 0.1


def test_wlf_is_likelier_where_it_is_the_truth() -> None:
    found = [choice_of(collapse(set_of(synthetic(seed, 0.02)), resamples=2)) for seed in range(3)]
    assert [one.likelier for one in found] == ["WLF"] * 3


def test_arrhenius_is_likelier_where_it_is_the_truth_and_its_energy_is_found() -> None:
    found = [choice_of(collapse(set_of(synthetic(seed, 0.02, shift=arrhenius)), resamples=2)) for seed in range(3)]
    assert [one.likelier for one in found] == ["Arrhenius"] * 3
    assert [one.activation_j_mol for one in found] == pytest.approx([100e3] * 3, rel=0.05)


def test_over_a_few_kelvin_neither_is_likelier() -> None:
    near = [one for one in synthetic(0, 0.05) if one.block_c in (13.0, 22.0, 31.0)]
    assert master_of(near, 20.0).choice is not None
    assert choice_of(collapse(set_of(near), resamples=2)).likelier == ""


@pytest.mark.parametrize(("over", "likelier"), [(3.1, "WLF"), (-3.1, "Arrhenius"), (2.9, ""), (-2.9, "")])
def test_a_small_difference_decides_nothing(over: float, likelier: str) -> None:
    assert ShiftChoice(1e5, over).likelier == likelier


def test_a_given_ts_is_not_compared() -> None:
    assert master_of(synthetic(0, 0.02), 20.0, 30.0).choice is None
