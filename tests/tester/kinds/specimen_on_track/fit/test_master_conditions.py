"""The conditions of a run on a track as a master curve takes them."""

from __future__ import annotations

from math import sqrt
from pathlib import Path

import pytest

from tester.kinds.specimen_on_track.fit.master_conditions import MASTERS
from tester.kinds.specimen_on_track.fit.run_data import TEMPERATURE, run_points
from tests.tester.kinds.specimen_on_track.fit.made import WARM_K, law, made_track_run


def test_points_have_measured_speed_and_temperature_and_shared_errors(tmp_path: Path) -> None:
    folder = made_track_run(tmp_path / "one", (0.0,), (1e-5, 1e-3), interfaces=("talc",), scatter=0.0)
    found = MASTERS.run(folder)
    last = found.points[-1]
    assert (last.speed_m_s, last.temperature_c, last.block_c) == pytest.approx((1e-3, WARM_K, 0.0))
    assert last.mu == pytest.approx(law(WARM_K, 1e-3)) and last.compound == "SBR"
    assert dict(last.held) == {"interface": "talc", "load": "20 N"}
    thermometer = next(one for one in run_points(folder).points[0].source.common if one.variable == TEMPERATURE)
    assert last.source.thermometer_k == thermometer.standard == pytest.approx(1.0 / sqrt(3.0))
    assert 0.03 < last.source.gain < 0.05
    assert found.refusal == ""


def test_a_run_whose_contact_friction_warms_beyond_its_band_is_refused_with_the_worst_row(tmp_path: Path) -> None:
    found = MASTERS.run(made_track_run(tmp_path / "one", (0.0, 20.0), (1e-4, 1e-2), scatter=0.0, band_k=0.1))
    assert "friction warms the contact beyond its band of temperature in 2 rows: by 0.2 K" in found.refusal
    assert "by 0.2 K at 10 mm/s and 0 degC, band 0.1 K" in found.refusal


def test_a_run_whose_law_is_not_installed_any_more_has_its_master_curve(tmp_path: Path) -> None:
    found = MASTERS.run(made_track_run(tmp_path / "one", (0.0, 20.0), (1e-4, 1e-3), law_name="a_law_of_nobody"))
    assert len(found.points) == 4 and not found.refusal


def test_nothing_of_it_ships_with_the_program() -> None:
    with pytest.raises(KeyError):
        MASTERS.packaged("appendix-a")
