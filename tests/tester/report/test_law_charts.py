"""The figure of a master curve."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tester.analysis.master_curve.fitted_curve import master_of
from tester.report.law_charts import master_chart, masters_chart
from tests.campaigns.master.synthetic import SPEEDS_M_S, synthetic

MADE = master_of(synthetic(0, 0.02), 20.0, 30.0)


def test_measured_points_are_on_the_left_and_shifted_ones_on_the_right() -> None:
    left, right = master_chart(MADE).panels
    assert len(left.series) == 11 and len(right.series) == 12
    assert left.series[3].x == pytest.approx(SPEEDS_M_S)
    assert left.series[3].y == right.series[3].y == tuple(row.mu for row in MADE.rows()[27:36])
    assert np.log10(right.series[3].x) == pytest.approx([row.x for row in MADE.rows()[27:36]])


def test_every_temperature_has_its_own_colour_and_mark() -> None:
    _, right = master_chart(MADE).panels
    points = [one for one in right.series if one.look != "limit"]
    assert len({(one.style % 8, one.look) for one in points}) == 11
    assert [one.label for one in points][:2] == ["-5 °C", "4 °C"]


def test_the_spline_goes_through_the_collapsed_set() -> None:
    spline = master_chart(MADE).panels[1].series[-1]
    assert (spline.look, spline.label) == ("limit", "spline")
    rows = MADE.rows()
    at = np.interp([row.x for row in rows], np.log10(spline.x), spline.y)
    assert np.median(np.abs(at / [row.mu for row in rows] - 1.0)) < 0.03


def test_each_panel_has_its_own_logarithmic_axis(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    from tester.report.draw import draw

    draw(master_chart(MADE), tmp_path / "master.svg")
    assert (tmp_path / "master.svg").read_text(encoding="utf-8").count("<path") > 100


def test_several_curves_share_axes_each_with_its_own_look_and_spline() -> None:
    (panel,) = masters_chart([MADE, MADE]).panels
    points = [series for series in panel.series if series.look == "measured"]
    assert [series.style for series in points] == [0, 1] and all(len(series.x) == 99 for series in points)
    assert sum(series.look == "limit" for series in panel.series) == 2
