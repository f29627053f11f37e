"""Friction formulas against the published values."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest

from sim.physics.friction import (
    COMPOUNDS,
    KNOWN,
    V2,
    FrictionModel,
    UnknownCompoundError,
    coefficient,
    coefficients,
    evaluate,
    thermal_factor,
)

REFERENCE = {"1#": 0.72977, "2#": 0.49736, "3#": 1.04982}
"""25 degC, 200 N, 0.3 m/s; the paper's data there are 0.73, 0.48 and 1.11."""

MODELS: list[str] = ["paper", "v2"]


@pytest.mark.parametrize(("compound", "expected"), REFERENCE.items())
def test_paper_model_gives_the_published_point(compound: str, expected: float) -> None:
    assert coefficient(compound, 25.0, 200.0, 0.3) == pytest.approx(expected, abs=5e-6)


@pytest.mark.parametrize("compound", KNOWN)
def test_v2_model_at_its_normalisation_point_is_the_sum_of_its_two_terms(compound: str) -> None:
    q = V2[compound]
    assert coefficient(compound, 25.0, 200.0, 0.3, "v2") == pytest.approx(q.c + q.a2, rel=1e-12)


@pytest.mark.parametrize("compound", KNOWN)
def test_v2_model_follows_its_formula_away_from_that_point(compound: str) -> None:
    q, t, p, v = V2[compound], 61.0, 340.0, 0.17

    def g(temperature_c: float) -> float:
        return math.exp(-q.beta * (temperature_c - q.tm) ** 2)

    expected = (1.0 + q.a * (g(t) - g(25.0))) * math.exp(q.k * (p - 200.0) / 200.0)
    expected *= q.c * (v / 0.3) ** q.b2 + q.a2
    assert coefficient(compound, t, p, v, "v2") == pytest.approx(expected, rel=1e-12)


def test_3_at_400_n_and_70_degc_needs_a_cell_for_more_than_600_n() -> None:
    assert 400.0 * coefficient("3#", 70.0, 400.0, 0.3) == pytest.approx(641.0, abs=1.0)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("compound", KNOWN)
def test_array_version_equals_the_scalar_one(compound: str, model: str) -> None:
    t = np.array([25.0, 40.0, 85.0])[:, None, None]
    p = np.array([100.0, 400.0])[None, :, None]
    v = np.array([0.0, 0.1, 0.4])
    many = coefficients(compound, t, p, v, model)
    fast = FrictionModel(compound, model)
    for i, j, k in np.ndindex(3, 2, 3):
        expected = many[i, j, k]
        assert fast.mu(t[i, 0, 0], p[0, j, 0], float(v[k])) == pytest.approx(expected, rel=1e-12)


def test_evaluate_takes_any_parameters() -> None:
    assert evaluate(COMPOUNDS["1#"], [25.0], 200.0, 0.3)[0] == pytest.approx(REFERENCE["1#"], abs=5e-6)


@pytest.mark.parametrize("compound", KNOWN)
def test_temperature_factor_peaks_at_its_centre(compound: str) -> None:
    p = COMPOUNDS[compound]
    assert thermal_factor(p, p.tm) == pytest.approx(p.alpha + p.gamma)
    assert thermal_factor(p, p.tm - 9.0) == pytest.approx(thermal_factor(p, p.tm + 9.0))
    assert thermal_factor(p, 25.0) < thermal_factor(p, p.tm)


def test_without_slip_only_the_constant_term_is_left() -> None:
    p = COMPOUNDS["2#"]
    assert coefficient("2#", 55.0, 300.0, 0.0) == pytest.approx(thermal_factor(p, 55.0) * p.a2)


def test_unknown_compound_is_refused_naming_the_known_ones() -> None:
    with pytest.raises(UnknownCompoundError, match=r"'4#'.*1#, 2#, 3#"):
        coefficient("4#", 25.0, 200.0, 0.3)
    assert issubclass(UnknownCompoundError, ValueError)


def test_unknown_model_is_refused() -> None:
    with pytest.raises(ValueError, match="paper, v2"):
        FrictionModel("1#", "magic")


@pytest.mark.parametrize(
    ("t", "p", "v"),
    [(25.0, 0.0, 0.3), (25.0, -1.0, 0.3), (25.0, 200.0, -0.1), (math.nan, 200.0, 0.3), (25.0, math.inf, 0.3)],
)
def test_numbers_without_meaning_are_refused(t: float, p: float, v: float) -> None:
    with pytest.raises(ValueError, match=r"finite|above 0|at least 0"):
        coefficient("1#", t, p, v)


def test_scalar_path_does_not_import_numpy() -> None:
    code = (
        "import sys, sim.physics.thermal; from sim.physics.slip import predict; "
        "predict('1#', 0.3, 200, 25); print('numpy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
