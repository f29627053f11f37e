"""The conditions of a run on a track, as fits and master curves take them."""

from __future__ import annotations

from math import hypot, inf, sqrt
from pathlib import Path

import pytest

from tester.analysis.terms import Acts
from tester.kinds.specimen_on_track.budget import TERMS
from tester.kinds.specimen_on_track.fit.run_data import BEYOND_BAND, LOAD, SPEED, TEMPERATURE, run_points
from tester.store.record_schema import StoreError
from tests.tester.kinds.specimen_on_track.fit.made import WARM_K, law, made_track_run

PLACES = (SPEED, TEMPERATURE, LOAD)


def test_measured_and_nominal_conditions_stand_side_by_side(tmp_path: Path) -> None:
    found = run_points(made_track_run(tmp_path / "one", (0.0, 20.0), (1e-5, 1e-3), interfaces=("wet",), scatter=0.0))
    last = found.points[-1]
    assert [last.nominal[place] for place in PLACES] == [1e-3, 20.0, 20.0]
    assert [last.measured[place] for place in PLACES] == pytest.approx([1e-3, 20.0 + WARM_K, 20.0])
    assert (last.group, last.value) == ("SBR, wet", pytest.approx(law(20.0 + WARM_K, 1e-3)))
    assert len(found.points) == 4 and found.left_out == ()


def test_repeats_give_the_scatter_of_their_mean(tmp_path: Path) -> None:
    several = run_points(made_track_run(tmp_path / "three", (20.0,), (1e-4, 1e-3), repeats=3, scatter=0.02))
    assert all(0.0 < one.type_a < 0.05 and one.df == 4.0 for one in several.points)
    assert several.points[0].source.repeats == "repeats of the run"


@pytest.mark.parametrize(("metadata", "share"), [({}, 0.02), ({"uncertainty.repeatability": "0.05"}, 0.05)])
def test_of_single_repeats_the_declared_repeatability_counts(
    tmp_path: Path, metadata: dict[str, str], share: float
) -> None:
    alone = run_points(made_track_run(tmp_path / "one", (20.0,), (1e-4,), metadata=metadata)).points[0]
    assert (alone.type_a, alone.df) == (share, inf)
    assert f"{100.0 * share:g} % a repeat, declared by the" in alone.source.repeats


def test_the_mean_of_repeats_that_agree_has_the_declared_repeatability_over_the_root_of_their_number(
    tmp_path: Path,
) -> None:
    same = run_points(made_track_run(tmp_path / "one", (20.0,), (1e-4,), repeats=3, scatter=0.0)).points[0]
    assert (same.type_a, same.df) == (pytest.approx(0.02 / sqrt(3.0)), inf)


def test_a_condition_has_its_zero_and_drift_of_its_own_and_no_repeats_among_them(tmp_path: Path) -> None:
    drift = 0.01 * (0.1 + 0.1) * 1.5 / sqrt(12.0)  # a window's change and its error, over 1.5 windows of repeats
    for one in run_points(made_track_run(tmp_path / "one", (20.0,), (1e-4, 1e-3), repeats=3)).points:
        assert one.own == pytest.approx(hypot(0.05 / sqrt(3.0) / 20.0 / one.value, drift), rel=1e-6)


def test_conditions_warmed_by_friction_beyond_their_band_are_left_out(tmp_path: Path) -> None:
    found = run_points(made_track_run(tmp_path / "one", (0.0, 20.0), (1e-4, 1e-2), scatter=0.0, band_k=0.21))
    assert {reason for _, reason in found.left_out} == {BEYOND_BAND}
    assert len(found.points) + len(found.left_out) == 4 and found.left_out
    slow = found.points[0]
    assert slow.own_heat_k == pytest.approx(0.5 * slow.value * 20.0 * 1e-4)


def test_a_run_whose_law_is_not_installed_any_more_can_be_read(tmp_path: Path) -> None:
    folder = made_track_run(tmp_path / "one", (20.0,), (1e-4, 1e-3), law_name="a_law_of_nobody")
    assert len(run_points(folder).points) == 2


def test_the_thermometers_bias_is_an_error_of_the_temperature_that_all_share(tmp_path: Path) -> None:
    found = run_points(made_track_run(tmp_path / "one", (20.0,), (1e-4, 1e-3)))
    common = {one.name: one for one in found.points[0].source.common}
    bound = next(one.bound for one in TERMS if one.acts is Acts.TEMPERATURE)
    assert common["thermometer"].variable == TEMPERATURE
    assert common["thermometer"].standard == pytest.approx(bound / sqrt(3.0))
    assert common["specimen to specimen"].standard == pytest.approx(0.03)
    assert 0.001 < common["calibration and alignment"].standard < 0.03
    assert len({one.source for one in found.points}) == 1


def test_a_recipe_replaces_the_thermometers_bound(tmp_path: Path) -> None:
    folder = made_track_run(tmp_path / "one", (20.0,), (1e-4,), metadata={"uncertainty.temperature_k": "0.2"})
    thermometer = next(one for one in run_points(folder).points[0].source.common if one.variable == TEMPERATURE)
    assert thermometer.standard == pytest.approx(0.2 / sqrt(3.0))


def test_unreliable_conditions_are_left_out_with_the_reason(tmp_path: Path) -> None:
    found = run_points(made_track_run(tmp_path / "one", (20.0,), (1e-5, 1e-4, 1e-3), carried=[1], failed=[2]))
    assert [one.nominal[SPEED] for one in found.points] == [1e-3]
    assert [reason for _, reason in found.left_out] == ["carry-over", "not reached"]
    assert found.left_out[0][0] == "one/1 (SBR, 20 N, 20 degC, 0.01 mm/s)"


def test_a_folder_that_is_no_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StoreError):
        run_points(tmp_path)
