"""Drawn charts, compared with stored pictures; TESTER_PICTURES=write stores them anew."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from tester.base.plugins import MissingExtraError
from tester.report.chart import ChartSurface, SecondScale
from tester.report.draw import COLOURS, DASHES, FORMATS, MARKS, draw
from tester.report.page import inline_svg
from tests.tester.report.samples import CHART, FIGURES

to_rgb = pytest.importorskip("matplotlib.colors", reason="needs the extra `report`").to_rgb
compare_images = pytest.importorskip("matplotlib.testing.compare").compare_images
STORED = Path(__file__).parent / "pictures"
DPI = 60.0
TOLERANCE = 6.0
"""Root mean square difference of the pixels, of 255: fonts differ a little from version to version."""


def lightness(colour: str) -> float:
    red, green, blue = to_rgb(colour)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_is_drawn_as_before(name: str, tmp_path: Path) -> None:
    path = tmp_path / f"{name}.png"
    draw(FIGURES[name], path, DPI)
    if os.environ.get("TESTER_PICTURES") == "write":
        STORED.mkdir(exist_ok=True)
        (STORED / path.name).write_bytes(path.read_bytes())
    assert compare_images(str(STORED / path.name), str(path), TOLERANCE) is None


def test_a_value_that_is_off_is_another_picture(tmp_path: Path) -> None:
    first, second = CHART.panels
    points, *others = first.series
    moved = replace(points, y=(points.y[0] + 0.15, *points.y[1:]))
    draw(replace(CHART, panels=(replace(first, series=(moved, *others)), second)), tmp_path / "load.png", DPI)
    assert compare_images(str(STORED / "load.png"), str(tmp_path / "load.png"), TOLERANCE) is not None


@pytest.mark.parametrize("ending", FORMATS)
def test_the_same_chart_gives_the_same_file(ending: str, tmp_path: Path) -> None:
    paths = [tmp_path / f"{i}.{ending}" for i in range(2)]
    for path in paths:
        draw(CHART, path)
    assert paths[0].read_bytes() == paths[1].read_bytes()


def test_a_drawing_has_its_units_in_text_of_the_svg(tmp_path: Path) -> None:
    draw(CHART, tmp_path / "a.svg")
    assert "load (N)" in (tmp_path / "a.svg").read_text(encoding="utf-8")


def test_a_second_scale_is_drawn_in_its_unit() -> None:
    scale = SecondScale("pressure (kPa)", 7.0)
    over, plain = inline_svg(replace(CHART, x_second=scale), "a"), inline_svg(CHART, "b")
    # 2000 kPa are 286 N: a mark of its own, not the axis's in another unit.
    assert ">pressure (kPa)<" in over and ">2000<" in over
    assert ">pressure (kPa)<" not in plain and ">2000<" not in plain


def test_a_surface_has_its_second_marks_at_its_values() -> None:
    surface = FIGURES["surface"]
    assert isinstance(surface, ChartSurface)
    drawn = inline_svg(replace(surface, x_second=SecondScale("pressure (kPa)", 1.7)), "a")
    assert ">170<" in drawn and ">340<" in drawn


def test_styles_differ_in_mark_dash_and_colour() -> None:
    assert len(COLOURS) == len(MARKS) == len(DASHES) == len(set(MARKS)) == len(set(map(str, DASHES)))


def test_neighbouring_colours_differ_in_lightness() -> None:
    assert all(abs(lightness(a) - lightness(b)) > 0.05 for a, b in pairwise(COLOURS))
    assert all(lightness(one) < 0.7 for one in COLOURS)


def test_no_panel_is_cut_where_a_later_one_goes_higher() -> None:
    first, second = CHART.panels
    (points,) = second.series
    high = replace(second, series=(replace(points, y=tuple(2.0 * y for y in points.y)),))
    drawn = inline_svg(replace(CHART, panels=(first, high)), "a")
    assert drawn.count("2#") and drawn.count("</title>") == sum(
        len(one.x) for panel in (first, high) for one in panel.series if one.look != "law"
    )
    assert ">1.75<" in drawn  # the common axis reaches the highest of 1.88


def test_another_format_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"a\.gif: a figure is one of png, svg, pdf"):
        draw(CHART, tmp_path / "a.gif")


def test_without_matplotlib_the_line_that_installs_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingExtraError, match=r"friction-tester\[report\]"):
        draw(CHART, tmp_path / "a.png")
