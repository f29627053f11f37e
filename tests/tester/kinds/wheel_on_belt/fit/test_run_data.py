"""The conditions of a run, as a fit takes them."""

from __future__ import annotations

from math import hypot, sqrt
from pathlib import Path

import pytest

from tester.analysis.fit.fit_law import Sourced
from tester.kinds.wheel_on_belt.fit.laws import TEMPERATURE
from tester.kinds.wheel_on_belt.fit.run_data import run_points
from tester.store.record_schema import StoreError
from tests.tester.kinds.wheel_on_belt.fit.made import LOAD_OFF_N, WARM_K, made_run

DESIGN = [(25.0, 100.0, 0.3), (25.0, 200.0, 0.3), (40.0, 200.0, 0.0), (40.0, 200.0, 0.3)]


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Sourced:
    folder = tmp_path_factory.mktemp("runs") / "one"
    return run_points(made_run(folder, DESIGN, alone=[4], metadata={"uncertainty.temperature_k": "0.5"}))


def test_measured_values_are_fitted_and_requested_values_name_the_cell(found: Sourced) -> None:
    first = found.points[0]
    assert first.nominal == (25.0, 100.0, 0.3)
    assert first.measured == pytest.approx((25.0 + WARM_K, 100.0 + LOAD_OFF_N, 0.3))


def test_repeats_give_the_scatter_of_their_mean(found: Sourced) -> None:
    first = found.points[0]
    assert first.type_a == pytest.approx(0.01 / sqrt(3.0), rel=1e-3)
    assert first.df == 6.0  # pooled over the three conditions of three repeats


def test_a_single_repeat_has_the_repeatability_of_the_run(found: Sourced) -> None:
    assert found.points[3].type_a == pytest.approx(0.01, rel=1e-3) and found.points[3].df == 6.0


def test_a_condition_has_zeros_and_drift_of_its_own_and_no_repeats_among_them(found: Sourced) -> None:
    drift = 0.01 * (0.1 + 0.1) * 1.5 / sqrt(12.0)  # a window's change and its error, over 1.5 windows of repeats
    for one in found.points:
        zero = 0.5 / sqrt(3.0) / one.measured[1]  # of either force, as a share of the load
        assert one.own == pytest.approx(hypot(zero / one.value, zero, drift), rel=1e-6)


def test_conditions_scatter_as_published_of_the_compound_or_as_the_recipe_states(tmp_path: Path) -> None:
    for name, compound, metadata, expected in (
        ("first", "1#", {}, 0.032),
        ("third", "3#", {}, 0.059),
        ("recipe", "1#", {"uncertainty.between_conditions": "0.01"}, 0.01),
    ):
        points = run_points(made_run(tmp_path / name, DESIGN[:2], compound=compound, metadata=metadata)).points
        assert [one.between for one in points] == [expected] * 2


def test_errors_shared_by_all_conditions_of_a_run_go_with_it(found: Sourced) -> None:
    gain, wheel, thermometer = found.points[0].source.common
    assert (wheel.standard, wheel.piece) == (pytest.approx(0.03), found.points[0].piece)
    assert 0.005 < gain.standard < 0.03 and gain.variable is None
    assert thermometer.variable == TEMPERATURE
    assert thermometer.standard == pytest.approx(0.5 / sqrt(3.0))
    assert len({one.source for one in found.points}) == 1


def test_conditions_outside_the_laws_or_unreliable_are_left_out_with_the_reason(tmp_path: Path) -> None:
    found = run_points(made_run(tmp_path / "one", DESIGN, sideslip={1: 10.0}, carried=[2], failed=[3]))
    assert [one.nominal for one in found.points] == [DESIGN[3]]
    assert [reason for _, reason in found.left_out] == [
        "sideslip: the laws know none",
        "carry-over",
        "not reached",
    ]
    assert found.left_out[0][0] == "one/1 (1#, 300 mm/s, 100 N, sideslip 10 deg, 25 degC)"


def test_a_folder_that_is_no_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StoreError):
        run_points(tmp_path)
