"""The laws in their normalised form, against those of the simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim.physics import laws
from sim.physics.friction import COMPOUNDS, V2, evaluate
from tester.analysis.fit.fit_law import Law
from tester.analysis.fit.joint import fit_only, predict
from tester.analysis.fit.solve import FitProblem, solve
from tester.kinds.wheel_on_belt.fit.laws import PAPER, POWER, V2_LAW, joint_of, of_v2, table_3_of
from tests.campaigns.fit import synthetic as campaign
from tests.campaigns.fit.synthetic import DESIGN, NOISE, SAME, made, split

pytest.importorskip("scipy", reason="needs the extra `report`")

X = np.array(DESIGN)


@pytest.mark.parametrize("compound", COMPOUNDS)
def test_the_normalised_form_of_eq_6_agrees_with_table_3(compound: str) -> None:
    given = COMPOUNDS[compound]
    assert PAPER.value(np.array(joint_of(given)), X) == pytest.approx(evaluate(given, *X.T), rel=SAME)
    assert evaluate(table_3_of(joint_of(given)), *X.T) == pytest.approx(evaluate(given, *X.T), rel=SAME)


@pytest.mark.parametrize("compound", V2)
def test_v2_is_that_of_the_simulator(compound: str) -> None:
    joint = V2_LAW.published[compound]
    assert V2_LAW.value(np.array(joint), X) == pytest.approx(evaluate(V2[compound], *X.T), rel=SAME)
    assert joint == of_v2(V2[compound])


def test_powers_are_those_of_the_simulator_with_the_laws_constants() -> None:
    found = {"a": 0.7, "n": 0.3, "m": -0.2}
    sliding = X[X[:, 2] > 0.0]
    law = laws.make("power", "own", found | dict(POWER.constants))
    values = POWER.value(np.array([*found.values()]), sliding)
    assert values == pytest.approx([law.mu(*map(float, at)) for at in sliding], rel=SAME)
    why = POWER.leaves_out
    assert why is not None and why((25.0, 200.0, 0.0)) and not why((25.0, 200.0, 0.1))


def test_redundant_parameters_predict_the_same() -> None:
    assert campaign.redundant() <= SAME


@pytest.mark.parametrize("scale", campaign.SCALES)
def test_a_search_from_redundant_parameters_ends_at_the_same_fit(scale: float) -> None:
    _, points = made(PAPER, 0, NOISE)
    given = COMPOUNDS["2#"]
    scaled = replace(given, alpha=scale * given.alpha, gamma=scale * given.gamma, a1=given.a1 / scale,
                     a2=given.a2 / scale)  # fmt: skip
    problem = FitProblem(PAPER, points, {})
    ends = [problem.logarithms(solve(problem, [joint_of(start)])) for start in (given, scaled)]
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)  # where the search stops, not the minimum


def test_the_factor_of_table_3_is_1_at_25_degc() -> None:
    found = table_3_of(joint_of(COMPOUNDS["3#"]))
    assert found.alpha * np.exp(-found.beta * (25.0 - found.tm) ** 2) + found.gamma == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("law", [V2_LAW, PAPER], ids=lambda law: law.name)
def test_many_sets_of_parameters_are_evaluated_at_once(law: Law) -> None:
    every = np.array([*law.published.values()])
    assert law.value(every, X).shape == (3, len(X))
    assert law.value(every, X)[1] == pytest.approx(law.value(every[1], X))
    moved = np.stack([X, X + 1.0, X + 2.0])
    assert law.value(every, moved)[2] == pytest.approx(law.value(every[2], X + 2.0))


@pytest.mark.parametrize("law", [V2_LAW, PAPER], ids=lambda law: law.name)
def test_without_noise_the_parameters_come_back(law: Law) -> None:
    truth, points = made(law, 1, 0.0)
    assert fit_only(law, "one", points) == pytest.approx(truth, rel=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_a_held_out_condition_is_predicted_within_3_per_cent(seed: int) -> None:
    truth, points = made(PAPER, seed, NOISE)
    kept, out = split(points, seed)
    assert len(out) == 5
    found, exact = (predict(PAPER, p, out) for p in (fit_only(PAPER, "one", kept), truth))
    assert found == pytest.approx(exact, rel=0.03)
