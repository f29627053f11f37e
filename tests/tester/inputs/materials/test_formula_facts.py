"""Facts of a formula, against a sweep of it over the temperature."""

from __future__ import annotations

import numpy as np
import pytest

from sim.physics.materials import Rubber
from sim.physics.moduli import ConstantModulus, FractionalZener
from tester.inputs.materials.formula_facts import FormulaFacts, formula_facts, formula_words

ZENER = FractionalZener(8e5, 9e8, 2e-6, 0.62, shift_c=-10.0, t_ref_c=20.0)


def facts() -> FormulaFacts:
    found = formula_facts(Rubber("x", ZENER, 0.5, -60.0))
    assert found is not None
    return found


def swept(hertz: float) -> tuple[float, float]:
    """Return place and height of tan delta's maximum over the temperature at a frequency."""
    celsius = np.arange(-50.0, 60.0, 0.02)
    at = np.array([ZENER.complex_pa(np.array([2.0 * np.pi * hertz]), float(t))[0] for t in celsius])
    tan = at.imag / at.real
    return float(celsius[np.argmax(tan)]), float(np.max(tan))


def test_the_peak_is_that_of_a_sweep_and_moves_by_kelvins_a_decade() -> None:
    (at_1, height), (at_10, _) = swept(1.0), swept(10.0)
    assert (facts().peak_c, facts().peak) == (pytest.approx(at_1, abs=0.05), pytest.approx(height, rel=1e-4))
    assert facts().decade_k == pytest.approx(at_10 - at_1, abs=0.06)


def test_the_plateaus_are_those_of_tension() -> None:
    assert (facts().rubber_pa, facts().glass_pa) == (pytest.approx(2.4e6), pytest.approx(2.7e9))


def test_they_have_the_labels_of_a_sweep() -> None:
    told = dict(formula_words(facts()))
    assert list(told) == ["tan peak", "E0", "Einf", "Einf/E0", "shift"]
    assert told["E0"] == "2.4 MPa, by the formula" and told["Einf/E0"] == "1125"


def test_a_modulus_that_is_no_such_formula_has_none() -> None:
    assert formula_facts(Rubber("x", ConstantModulus(1e6, 0.1), 0.5, -60.0)) is None
